#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "bindings.h"
#include "core/parallel.h"
#include "films.h"
#include "geometry/instruction_set.h"
#include "gltf/read_gltf.h"
#include "image/darkness.h"
#include "image/finite_pixels.h"
#include "options.h"
#include "pbrt/read_scene.h"
#include "planes.h"
#include "python_lock.h"
#include "render/layers.h"
#include "render/methods/idle_options.h"
#include "render/scene_file.h"
#include "render/session.h"
#include "scene/defaults.h"
#include "scene/extent.h"
#include "scene/framing.h"
#include "scene/summary.h"
#include "warning_texts.h"

namespace covtrace::python {

namespace py = pybind11;
namespace fs = std::filesystem;

namespace {

/// State that the thread that renders shares with the thread that waits for it.
struct Exchange {
    std::mutex mutex;
    std::condition_variable changed;
    bool finished = false;
    std::optional<Progress> progress;
    SharedPlanes preview;  ///< the image so far, until the caller has it
};

py::object progress_object(const Progress& p) {
    return py::module_::import("covtrace.progress")
        .attr("Progress")(name_of(p.phase), p.fraction, p.samples_per_pixel, p.elapsed, p.remaining,
                          p.error);
}

/// Waits for the render with the interpreter's lock released, but for the moments in which signals
/// are looked at and the caller is told. Python functions are called in the caller's thread.
/// Returns once the render has ended: the exception of the caller's functions, which cancels the
/// render, or null.
std::exception_ptr wait(Exchange& exchange, Monitor& monitor, const py::object& progress,
                        const py::object& preview, const py::object& cancel) {
    const Calls calls;
    std::exception_ptr thrown;
    for (;;) {
        std::optional<Progress> latest;
        SharedPlanes image;
        {
            const Unlocked unlocked(&calls);
            std::unique_lock lock(exchange.mutex);
            exchange.changed.wait_for(lock, std::chrono::milliseconds(50),
                                      [&] { return exchange.finished || exchange.preview; });
            latest = std::exchange(exchange.progress, std::nullopt);
            image = std::exchange(exchange.preview, nullptr);
            if (exchange.finished && (thrown || (!latest && !image))) return thrown;
        }
        if (thrown) continue;
        try {
            if (PyErr_CheckSignals() != 0) throw py::error_already_set();
            if (latest && !progress.is_none()) progress(progress_object(*latest));
            if (image) preview(image);
            // The result of `is_set` is true or false as in an `if`.
            if (!cancel.is_none() && py::bool_(cancel.attr("is_set")())) monitor.cancel();
        } catch (...) {
            // The thread that renders must be joined before the exception leaves.
            thrown = std::current_exception();
            monitor.cancel();
        }
    }
}

/// The films that a render keeps, and the layers of its image.
struct Deliverables {
    FilmChoice films;
    std::optional<LayerSelection> layers;  ///< empty: every layer that is made
};

struct Rendered {
    SharedPlanes planes;  ///< without layers for a shard, which has no image
    RenderStatistics statistics;
    bool complete = false;
    std::string isa;
    Warnings warnings;
    FoundDenoiser denoiser;
    std::string denoiser_failure;  ///< failure while the image was made
    std::string denoiser_quality;  ///< empty where no image was made with one
    std::optional<ReplacedPixels> replaced;
    std::map<std::string, GuideOutcome> guides;
    double building = 0;  ///< seconds from the description to what is rendered
};

/// Corners of the box around all shapes: ((x, y, z), (x, y, z)), None where there are none.
py::object extent_of(const SceneDescription& scene) {
    const Bounds3 box = bounds(scene);
    if (box.empty()) return py::none();
    return py::make_tuple(py::make_tuple(box.lo.x, box.lo.y, box.lo.z),
                          py::make_tuple(box.hi.x, box.hi.y, box.hi.z));
}

/// `has_environment`: whether environment= was given, which is no remedy then.
std::string darkness_text(double dark, bool has_environment) {
    return std::to_string(std::lround(100 * dark)) +
           " % of the surfaces in view are black, as no light reaches them" +
           (has_environment ? ", that of environment= neither" : "") +
           "; light=\"camera\" adds a lamp, light=\"x,y,z\" one at a place" +
           (has_environment ? "" : ", and environment= the sky's light");
}

/// Builds the scene and renders it, without Python.
Rendered render_description(SceneDescription description, RenderOptions options,
                            const std::optional<Preset>& bundle, const DenoiserSearch& search,
                            const SceneOverrides& overrides, const Deliverables& deliverables,
                            int threads, const std::string& isa, size_t texture_bytes,
                            Monitor& monitor) {
    const ThreadLimit limit(threads);
    const bool is_shard = deliverables.films.shard.has_value();
    FoundDenoiser denoiser;
    if (options.method == Method::hybrid && !is_shard) denoiser = find_denoiser(search);
    options.denoiser = denoiser.denoiser;
    const auto told = std::ptrdiff_t(description.warnings.size());
    apply(overrides, description);
    if (bundle) apply(*bundle, overrides, description, options);
    Warnings of_options;
    for (std::string& text : idle_options(options, search.choice == DenoiserChoice::oidn))
        of_options.push_back({{}, std::move(text)});
    FilmFiles films(deliverables.films, [&of_options](const std::string& text) {
        of_options.push_back({{}, text});
    });
    FilmKeeping keeping = films.keeping(true);
    const double begin = monitor.elapsed();
    RenderScene scene(std::move(description), isa, texture_bytes, options.guides,
                      [&monitor] { return monitor.cancelled(); });
    const double building = monitor.elapsed() - begin;
    RenderResult result = render(scene, options, monitor, std::move(keeping));
    films.finish();
    // Stand-ins for a camera or lights, and what building the scene found, are new.
    const Warnings& of_scene = scene.description.warnings;
    Warnings warnings(of_scene.begin() + told, of_scene.end());
    for (const Warnings* w : {&scene.materials.warnings(), &std::as_const(of_options)})
        warnings.insert(warnings.end(), w->begin(), w->end());
    if (denoiser.is_unusable) warnings.push_back({{}, "no denoiser is used: " + denoiser.why_none});
    std::string failure;
    if (const auto it = result.image.metadata.find("covtrace:denoiserFailure");
        it != result.image.metadata.end()) {
        failure = std::get<std::string>(it->second);
        warnings.push_back({{}, "the image is without the denoiser: " + failure});
    }
    std::string quality;
    if (const auto it = result.image.metadata.find("covtrace:denoiserQuality");
        it != result.image.metadata.end())
        quality = std::get<std::string>(it->second);
    const std::optional<ReplacedPixels> replaced = replaced_pixels(result.image.metadata);
    if (replaced) warnings.push_back({{}, describe(*replaced)});
    if (const double dark = dark_share(result.image); dark >= kMostlyDark)
        warnings.push_back(
            {{}, darkness_text(dark, !scene.description.environment_override.empty())});
    if (!is_shard && shows_nothing(result.image))
        if (const std::string view = view_of_all(scene.description); !view.empty())
            warnings.push_back({{},
                                "the camera sees nothing, no surface and no light; all shapes are "
                                "seen by camera=\"" +
                                    view + "\""});
    if (!is_shard) select_layers(result.image, deliverables.layers, warnings);
    return {std::make_shared<Planes>(std::move(result.image)),
            std::move(result.statistics),
            result.complete || (is_shard && !monitor.cancelled()),
            scene.geometry.isa(),
            std::move(warnings),
            std::move(denoiser),
            std::move(failure),
            std::move(quality),
            replaced,
            scene.guide_outcomes(),
            building};
}

py::dict pass_dict(const PassStatistics& s) {
    py::dict d;
    d["samples"] = s.samples;
    d["camera_rays"] = s.rays.camera;
    d["bounce_rays"] = s.rays.bounce;
    d["shadow_rays"] = s.rays.shadow;
    d["vertices"] = s.vertices;
    d["black_paths"] = s.black_paths;
    d["rejected"] = s.rejected;
    return d;
}

/// The denoiser as in the program's statistics.
py::object denoiser_object(const Rendered& r) {
    py::dict d;
    if (!r.denoiser_failure.empty() || !r.denoiser.denoiser)
        d["why_none"] = r.denoiser_failure.empty() ? r.denoiser.why_none : r.denoiser_failure;
    else
        d["name"] = r.denoiser.denoiser->name();
    if (!r.denoiser_quality.empty()) d["quality"] = r.denoiser_quality;
    if (!r.denoiser.library.empty()) d["file"] = r.denoiser.library.string();
    return r.denoiser.denoiser || !r.denoiser.why_none.empty() ? py::object(d) : py::none();
}

/// The replaced pixels as in the program's statistics.
py::dict replaced_dict(const std::optional<ReplacedPixels>& r) {
    py::dict d;
    d["count"] = r ? r->pixels : 0;
    if (!r) return d;
    d["first"] = py::make_tuple(r->x, r->y);
    d["layers"] = r->layers;
    return d;
}

/// The outcome of each guide, as in the program's statistics.
py::dict guides_dict(const std::map<std::string, GuideOutcome>& guides) {
    py::dict all;
    for (const auto& [name, o] : guides) {
        py::dict d;
        d["state"] = std::string(name_of(o.state));
        d["seconds"] = o.seconds;
        d["bytes"] = o.bytes;
        d["second_moment"] =
            o.second_moment > 0 ? py::object(py::float_(o.second_moment)) : py::object(py::none());
        all[name.c_str()] = d;
    }
    return all;
}

py::dict statistics_dict(const Rendered& r, double elapsed) {
    py::dict d;
    d["seconds_total"] = elapsed;
    d["seconds_scene"] = r.building;
    d["seconds"] = named(r.statistics.seconds);
    d["denoiser"] = denoiser_object(r);
    d["memory"] = r.statistics.memory;
    d["spp"] = r.statistics.samples_per_pixel;
    d["k"] = r.statistics.density_factor;
    d["covariance"] = pass_dict(r.statistics.covariance);
    d["radiance"] = pass_dict(r.statistics.radiance);
    d["guides"] = guides_dict(r.guides);
    d["replaced_pixels"] = replaced_dict(r.replaced);
    d["complete"] = r.complete;
    return d;
}

py::tuple render_scene(const SceneDescription& scene, const py::dict& o) {
    RenderOptions options = render_options(o);
    const Deliverables deliverables{film_choice(o), layer_selection(o)};
    if (deliverables.layers) request_layers(*deliverables.layers, options);
    const std::optional<Preset> bundle = preset(o);
    const DenoiserSearch search = denoiser_search(o);
    const SceneOverrides overrides = scene_overrides(o);
    const int threads = thread_count(o);
    std::optional<InstructionSet> isa;
    if (is_given(o, "isa")) isa = choice<InstructionSet>(o, "isa");
    const size_t texture_bytes =
        is_given(o, "texture_memory")
            ? value_of<size_t>(o, "texture_memory", "a number of bytes, or a text such as '500M'")
            : kNoTextureLimit;
    const py::object progress = o["progress"], preview = o["preview"], cancel = o["cancel"];

    // Render in a thread of its own, and wait for it
    Exchange exchange;
    Monitor monitor(
        [&exchange](const Progress& p) {
            const std::lock_guard lock(exchange.mutex);
            exchange.progress = p;
        },
        0.1);
    if (!preview.is_none())
        monitor.watcher = [&exchange](Image image) {
            auto planes = std::make_shared<Planes>(std::move(image));
            const std::lock_guard lock(exchange.mutex);
            exchange.preview = std::move(planes);
            exchange.changed.notify_all();
        };
    std::optional<Rendered> rendered;
    std::exception_ptr failure;
    auto work = std::make_unique<Work>(monitor);
    std::thread worker([&, description = scene]() mutable {
        try {
            rendered =
                render_description(std::move(description), options, bundle, search, overrides,
                                   deliverables, threads, isa_name(isa), texture_bytes, monitor);
        } catch (...) {
            failure = std::current_exception();
        }
        // The work is over before its end is told: from then on the caller may be gone, or wait for
        // ever.
        work.reset();
        const std::lock_guard lock(exchange.mutex);
        exchange.finished = true;
        exchange.changed.notify_all();
    });
    const std::exception_ptr thrown = wait(exchange, monitor, progress, preview, cancel);
    worker.join();
    if (thrown) std::rethrow_exception(thrown);
    if (failure) std::rethrow_exception(failure);
    return py::make_tuple(rendered->planes, rendered->complete,
                          statistics_dict(*rendered, monitor.elapsed()),
                          texts_of(rendered->warnings));
}

/// The scene with stand-ins for a camera or lights that it does not have.
SceneDescription completed(SceneDescription scene) {
    complete(scene);
    return scene;
}

std::shared_ptr<SceneDescription> read_file(
    const fs::path& file, const std::vector<fs::path>& search_paths,
    const std::optional<std::array<float, 2>>& shutter, const std::string& camera,
    const std::string& gltf_scene, const std::string& animation, const std::string& variant) {
    if (shutter) checked_shutter(*shutter);
    const Unlocked unlocked;
    auto scene = std::make_shared<SceneDescription>(
        read_scene_file(file, {search_paths, shutter, camera, gltf_scene, animation, variant}));
    if (shutter) {
        scene->camera.shutter_open = (*shutter)[0];
        scene->camera.shutter_close = (*shutter)[1];
    }
    return scene;
}

}  // namespace

void bind_render(py::module_& module) {
    SceneClass scene(module, "SceneDescription");
    bind_scene_edit(scene);
    scene.def_static("read", &read_file)
        .def_static("read_string",
                    [](const std::string& text, const std::string& name, const fs::path& folder,
                       const std::vector<fs::path>& search_paths) {
                        const Unlocked unlocked;
                        return std::make_shared<SceneDescription>(
                            read_pbrt_string(text, name, folder, {search_paths}));
                    })
        .def_property_readonly("name", [](const SceneDescription& s) { return s.name; })
        .def_property_readonly(
            "resolution",
            [](const SceneDescription& s) { return py::make_tuple(s.film.width, s.film.height); })
        .def_property_readonly("spp", [](const SceneDescription& s) { return s.samples_per_pixel; })
        .def_property_readonly("max_depth", [](const SceneDescription& s) { return s.max_depth; })
        .def_property_readonly("content_hash",
                               [](const SceneDescription& s) { return s.content_hash; })
        .def_property_readonly("told",
                               [](const SceneDescription& s) { return texts_of(s.warnings); })
        .def_property_readonly(
            "warnings", [](const SceneDescription& s) { return texts_of(completed(s).warnings); })
        .def("extent", &extent_of)
        .def("summary", [](const SceneDescription& s) { return summarize(completed(s)); });
    module.def("is_gltf", &is_gltf);
    module.def("render", &render_scene);
}

}  // namespace covtrace::python
