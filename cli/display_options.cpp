#include "cli/display_options.h"

#include "cli/message.h"
#include "cli/options.h"
#include "image/write_image.h"

namespace covtrace::cli {

void add_display_options(CLI::App* c, DisplayArguments& a) {
    const auto parse = [&a](const std::string& text) {
        // The darkest one shows the largest numbers of single precision. Brighter than the other
        // end all but a few images are white.
        constexpr float kLeast = -130, kMost = 60;
        a.exposure = parse_number("--exposure", text, kLeast, kMost);
    };
    c->add_option_function<std::string>("--exposure", parse, "brighten the PNG, not the EXR")
        ->option_text("STOPS");
    const auto add = [c](const char* name, auto& value, const char* help) {
        return c->add_option(name, value, help)->check(not_empty());
    };
    add("--view", a.view, "light above white in the PNG, or a config's view")
        ->option_text(listed_names<ViewTransform>("|"));
    add("--ocio-config", a.ocio.config, "show the PNG by this OpenColorIO config")
        ->option_text("FILE");
    add("--ocio-display", a.ocio.display, "the config's display")->option_text("NAME");
    add("--ocio-look", a.ocio.look, "a look in place of the view's own")->option_text("NAME");
    add("--ocio-source", a.ocio.source, "the config's space that colours are in")
        ->option_text("NAME");
}

void resolve(DisplayArguments& a) {
    a.options = display_options(a.exposure, a.view, a.ocio);
}

void add_inputs(const DisplayOptions& o, std::vector<std::filesystem::path>& inputs) {
    if (o.ocio) inputs.insert(inputs.end(), o.ocio->files().begin(), o.ocio->files().end());
}

void warn_of_config(const DisplayOptions& o) {
    if (o.ocio) print_warnings(o.ocio->warnings());
}

void warn_of_no_picture(const DisplayOptions& o, const std::filesystem::path& image,
                        const std::string& png) {
    const bool is_default = o.exposure == 0 && o.view == DisplayOptions{}.view && !o.ocio;
    if (is_default || !png.empty() || written_format(image) == WrittenFormat::png) return;
    say("warning: --exposure, --view and --ocio-config change nothing: no PNG is written\n");
}

}  // namespace covtrace::cli
