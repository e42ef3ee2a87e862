#include "films.h"

#include <pybind11/stl/filesystem.h>

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "bindings.h"
#include "core/parallel.h"
#include "image/finite_pixels.h"
#include "planes.h"
#include "python_lock.h"
#include "render/develop.h"
#include "render/film_file.h"
#include "render/merge.h"
#include "render/methods/idle_options.h"

namespace covtrace::python {

namespace fs = std::filesystem;

FilmChoice film_choice(const py::dict& o) {
    FilmChoice choice;
    const auto path = [&](const char* name) {
        return is_given(o, name) ? value_of<fs::path>(o, name, "a file's path").string()
                                 : std::string();
    };
    choice.film = path("film");
    choice.checkpoint = path("checkpoint");
    choice.every = positive<double>(o, "every");
    choice.resume = value_of<bool>(o, "resume", "True or False");
    if (is_given(o, "shard")) {
        const auto shard = value_of<std::array<int, 2>>(o, "shard", "(k, n) with 1 <= k <= n");
        require(1 <= shard[0] && shard[0] <= shard[1], "shard must be (k, n) with 1 <= k <= n");
        choice.shard = Shard{shard[0] - 1, shard[1]};
    }
    return choice;
}

std::optional<LayerSelection> layer_selection(const py::dict& o) {
    if (!is_given(o, "layers")) return std::nullopt;
    return parse_layers("layers", value_of<std::string>(o, "layers", "a text"));
}

void select_layers(Image& image, const std::optional<LayerSelection>& selection,
                   Warnings& warnings) {
    if (!selection) return;
    for (const std::string& name : absent_layers(image, *selection))
        warnings.push_back(
            {{}, "layers: this image has no layer '" + name + "'; not every method makes each"});
    keep_layers(image, *selection);
}

namespace {

/// The image of joined films, and what is known of them.
struct Merged {
    Image image;  ///< without layers where none was asked for
    bool complete = false;
    int shards = 0, present = 0;
    double samples = 0;
    Warnings warnings;
};

Merged merge_films(const std::vector<fs::path>& films, const fs::path& film,
                   const std::optional<LayerSelection>& layers, const DenoiserSearch& search,
                   std::optional<DenoiserQuality> quality, bool makes_image, int threads) {
    const ThreadLimit limit(threads);
    FilmMerge merge;
    for (const fs::path& file : films) merge.add(file.string(), read_film(file));
    const RenderState state = std::move(merge).result();
    if (!film.empty()) {
        remove_leftovers(film);
        write_film(state, film);
    }
    Merged merged;
    merged.complete = state.complete;
    merged.shards = state.shards;
    merged.present = int(state.present.size());
    merged.samples = state.mean_count();
    if (!makes_image) return merged;
    const FoundDenoiser denoiser =
        state.method == Method::hybrid ? find_denoiser(search) : FoundDenoiser{};
    Image& image = merged.image;
    image = develop(state, denoiser.denoiser.get(), quality.value_or(DenoiserQuality::high));
    const auto warn = [&](const std::string& text) { merged.warnings.push_back({{}, text}); };
    if (denoiser.is_unusable) warn("no denoiser is used: " + denoiser.why_none);
    RenderOptions of_films;
    of_films.method = state.method;
    of_films.denoiser_quality = quality;
    for (const std::string& text : idle_options(of_films, search.choice == DenoiserChoice::oidn))
        warn(text);
    if (const auto it = image.metadata.find("covtrace:denoiserFailure"); it != image.metadata.end())
        warn("the image is without the denoiser: " + std::get<std::string>(it->second));
    if (const auto replaced = replaced_pixels(image.metadata)) warn(describe(*replaced));
    if (!state.complete) warn("the image is not complete: " + missing_part(state));
    select_layers(image, layers, merged.warnings);
    return merged;
}

/// (image, complete, statistics, warnings)
py::tuple merge(const std::vector<fs::path>& films, const py::dict& o) {
    const std::optional<LayerSelection> layers = layer_selection(o);
    const DenoiserSearch search = denoiser_search(o);
    const std::optional<DenoiserQuality> quality = denoiser_quality(o);
    const bool makes_image = value_of<bool>(o, "image", "True or False");
    const int threads = thread_count(o);
    const fs::path film =
        is_given(o, "film") ? value_of<fs::path>(o, "film", "a file's path") : fs::path();
    Merged merged;
    {
        const Unlocked unlocked;
        merged = merge_films(films, film, layers, search, quality, makes_image, threads);
    }
    py::dict statistics;
    statistics["spp"] = merged.samples;
    statistics["shards"] = merged.shards;
    statistics["present"] = merged.present;
    std::vector<std::string> texts;
    for (const Warning& w : merged.warnings) texts.push_back(w.text);
    return py::make_tuple(std::make_shared<Planes>(std::move(merged.image)), merged.complete,
                          statistics, texts);
}

}  // namespace

void bind_films(py::module_& module) {
    module.def("merge", &merge);
}

}  // namespace covtrace::python
