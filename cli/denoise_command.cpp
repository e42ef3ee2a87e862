#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/denoiser_options.h"
#include "cli/display_options.h"
#include "cli/message.h"
#include "cli/options.h"
#include "cli/picture_name.h"
#include "cli/pixel_warnings.h"
#include "cli/same_file.h"
#include "core/parallel.h"
#include "foreign/denoise.h"
#include "image/layer_names.h"
#include "image/write_image.h"

namespace covtrace::cli {

namespace {

struct DenoiseArguments {
    std::vector<std::string> images;
    std::string output, png;
    LayerNaming layers;
    std::optional<float> samples;
    DisplayArguments display;
    DenoiserArguments denoiser;
    int threads = 0;
    bool quiet = false;
};

int denoise_images(DenoiseArguments a) {
    const ThreadLimit threads(a.threads);
    require_picture_name("--png", a.png);
    resolve(a.display);
    std::vector<std::filesystem::path> inputs(a.images.begin(), a.images.end());
    if (!a.denoiser.library.empty()) inputs.emplace_back(a.denoiser.library);
    add_inputs(a.display.options, inputs);
    require_distinct({{"--output", a.output}, {"--png", a.png}}, inputs);
    std::vector<NamedImage> images;
    for (const std::string& file : a.images) {
        images.push_back({file, read_image(file)});
        restore_layer_names(images.back().image);
    }
    const FoundDenoiser denoiser = find(a.denoiser);
    const DenoisedImage result =
        denoise(images, {a.layers, a.samples, denoiser.denoiser.get(),
                         a.denoiser.quality.value_or(DenoiserQuality::high)});
    if (!a.quiet) {
        warn_of_unusable(denoiser);
        warn_of_config(a.display.options);
        warn_of_failed_denoiser(result.image);
        warn_of_no_picture(a.display.options, a.output, a.png);
        print_warnings(result.warnings);
    }
    warn_of_replaced(result.image);
    write_image(result.image, a.output, threads.threads(), a.display.options);
    if (!a.png.empty()) write_png(result.image, a.png, a.display.options);
    if (!a.quiet)
        say("estimated error {:.3g}, {}\n", result.error,
            result.image.metadata.contains("covtrace:denoiser") ? denoiser.denoiser->name()
                                                                : "no denoiser");
    return 0;
}

}  // namespace

void add_denoise(CLI::App& app, Invocation& invocation) {
    auto a = std::make_shared<DenoiseArguments>();
    CLI::App* c = app.add_subcommand("denoise", "Reconstruct the image of another renderer");
    c->add_option("IMAGE", a->images, "two renders with different seeds, or one with variance")
        ->required()
        ->take_all()
        ->option_text(" ");
    c->add_option("-o,--output", a->output, "the image, with its error")
        ->required()
        ->check(not_empty())
        ->option_text("FILE");
    c->add_option("--png", a->png, "also an 8-bit sRGB picture")
        ->check(not_empty())
        ->option_text("FILE");
    add_display_options(c, a->display);
    const auto add_layer = [c](const char* name, std::string& layer, const char* help) {
        c->add_option(name, layer, help)->check(not_empty())->option_text("LAYER");
    };
    add_layer("--color", a->layers.color, "the noisy colour; root for R, G, B");
    add_layer("--variance", a->layers.variance, "the variance of the colour");
    add_layer("--albedo", a->layers.albedo, "reflectances; none leaves them out");
    add_layer("--normal", a->layers.normal, "normals; none leaves them out");
    add_layer("--depth", a->layers.depth, "distances; none leaves them out");
    constexpr double kMostSamples = 1e9;
    add_positive(c, "--samples", a->samples, kMostSamples, "samples per pixel of each image", 1);
    add_denoiser_options(c, a->denoiser);
    constexpr int kMostThreads = 4096;
    add_whole(c, "--threads", a->threads, 0, kMostThreads, "0 for all cores");
    c->add_flag("--quiet", a->quiet, "errors only");
    c->callback([a, &invocation] { invocation.action = [a] { return denoise_images(*a); }; });
}

}  // namespace covtrace::cli
