#include "cli/display_options.h"

#include "cli/message.h"
#include "cli/options.h"
#include "image/write_image.h"

namespace covtrace::cli {

void add_display_options(CLI::App* c, DisplayOptions& o) {
    const auto parse = [&o](const std::string& text) {
        // More would be black or white whatever the image.
        constexpr float kMost = 60;
        o.exposure = parse_number("--exposure", text, -kMost, kMost);
    };
    c->add_option_function<std::string>("--exposure", parse, "brighten the PNG, not the EXR")
        ->option_text("STOPS");
    add_choice(c, "--view", o.view, "how the PNG shows what is brighter than white");
}

void warn_of_no_picture(const DisplayOptions& o, const std::filesystem::path& image,
                        const std::string& png) {
    const bool is_default = o.exposure == 0 && o.view == DisplayOptions{}.view;
    if (is_default || !png.empty() || written_format(image) == WrittenFormat::png) return;
    say("warning: --exposure and --view change nothing: no PNG is written\n");
}

}  // namespace covtrace::cli
