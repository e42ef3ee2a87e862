#include "cli/layer_options.h"

#include "cli/message.h"

namespace covtrace::cli {

void add_layers(CLI::App* c, const std::string& name, LayerSelection& selection,
                const std::string& help) {
    const auto parse = [name, &selection](const std::string& text) {
        selection = parse_layers(name, text);
    };
    c->add_option_function<std::string>(name, parse, help)->option_text("LIST");
}

void warn_of_absent_layers(const Image& image, const LayerSelection& selection) {
    for (const std::string& name : absent_layers(image, selection))
        say("warning: --layers: this image has no layer '{}'; not every method makes each\n", name);
}

}  // namespace covtrace::cli
