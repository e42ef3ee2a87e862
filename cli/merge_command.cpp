#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/denoiser_options.h"
#include "cli/display_options.h"
#include "cli/layer_options.h"
#include "cli/message.h"
#include "cli/options.h"
#include "cli/picture_name.h"
#include "cli/pixel_warnings.h"
#include "cli/same_file.h"
#include "core/parallel.h"
#include "image/write_image.h"
#include "render/develop.h"
#include "render/film_file.h"
#include "render/merge.h"
#include "render/methods/idle_options.h"

namespace covtrace::cli {

namespace {

struct MergeArguments {
    std::vector<std::string> films;
    std::string output, film, png;
    LayerSelection layers{true, {}};
    DisplayArguments display;
    DenoiserArguments denoiser;
    bool quiet = false;
};

int merge_films(MergeArguments a) {
    const ThreadLimit threads(0);
    if (a.output.empty() && a.film.empty() && a.png.empty())
        throw Error(ErrorKind::usage, "merge: expected --output OUT.exr or --film FILE");
    require_image_name("--output", a.output, a.layers);
    require_picture_name("--png", a.png);
    resolve(a.display);
    std::vector<NamedOutput> outputs{{"--output", a.output}, {"--png", a.png}};
    add_film(outputs, "--film", a.film);
    std::vector<std::filesystem::path> inputs(a.films.begin(), a.films.end());
    if (!a.denoiser.library.empty()) inputs.emplace_back(a.denoiser.library);
    add_inputs(a.display.options, inputs);
    require_distinct(outputs, inputs);
    for (const std::string& file : {a.output, a.png, a.film})
        if (!file.empty()) remove_leftovers(file);
    FilmMerge merge;
    for (const std::string& file : a.films) merge.add(file, read_film(file));
    const RenderState state = std::move(merge).result();
    if (!a.film.empty()) write_film(state, a.film);
    const bool makes_image = !a.output.empty() || !a.png.empty();
    if (makes_image) {
        const FoundDenoiser denoiser =
            state.method == Method::hybrid ? find(a.denoiser) : FoundDenoiser{};
        Image image = develop(state, denoiser.denoiser.get(),
                              a.denoiser.quality.value_or(DenoiserQuality::high));
        if (!a.quiet) {
            warn_of_unusable(denoiser);
            warn_of_config(a.display.options);
            const bool insists = a.denoiser.choice == DenoiserChoice::oidn;
            RenderOptions of_films;
            of_films.method = state.method;
            of_films.denoiser_quality = a.denoiser.quality;
            for (const std::string& text : idle_options(of_films, insists))
                say("warning: {}\n", text);
            warn_of_failed_denoiser(image);
            warn_of_absent_layers(image, a.layers);
            warn_of_no_picture(a.display.options, a.output, a.png);
        }
        warn_of_replaced(image);
        keep_layers(image, a.layers);
        if (!a.output.empty()) write_image(image, a.output, threads.threads(), a.display.options);
        if (!a.png.empty()) write_png(image, a.png, a.display.options);
    }
    if (!a.quiet)
        say("{}{:.4g} samples per pixel, {}\n",
            state.shards > 1 ? std::to_string(state.present.size()) + " of " +
                                   std::to_string(state.shards) + " shards, "
                             : "",
            state.mean_count(), state.complete ? "complete" : "not complete");
    if (state.complete || !makes_image) return 0;
    say("warning: the image is not complete: {}\n", missing_part(state));
    return 6;
}

}  // namespace

void add_merge(CLI::App& app, Invocation& invocation) {
    auto a = std::make_shared<MergeArguments>();
    CLI::App* c = app.add_subcommand("merge", "Join the films of shards, and make their image");
    c->add_option("FILM", a->films, "the films, in any order")
        ->required()
        ->take_all()
        ->option_text(" ");
    c->add_option("-o,--output", a->output, "the image")->check(not_empty())->option_text("FILE");
    c->add_option("--film", a->film, "the joined film, to go on from")
        ->check(not_empty())
        ->option_text("FILE");
    c->add_option("--png", a->png, "also an 8-bit sRGB picture")
        ->check(not_empty())
        ->option_text("FILE");
    add_display_options(c, a->display);
    add_layers(c, "--layers", a->layers, "all, or name,name…: layers beside the image");
    add_denoiser_options(c, a->denoiser);
    c->add_flag("--quiet", a->quiet, "errors only");
    c->callback([a, &invocation] { invocation.action = [a] { return merge_films(*a); }; });
}

}  // namespace covtrace::cli
