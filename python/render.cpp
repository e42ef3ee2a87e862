#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "bindings.h"
#include "core/parallel.h"
#include "planes.h"
#include "render/scene_file.h"
#include "render/session.h"
#include "scene/summary.h"

namespace covtrace::python {

namespace py = pybind11;
namespace fs = std::filesystem;

namespace {

using SharedScene = std::shared_ptr<SceneDescription>;

template <typename T>
T choice(const char* option, const std::string& value,
         std::initializer_list<std::pair<const char*, T>> choices) {
    std::string expected;
    for (const auto& [name, result] : choices) {
        if (value == name) return result;
        expected += std::string(expected.empty() ? "" : ", ") + "'" + name + "'";
    }
    throw Error(ErrorKind::usage,
                std::string(option) + " is '" + value + "'; expected one of " + expected);
}

void require(bool holds, const std::string& message) {
    if (!holds) throw Error(ErrorKind::usage, message);
}

template <typename T>
std::optional<T> positive(const py::dict& options, const char* name) {
    if (!options.contains(name) || options[name].is_none()) return std::nullopt;
    T value{};
    try {
        value = options[name].cast<T>();
    } catch (const py::cast_error&) {
        throw Error(ErrorKind::usage, std::string(name) + " is " +
                                          std::string(py::str(options[name])) +
                                          "; expected a number");
    }
    require(value > 0, std::string(name) + " must be greater than 0");
    return value;
}

RenderOptions render_options(const py::dict& o) {
    RenderOptions r;
    const auto text = [&](const char* name) { return o[name].cast<std::string>(); };
    r.method = choice<Method>("method", text("method"),
                              {{"uniform", Method::uniform},
                               {"covariance", Method::covariance},
                               {"hybrid", Method::hybrid}});
    r.density =
        choice<DensityRule>("density", text("density"),
                            {{"tempered", DensityRule::tempered}, {"thesis", DensityRule::thesis}});
    r.occlusion = choice<Occlusion>(
        "occlusion", text("occlusion"),
        {{"grid", Occlusion::grid}, {"query", Occlusion::query}, {"none", Occlusion::none}});
    r.brdf_covariance = choice<BrdfCovariance>(
        "brdf_covariance", text("brdf_covariance"),
        {{"local", BrdfCovariance::local}, {"global", BrdfCovariance::global}});
    r.filter =
        choice<FilterRule>("filter", text("filter"),
                           {{"verified", FilterRule::verified}, {"thesis", FilterRule::thesis}});
    r.spp = positive<double>(o, "spp");
    r.seconds = positive<double>(o, "time");
    r.error = positive<double>(o, "error");
    r.cov_spp = positive<int>(o, "cov_spp");
    r.max_spp = positive<int>(o, "max_spp");
    r.voxels = o["voxels"].cast<int>();
    require(r.voxels >= 1 && r.voxels <= 2048, "voxels must be from 1 to 2048");
    if (!o["max_depth"].is_none()) {
        r.max_depth = o["max_depth"].cast<int>();
        require(*r.max_depth >= 0, "max_depth must not be negative");
    }
    r.even_counts = o["even_counts"].cast<bool>();
    r.seed = o["seed"].cast<uint64_t>();
    return r;
}

SceneOverrides scene_overrides(const py::dict& o) {
    SceneOverrides s;
    if (!o["resolution"].is_none()) s.resolution = o["resolution"].cast<std::array<int, 2>>();
    if (!o["crop"].is_none()) {
        const auto c = o["crop"].cast<std::array<int, 4>>();
        s.crop = PixelBounds{c[0], c[1], c[2], c[3]};
    }
    if (!o["shutter"].is_none()) s.shutter = o["shutter"].cast<std::array<float, 2>>();
    s.focal_distance = positive<float>(o, "focus");
    s.f_number = positive<float>(o, "fstop");
    return s;
}

/// What the thread that renders tells the one that waits for it.
struct Exchange {
    std::mutex mutex;
    std::condition_variable changed;
    bool finished = false;
    std::optional<Progress> progress;
    std::string phase;  // what `progress` points to
};

py::object progress_object(const Progress& p, const std::string& phase) {
    return py::module_::import("covtrace.progress")
        .attr("Progress")(phase, p.fraction, p.samples_per_pixel, p.elapsed, p.remaining, p.error);
}

/// Waits for the render with the interpreter's lock released, but for the moments in which signals
/// are looked at and the caller is told. Everything that is called runs in the caller's thread.
/// Returns whether Python asked to stop by an exception, which is then set.
bool wait(Exchange& exchange, Monitor& monitor, const py::object& progress,
          const py::object& cancel) {
    bool stopped = false;
    for (;;) {
        std::optional<Progress> latest;
        std::string phase;
        {
            const py::gil_scoped_release release;
            std::unique_lock lock(exchange.mutex);
            exchange.changed.wait_for(lock, std::chrono::milliseconds(50),
                                      [&] { return exchange.finished; });
            latest = std::exchange(exchange.progress, std::nullopt);
            phase = exchange.phase;
            if (exchange.finished && (stopped || !latest)) return stopped;
        }
        if (stopped) continue;
        try {
            if (PyErr_CheckSignals() != 0) throw py::error_already_set();
            if (latest && !progress.is_none()) progress(progress_object(*latest, phase));
            if (!cancel.is_none() && cancel.attr("is_set")().cast<bool>()) monitor.cancel();
        } catch (py::error_already_set& e) {
            e.restore();
            stopped = true;
            monitor.cancel();
        }
    }
}

struct Rendered {
    SharedPlanes planes;
    RenderStatistics statistics;
    bool complete = false;
    std::string isa;
    Warnings warnings;
};

std::string text_of(const Warning& w) {
    const std::string where = w.where.to_string();
    return where.empty() ? w.text : where + ": " + w.text;
}

std::vector<std::string> texts_of(const Warnings& warnings) {
    std::vector<std::string> texts;
    for (const Warning& w : warnings) texts.push_back(text_of(w));
    return texts;
}

/// All that happens without Python: builds the scene and renders it.
Rendered render_description(SceneDescription description, const RenderOptions& options,
                            const SceneOverrides& overrides, int threads, const std::string& isa,
                            size_t texture_bytes, Monitor& monitor) {
    const ThreadLimit limit(threads);
    apply(overrides, description);
    RenderScene scene(std::move(description), isa, texture_bytes);
    RenderResult result = render(scene, options, monitor);
    return {std::make_shared<Planes>(std::move(result.image)), std::move(result.statistics),
            result.complete, scene.geometry.isa(), scene.materials.warnings()};
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

py::dict statistics_dict(const Rendered& r, double elapsed) {
    py::dict d;
    d["seconds_total"] = elapsed;
    d["seconds"] = r.statistics.seconds;
    d["memory"] = r.statistics.memory;
    d["spp"] = r.statistics.samples_per_pixel;
    d["covariance"] = pass_dict(r.statistics.covariance);
    d["radiance"] = pass_dict(r.statistics.radiance);
    d["complete"] = r.complete;
    return d;
}

py::tuple render_scene(const SceneDescription& scene, const py::dict& o) {
    const RenderOptions options = render_options(o);
    const SceneOverrides overrides = scene_overrides(o);
    const int threads = o["threads"].cast<int>();
    require(threads >= 0, "threads must not be negative");
    const auto isa = o["isa"].is_none() ? std::string() : o["isa"].cast<std::string>();
    const size_t texture_bytes =
        o["texture_memory"].is_none() ? kNoTextureLimit : o["texture_memory"].cast<size_t>();
    const auto progress = o["progress"].cast<py::object>();
    const auto cancel = o["cancel"].cast<py::object>();

    Exchange exchange;
    Monitor monitor(
        [&exchange](const Progress& p) {
            const std::lock_guard lock(exchange.mutex);
            exchange.progress = p;
            exchange.phase = p.phase;
        },
        0.1);
    std::optional<Rendered> rendered;
    std::exception_ptr failure;
    std::thread worker([&, description = scene]() mutable {
        try {
            rendered = render_description(std::move(description), options, overrides, threads, isa,
                                          texture_bytes, monitor);
        } catch (...) {
            failure = std::current_exception();
        }
        const std::lock_guard lock(exchange.mutex);
        exchange.finished = true;
        exchange.changed.notify_all();
    });
    const bool stopped = wait(exchange, monitor, progress, cancel);
    worker.join();
    if (stopped) throw py::error_already_set();
    if (failure) std::rethrow_exception(failure);
    return py::make_tuple(rendered->planes, rendered->complete,
                          statistics_dict(*rendered, monitor.elapsed()),
                          texts_of(rendered->warnings));
}

ReadOptions read_options(const std::vector<fs::path>& search_paths) {
    return {search_paths};
}

}  // namespace

void bind_render(py::module_& module) {
    py::class_<SceneDescription, SharedScene>(module, "SceneDescription")
        .def_static("read",
                    [](const fs::path& file, const std::vector<fs::path>& search_paths) {
                        const py::gil_scoped_release release;
                        return std::make_shared<SceneDescription>(
                            read_scene_file(file, read_options(search_paths)));
                    })
        .def_static("read_string",
                    [](const std::string& text, const std::string& name, const fs::path& folder,
                       const std::vector<fs::path>& search_paths) {
                        const py::gil_scoped_release release;
                        return std::make_shared<SceneDescription>(
                            read_pbrt_string(text, name, folder, read_options(search_paths)));
                    })
        .def_property_readonly("name", [](const SceneDescription& s) { return s.name; })
        .def_property_readonly(
            "resolution",
            [](const SceneDescription& s) { return py::make_tuple(s.film.width, s.film.height); })
        .def_property_readonly("spp", [](const SceneDescription& s) { return s.samples_per_pixel; })
        .def_property_readonly("max_depth", [](const SceneDescription& s) { return s.max_depth; })
        .def_property_readonly("content_hash",
                               [](const SceneDescription& s) { return s.content_hash; })
        .def_property_readonly("warnings",
                               [](const SceneDescription& s) { return texts_of(s.warnings); })
        .def("summary", &summarize);
    module.def("render", &render_scene);
}

}  // namespace covtrace::python
