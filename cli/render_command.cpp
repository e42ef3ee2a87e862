#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/commands.h"
#include "cli/layer_selection.h"
#include "cli/message.h"
#include "cli/options.h"
#include "cli/progress_line.h"
#include "cli/values.h"
#include "core/parallel.h"
#include "image/image.h"
#include "image/layer_names.h"
#include "image/output_file.h"
#include "preview/tev_client.h"
#include "render/session.h"
#include "render/version.h"
#include "scene/read_scene.h"

namespace covtrace::cli {

namespace {

namespace fs = std::filesystem;

struct RenderArguments {
    std::string scene, output, png, stats, isa;
    std::string seconds, resolution, crop, shutter, tev;
    LayerSelection layers{true, {}}, tev_layers;
    LayerNames layer_names = LayerNames::standard;
    size_t texture_bytes = kNoTextureLimit;
    std::vector<std::string> search_paths;
    RenderOptions options;
    SceneOverrides overrides;
    ProgressStyle progress = ProgressStyle::automatic;
    int threads = 0;
    bool reproducible = false, quiet = false;
};

/// The monitor that Ctrl-C cancels; a second Ctrl-C ends the process at once.
Monitor* interrupted_monitor = nullptr;

extern "C" void on_interrupt(int signal) {
    if (interrupted_monitor && !interrupted_monitor->cancelled()) {
        interrupted_monitor->cancel();
        return;
    }
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

class InterruptGuard {
  public:
    explicit InterruptGuard(Monitor& monitor) {
        interrupted_monitor = &monitor;
        std::signal(SIGINT, on_interrupt);
        std::signal(SIGTERM, on_interrupt);
    }
    ~InterruptGuard() {
        std::signal(SIGINT, SIG_DFL);
        std::signal(SIGTERM, SIG_DFL);
        interrupted_monitor = nullptr;
    }
};

fs::path output_path(const RenderArguments& a, const SceneDescription& scene) {
    if (!a.output.empty()) return a.output;
    fs::path name = scene.film.filename.empty() ? scene.name + ".exr" : scene.film.filename;
    // Every output is an EXR: a film that asks for another format keeps its name.
    if (name.extension() != ".exr") name.replace_extension(".exr");
    return name;
}

/// Before hours of rendering, not after them.
void require_writable(const fs::path& file) {
    const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    std::error_code error;
    if (!fs::is_directory(folder, error))
        throw Error(ErrorKind::usage,
                    "the folder of the output '" + file.string() + "' does not exist");
    const OutputFile probe(file);
}

std::vector<float> flat(const Matrix4& m) {
    // OpenEXR's convention: row vectors times matrix.
    std::vector<float> v;
    for (size_t c = 0; c < 4; ++c)
        for (size_t r = 0; r < 4; ++r) v.push_back(static_cast<float>(m.m[r][c]));
    return v;
}

void describe_render(Image& image, const RenderArguments& a, const RenderScene& scene,
                     const RenderResult& result, const Monitor& monitor,
                     const std::string& command) {
    auto& m = image.metadata;
    m["covtrace:version"] = std::string(kVersion);
    m["covtrace:commit"] = std::string(kCommit);
    m["covtrace:seed"] = std::to_string(a.options.seed);
    m["covtrace:method"] = std::string(a.options.method == Method::uniform      ? "uniform"
                                       : a.options.method == Method::covariance ? "covariance"
                                                                                : "hybrid");
    m["covtrace:isa"] = scene.geometry.isa();
    m["covtrace:sceneHash"] = fmt::format("{:016x}", scene.description.content_hash);
    m["spp"] = static_cast<float>(result.statistics.samples_per_pixel);
    m["complete"] = result.complete ? 1 : 0;
    m["worldToCamera"] = flat(scene.camera.world_to_camera());
    m["worldToNDC"] = flat(scene.camera.world_to_ndc());
    if (a.reproducible) return;
    m["covtrace:command"] = command;
    m["covtrace:seconds"] = static_cast<float>(monitor.elapsed());
    char date[32];
    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    gmtime_r(&now, &utc);
    std::strftime(date, sizeof date, "%Y:%m:%d %H:%M:%S", &utc);
    m["capDate"] = std::string(date);
    m["utcOffset"] = 0.0f;
}

/// Bytes by what they are for, and the most that the process ever had in memory.
nlohmann::json memory_json(const RenderScene& scene, const RenderResult& result) {
    nlohmann::json memory = scene.memory();
    memory.update(nlohmann::json(result.statistics.memory));
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    memory["peak_resident"] = int64_t(usage.ru_maxrss) * 1024;
    return memory;
}

nlohmann::json statistics_json(const RenderScene& scene, const RenderResult& result,
                               const Monitor& monitor) {
    const auto pass = [](const PassStatistics& s) {
        nlohmann::json rejected = nlohmann::json::array();
        for (const RejectedSample& r : s.first_rejected) rejected.push_back({r.x, r.y, r.sample});
        const RayCounts& r = s.rays;
        auto longest = s.lengths.size();
        while (longest > 0 && s.lengths[longest - 1] == 0) --longest;
        const auto per_path = [&s](uint64_t n) {
            return s.samples > 0 ? double(n) / double(s.samples) : 0.0;
        };
        return nlohmann::json{
            {"samples", s.samples},
            {"rays", r.camera + r.bounce + r.shadow},
            {"rays_per_path", per_path(r.camera + r.bounce + r.shadow)},
            {"camera_rays", r.camera},
            {"bounce_rays", r.bounce},
            {"shadow_rays", r.shadow},
            {"vertices", s.vertices},
            {"vertices_per_path", per_path(s.vertices)},
            {"path_lengths", std::vector(s.lengths.begin(), s.lengths.begin() + long(longest))},
            {"black_paths", s.black_paths},
            {"rejected", s.rejected},
            {"thread_seconds", s.seconds},
            {"replay_thread_seconds", s.replay_seconds},
            {"first_rejected", rejected}};
    };
    return {{"seconds_total", monitor.elapsed()},
            {"seconds", result.statistics.seconds},
            {"memory", memory_json(scene, result)},
            {"spp", result.statistics.samples_per_pixel},
            {"covariance", pass(result.statistics.covariance)},
            {"radiance", pass(result.statistics.radiance)},
            {"complete", result.complete}};
}

int render_scene(RenderArguments a, const Invocation& invocation) {
    const ThreadLimit threads(a.threads);
    if (!a.seconds.empty()) a.options.seconds = parse_duration("--time", a.seconds);
    if (!a.resolution.empty())
        a.overrides.resolution = parse_resolution("--resolution", a.resolution);
    if (!a.crop.empty()) a.overrides.crop = parse_crop("--crop", a.crop);
    if (!a.shutter.empty()) a.overrides.shutter = parse_interval("--shutter", a.shutter);

    if (a.quiet && a.progress == ProgressStyle::automatic) a.progress = ProgressStyle::none;
    std::array<std::string, 2> tev_address;
    if (!a.tev.empty()) tev_address = parse_address("--tev", a.tev);
    ProgressLine progress(a.progress);
    Monitor monitor(progress.reporter(), progress.interval(), invocation.start);
    progress.begin();
    const InterruptGuard guard(monitor);

    SceneDescription description =
        read_pbrt(a.scene, {{a.search_paths.begin(), a.search_paths.end()}});
    const double loaded = monitor.elapsed();
    apply(a.overrides, description);
    const fs::path output = output_path(a, description);
    for (const fs::path& file : {output, fs::path(a.png), fs::path(a.stats)})
        if (!file.empty()) require_writable(file);

    RenderScene scene(std::move(description), a.isa, a.texture_bytes);
    const double built = monitor.elapsed();
    progress.clear();
    if (!a.quiet) {
        print_warnings(scene.description.warnings);
        print_warnings(scene.materials.warnings());
    }
    const PixelBounds region = render_region(scene.description.film);
    progress.set_pixels(double(region.width()) * region.height());
    std::optional<TevClient> viewer;
    if (!a.tev.empty()) {
        viewer.emplace(tev_address[0], tev_address[1], output.string());
        monitor.watcher = [&](Image image) {
            keep_layers(image, a.tev_layers);
            viewer->show(std::move(image));
        };
    }
    RenderResult result = render(scene, a.options, monitor);
    result.statistics.seconds["load"] = loaded;
    result.statistics.seconds["build"] = built - loaded;
    const double rendered = monitor.elapsed();
    progress.clear();
    if (viewer) viewer->show(copy_layers(result.image, a.tev_layers));
    keep_layers(result.image, a.layers);
    describe_render(result.image, a, scene, result, monitor, invocation.command_line);
    rename_layers(result.image, a.layer_names);
    write_exr(result.image, output, threads.threads());
    if (!a.png.empty()) write_png(result.image, a.png);
    result.statistics.seconds["write"] = monitor.elapsed() - rendered;
    if (!a.stats.empty()) {
        const std::string text = statistics_json(scene, result, monitor).dump(2) + "\n";
        OutputFile file(a.stats);
        file.write(text.data(), text.size());
        file.commit();
    }
    if (result.complete) progress.done(result.statistics.samples_per_pixel, monitor.elapsed());
    const uint64_t rejected =
        result.statistics.covariance.rejected + result.statistics.radiance.rejected;
    if (rejected > 0) {
        const auto& first = result.statistics.covariance.rejected > 0
                                ? result.statistics.covariance.first_rejected
                                : result.statistics.radiance.first_rejected;
        say("warning: {} samples were not finite and count as black; the first at x,y,sample = "
            "{},{},{}\n",
            rejected, first[0].x, first[0].y, first[0].sample);
    }
    if (!a.quiet)
        say("{}: {:.4g} samples per pixel in {:.1f} s\n", output.string(),
            result.statistics.samples_per_pixel, monitor.elapsed());
    // A viewer that still takes the last image may; all else is done.
    if (viewer) viewer->finish(std::max(0.25, 0.01 * monitor.elapsed()));
    return result.complete ? 0 : 6;
}

void add_layers(CLI::App* c, const std::string& name, LayerSelection& selection,
                const std::string& help) {
    const auto parse = [name, &selection](const std::string& text) {
        selection = parse_layers(name, text);
    };
    c->add_option_function<std::string>(name, parse, help)->option_text("LIST");
}

}  // namespace

void add_render(CLI::App& app, Invocation& invocation) {
    auto a = std::make_shared<RenderArguments>();
    CLI::App* c = app.add_subcommand("render", "Render a pbrt-v4 scene into an EXR with layers");
    c->add_option("SCENE", a->scene, "the scene, a pbrt-v4 file")->required()->option_text(" ");
    c->add_option("-o,--output", a->output, "the image (default: the film's name or SCENE.exr)")
        ->option_text("FILE");
    add_choice<Method>(c, "--method", a->options.method,
                       {{"uniform", Method::uniform},
                        {"covariance", Method::covariance},
                        {"hybrid", Method::hybrid}},
                       "plain, the thesis' method, or hybrid (default)");
    add_positive(c, "--spp", a->options.spp, 1 << 30,
                 "average samples per pixel (default: the scene's)");
    c->add_option("--time", a->seconds, "wall-clock budget: 2.5, 45s, 3m, 1h30m")->option_text("T");
    add_positive(c, "--error", a->options.error, 1e6, "stop at this estimated sqrt(relMSE)");
    c->add_option("--cov-spp", a->options.cov_spp, "covariance paths per pixel (default: 2 to 4)")
        ->check(CLI::Range(1, 1 << 20))
        ->option_text("N");
    add_choice<DensityRule>(c, "--density", a->options.density,
                            {{"tempered", DensityRule::tempered}, {"thesis", DensityRule::thesis}},
                            "how counts follow from the prediction");
    c->add_option("--max-spp", a->options.max_spp,
                  "most samples in a pixel (default: 16 x average)")
        ->check(CLI::Range(1, 1 << 30))
        ->option_text("N");
    c->add_flag("--even-counts", a->options.even_counts, "hybrid: the same count in every pixel");
    add_choice<Occlusion>(
        c, "--occlusion", a->options.occlusion,
        {{"grid", Occlusion::grid}, {"query", Occlusion::query}, {"none", Occlusion::none}},
        "occluders beside the rays of the analysis");
    c->add_option("--voxels", a->options.voxels, "width of the occlusion grid (default 200)")
        ->check(CLI::Range(1, 2048))
        ->option_text("N");
    add_choice<BrdfCovariance>(
        c, "--brdf-covariance", a->options.brdf_covariance,
        {{"local", BrdfCovariance::local}, {"global", BrdfCovariance::global}},
        "a BRDF's frequencies: at the path, or its peak's");
    add_choice<FilterRule>(c, "--filter", a->options.filter,
                           {{"verified", FilterRule::verified}, {"thesis", FilterRule::thesis}},
                           "its constant: verified, or the thesis' eq. 5.7");
    c->add_option("--resolution", a->resolution, "in place of the scene's")->option_text("WxH");
    c->add_option("--crop", a->crop, "only these pixels, end exclusive")
        ->option_text("x0,y0,x1,y1");
    c->add_option("--max-depth", a->options.max_depth,
                  "most scattering events (default: the scene's)")
        ->check(CLI::NonNegativeNumber)
        ->option_text("N");
    c->add_option_function<std::string>(
         "--seed", [a](const std::string& text) { a->options.seed = parse_seed("--seed", text); },
         "seed of all random numbers (default 0)")
        ->option_text("N");
    c->add_option("--threads", a->threads, "worker threads (default: all cores)")
        ->check(CLI::Range(1, 4096))
        ->option_text("N");
    c->add_option("--isa", a->isa, "instruction set of the ray tracing")
        ->check(CLI::IsMember({"sse2", "avx", "avx2", "avx512"}).description(""))
        ->option_text("sse2|avx|avx2|avx512");
    c->add_option("--shutter", a->shutter, "in place of the scene's")->option_text("T0,T1");
    add_positive(c, "--focus", a->overrides.focal_distance, 1e30,
                 "focal distance in place of the scene's");
    add_positive(c, "--fstop", a->overrides.f_number, 1e30,
                 "lens by f-number (full-frame sensor, metres)");
    c->add_option("--search-path", a->search_paths,
                  "also look here for the scene's files; repeatable")
        ->check(CLI::ExistingDirectory.description(""))
        ->allow_extra_args(false)
        ->option_text("DIR");
    c->add_option("--png", a->png, "also a tone-mapped sRGB picture")->option_text("FILE");
    add_layers(c, "--layers", a->layers, "all, or name,name…: layers beside the image");
    add_choice<LayerNames>(c, "--layer-names", a->layer_names,
                           {{"default", LayerNames::standard},
                            {"pbrt", LayerNames::pbrt},
                            {"blender", LayerNames::blender}},
                           "whose names the layers get in the EXR");
    c->add_option("--tev", a->tev, "show the image in the viewer tev while it renders")
        ->option_text("HOST:PORT");
    add_layers(c, "--tev-layers", a->tev_layers, "layers that tev shows, too (default: none)");
    add_choice<ProgressStyle>(c, "--progress", a->progress,
                              {{"auto", ProgressStyle::automatic},
                               {"bar", ProgressStyle::bar},
                               {"plain", ProgressStyle::plain},
                               {"percent", ProgressStyle::percent},
                               {"json", ProgressStyle::json},
                               {"none", ProgressStyle::none}},
                              "how progress is shown on standard error");
    c->add_option_function<std::string>(
         "--texture-memory",
         [a](const std::string& text) { a->texture_bytes = parse_size("--texture-memory", text); },
         "most bytes of texture images: 500M, 2G")
        ->option_text("SIZE");
    c->add_option("--stats", a->stats, "counters, phase times and memory as JSON")
        ->option_text("FILE");
    c->add_flag("--reproducible", a->reproducible, "write no command, seconds and date");
    c->add_flag("--quiet", a->quiet, "errors only");
    c->callback([a, &invocation] {
        invocation.action = [a, &invocation] { return render_scene(*a, invocation); };
    });
}

}  // namespace covtrace::cli
