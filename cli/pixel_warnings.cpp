#include "cli/pixel_warnings.h"

#include "cli/message.h"
#include "image/finite_pixels.h"

namespace covtrace::cli {

void warn_of_rejected(const RenderStatistics& statistics) {
    if (statistics.rejected == 0) return;
    say("warning: {} samples were not finite and count as black", statistics.rejected);
    if (!statistics.first_rejected.empty()) {
        const RejectedSample& r = statistics.first_rejected[0];
        say("; --debug-pixel {},{},{} shows one", r.x, r.y, r.sample);
    }
    say("\n");
}

void warn_of_darkness(double dark, bool has_environment) {
    say("warning: {:.0f} % of the surfaces in view are black, as no light reaches them{}; --light "
        "camera adds a lamp, --light 'x,y,z' one at a place{}\n",
        100 * dark, has_environment ? ", that of --environment neither" : "",
        has_environment ? "" : ", and --environment the sky's light");
}

void warn_of_nothing(const std::string& view) {
    say("warning: the camera sees nothing, no surface and no light; all shapes are seen by "
        "--camera '{}'\n",
        view);
}

void warn_of_overexposure(int stops, float exposure) {
    say("warning: half of what has light in the PNG is more than twice as bright as white; "
        "--exposure {:g} shows it\n",
        exposure - float(stops));
}

void warn_of_replaced(const Image& image) {
    if (const auto replaced = replaced_pixels(image.metadata))
        say("warning: {}\n", describe(*replaced));
}

}  // namespace covtrace::cli
