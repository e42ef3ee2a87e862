#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <exception>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cli/commands.h"
#include "cli/failure.h"
#include "cli/frames.h"
#include "cli/interrupts.h"
#include "cli/memory_limit.h"
#include "cli/message.h"
#include "cli/mpi_module.h"
#include "cli/pixel_warnings.h"
#include "cli/render_options.h"
#include "cli/render_outputs.h"
#include "cli/render_statistics.h"
#include "cli/sample_description.h"
#include "cli/scene_input.h"
#include "core/memory_limit.h"
#include "core/parallel.h"
#include "image/darkness.h"
#include "image/image.h"
#include "image/output_file.h"
#include "image/write_image.h"
#include "preview/tev_client.h"
#include "render/film_files.h"
#include "render/layers.h"
#include "render/render_memory.h"
#include "render/session.h"
#include "scene/framing.h"

namespace covtrace::cli {

namespace {

namespace fs = std::filesystem;

/// Adds to the image's metadata how it was made, beside the metadata that its film knows.
void describe_making(Image& image, const Monitor& monitor, const std::string& command) {
    auto& m = image.metadata;
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

void write_text(const std::string& text, const fs::path& path) {
    OutputFile file(path);
    file.write(text.data(), text.size());
    file.commit();
}

void parse_texts(RenderArguments& a) {
    if (!a.seconds.empty()) a.options.seconds = parse_duration("--time", a.seconds);
    a.options.denoiser_quality = a.denoiser.quality;
    if (a.quiet && a.progress == ProgressStyle::automatic) a.progress = ProgressStyle::none;
    request_layers(a.layers, a.options);
    request_layers(a.tev_layers, a.options);
    check(a.film);
    resolve(a.display);
    if (a.tev.empty() && (a.tev_layers.all || !a.tev_layers.names.empty()))
        throw Error(ErrorKind::usage, "--tev-layers: expected --tev HOST:PORT");
    if (a.fps && !a.frames) throw Error(ErrorKind::usage, "--fps: expected --frames");
    if (a.frames && a.scene == kStandardInput)
        throw Error(ErrorKind::usage,
                    "SCENE: standard input is read once; --frames expects a file");
    if (a.film.shard && !(a.output.empty() && a.png.empty() && a.tev.empty()))
        throw Error(
            ErrorKind::usage,
            "--shard: a shard has no image; expected neither --output, --png nor --tev, but "
            "'covtrace merge' of all shards");
}

/// Writes the image, with the layers that were asked for, and its PNG. `names`: those of the
/// layers.
void deliver(RenderResult& result, const RenderArguments& a, LayerNames names,
             const fs::path& output, const Monitor& monitor, const std::string& command,
             int threads) {
    if (!a.quiet) warn_of_absent_layers(result.image, a.layers);
    if (!a.quiet) warn_of_no_picture(a.display.options, output, a.png);
    keep_layers(result.image, a.layers);
    if (!a.reproducible) describe_making(result.image, monitor, command);
    const bool has_layers = written_format(output) == WrittenFormat::exr;
    if (has_layers) rename_layers(result.image, names);
    write_image(result.image, output, threads, a.display.options);
    if (has_layers) restore_layer_names(result.image);
    if (!a.png.empty()) write_png(result.image, a.png, a.display.options);
}

/// The names that the layers get: pbrt's where the scene's film is its "gbuffer".
LayerNames names_of_layers(const RenderArguments& a, const SceneDescription& scene) {
    const bool is_pbrts = scene.film.surfaces != FilmDescription::Surfaces::none;
    return a.layer_names.value_or(is_pbrts ? LayerNames::pbrt : LayerNames::standard);
}

/// Warns once of a viewer that is not there: it may come later, and the render needs none.
void warn_of_absent_viewer(TevClient& viewer, const RenderArguments& a, ProgressLine& progress) {
    const std::string why = viewer.take_failure();
    if (why.empty() || a.quiet) return;
    progress.clear();
    say("warning: --tev: the viewer tev is not there at '{}': {}\n", a.tev, why);
}

/// Drops outputs and messages, for all but the first of several processes, which only trace.
void be_silent(RenderArguments& a) {
    a.quiet = true;
    a.progress = ProgressStyle::none;
    a.output = "/dev/null";
    a.png.clear();
    a.stats.clear();
    a.tev.clear();
}

/// The denoiser of a render; none where no image is made, or by a method that has none.
FoundDenoiser denoiser_of(const RenderArguments& a, bool is_first) {
    if (a.options.method != Method::hybrid || a.film.shard || a.debug_pixel || !is_first) return {};
    return find(a.denoiser);
}

/// The scene that is rendered. The end of the process frees it at once: taking millions of
/// instances apart one by one takes seconds, after all that was asked for is done.
std::unique_ptr<RenderScene>& kept_scene() {
    static auto* kept = new std::unique_ptr<RenderScene>;  // reachable, so that it is no leak
    return *kept;
}

RenderScene& build_scene(SceneDescription description, const RenderArguments& a,
                         const Monitor& monitor) {
    kept_scene() =
        std::make_unique<RenderScene>(std::move(description), isa_name(a.isa), a.texture_bytes,
                                      a.options.guides, [&monitor] { return monitor.cancelled(); });
    return *kept_scene();
}

/// Reads the scene, with all that takes the place of its own values.
SceneDescription read_described(RenderArguments& a) {
    a.reading.search_paths = {a.search_paths.begin(), a.search_paths.end()};
    a.reading.shutter = a.overrides.shutter;
    SceneDescription description = read_scene(a.scene, a.reading);
    apply(a.overrides, description);
    if (a.preset) apply(*a.preset, a.overrides, description, a.options);
    return description;
}

/// Refuses what the processes of mpirun cannot do.
void check_shared(const RenderArguments& a) {
    if (a.film.shard)
        throw Error(ErrorKind::usage, "--shard: the processes of mpirun share the tiles already");
    if (a.scene == kStandardInput)
        throw Error(
            ErrorKind::usage,
            "SCENE: only one of the processes of mpirun has standard input; expected a file");
}

/// Refuses to write an image of nothing.
void require_samples(const RenderResult& result, const Monitor& monitor) {
    if (monitor.cancelled() && result.statistics.samples_per_pixel == 0)
        throw Error(ErrorKind::interrupted,
                    "interrupted before the first sample: nothing is written");
}

/// Faults of an image as a picture of its scene.
struct PictureFaults {
    double dark = 0;               ///< dark_share
    bool has_environment = false;  ///< of the option --environment
    std::string other_view;        ///< one that sees the scene, where this one sees nothing
    int too_bright = 0;            ///< stops_too_bright, of pictures
};

PictureFaults faults_of(const RenderArguments& a, const fs::path& output, const Image& image,
                        SceneDescription& scene) {
    PictureFaults found;
    found.dark = dark_share(image);
    found.has_environment = !scene.environment_override.empty();
    if (a.film.shard) return found;
    if (shows_nothing(image)) found.other_view = view_of_all(scene);
    if (!a.png.empty() || output.extension() == ".png")
        found.too_bright = stops_too_bright(image, a.display.options);
    return found;
}

/// Tells what was rendered, and what went wrong with it. `told`: of tell_warnings; of frames the
/// first with a fault stands for all others.
void tell_outcome(const RenderResult& result, const RenderArguments& a, const fs::path& output,
                  const PictureFaults& faults, const Monitor& monitor,
                  std::set<std::string>& told) {
    warn_of_rejected(result.statistics);
    warn_of_replaced(result.image);
    if (result.is_below_least)
        say("warning: --time: the time was over before every pixel had the samples that an image "
            "needs\n");
    if (a.quiet) return;
    warn_of_failed_denoiser(result.image);
    const auto is_new = [&told](const char* fault) { return told.insert(fault).second; };
    if (faults.dark >= kMostlyDark && is_new("dark"))
        warn_of_darkness(faults.dark, faults.has_environment);
    if (!faults.other_view.empty() && is_new("nothing")) warn_of_nothing(faults.other_view);
    if (faults.too_bright > 0 && is_new("bright"))
        warn_of_overexposure(faults.too_bright, a.display.exposure);
    say("{}: {:.4g} samples per pixel{} in {:.1f} s{}\n",
        a.film.shard ? a.film.film : output.string(), result.statistics.samples_per_pixel,
        result.statistics.density_factor
            ? fmt::format(" (k = {:.4g})", *result.statistics.density_factor)
            : "",
        monitor.elapsed(), is_denoised_fast(result.image) ? ", denoised fast" : "");
}

/// Tells what of the options and of the scene is not done as they say. `told`: what other frames
/// have told of their scenes, which is not told again.
void tell_warnings(const RenderArguments& a, const fs::path& output, const FoundDenoiser& denoiser,
                   const RenderScene& scene, std::set<std::string>& told) {
    if (!a.frame || *a.frame == a.frames->first) {
        warn_of_unusable(denoiser);
        warn_of_config(a.display.options);
        warn_of_idle(a, output);
    }
    for (const Warnings& warnings : {scene.description.warnings, scene.materials.warnings()})
        for (const Warning& w : warnings)
            if (told.insert(to_text(w)).second) say("warning: {}\n", to_text(w));
}

/// Renders a scene at one moment. `ranks`: the processes that share the work; may be null.
/// `told`: of tell_warnings.
int render_scene(RenderArguments a, const Invocation& invocation, const ThreadLimit& threads,
                 const Ranks* ranks, std::set<std::string>& told) {
    const bool is_first = !ranks || ranks->index() == 0;
    if (!is_first) be_silent(a);
    if (ranks) check_shared(a);
    std::array<std::string, 2> tev_address;
    if (!a.tev.empty()) tev_address = parse_address("--tev", a.tev);
    ProgressLine progress(a.progress);
    Monitor monitor(progress.reporter(), progress.interval(), invocation.start);
    progress.begin();
    monitor.interrupted = &InterruptGuard::flag();
    const MemoryLimit memory(a.max_memory);

    // Read the scene, and check everything before hours of rendering
    SceneDescription description = read_described(a);
    const double loaded = monitor.elapsed();
    const bool is_shard = a.film.shard.has_value();
    const fs::path output = is_shard ? fs::path() : image_path(a, description);
    check_outputs(a, output, description);
    const FoundDenoiser denoiser = denoiser_of(a, is_first);
    a.options.denoiser = denoiser.denoiser;
    FilmFiles films(a.film, [&progress](const std::string& text) {
        progress.clear();
        say("warning: {}\n", text);
    });
    FilmKeeping keeping = films.keeping(is_first);
    keeping.ranks = ranks;
    require_memory(a.max_memory,
                   render_memory(description.film, a.options, may_tell_opacity(description)));

    // Build the scene
    RenderScene& scene = build_scene(std::move(description), a, monitor);
    const double built = monitor.elapsed();
    progress.clear();
    if (!a.quiet) tell_warnings(a, output, denoiser, scene, told);
    require_memory(a.max_memory,
                   render_memory(scene.description.film, a.options, scene.tells_opacity), &scene);
    // Tell one sample's path instead, for --debug-pixel
    if (a.debug_pixel) {
        const std::string text = describe_sample(scene, a.options, *a.debug_pixel);
        if (is_first) fmt::print("{}", text);
        return 0;
    }
    // Render, and show the image as it grows
    const PixelBounds region = render_region(scene.description.film);
    progress.set_pixels(double(region.width()) * region.height());
    std::optional<TevClient> viewer;
    if (!a.tev.empty()) {
        viewer.emplace(tev_address[0], tev_address[1], output.string());
        monitor.watcher = [&](Image image) {
            keep_layers(image, a.tev_layers);
            viewer->show(std::move(image));
            warn_of_absent_viewer(*viewer, a, progress);
        };
    }
    RenderResult result = render(scene, a.options, monitor, std::move(keeping));
    require_samples(result, monitor);
    result.statistics.seconds[Phase::load] = loaded;
    result.statistics.seconds[Phase::build] = built - loaded;
    const double rendered = monitor.elapsed();
    const PictureFaults faults = faults_of(a, output, result.image, scene.description);
    // Write the files and tell what was done
    progress.clear();
    if (viewer) viewer->show(copy_layers(result.image, a.tev_layers));
    if (!is_shard && is_first)
        deliver(result, a, names_of_layers(a, scene.description), output, monitor,
                invocation.command_line, threads.threads());
    result.statistics.seconds[Phase::write] = monitor.elapsed() - rendered;
    if (!a.stats.empty())
        write_text(statistics_json(scene, result, denoiser, monitor).dump(2) + "\n", a.stats);
    if (result.complete || (is_shard && !monitor.cancelled()))
        progress.done(result.statistics.samples_per_pixel, monitor.elapsed(), monitor.error());
    tell_outcome(result, a, output, faults, monitor, told);
    // A viewer that still takes the last image may do so; all else is done.
    if (viewer) {
        viewer->finish(std::max(0.25, 0.01 * monitor.elapsed()));
        warn_of_absent_viewer(*viewer, a, progress);
    }
    films.finish();
    return result.complete || (is_shard && !monitor.cancelled()) ? 0 : 6;
}

/// Renders the scene, or its frames in turn until one of them fails or is interrupted.
int render_frames(RenderArguments a, const Invocation& invocation, const ThreadLimit& threads,
                  const Ranks* ranks) {
    std::set<std::string> told;
    const InterruptGuard guard;
    if (!a.frames) return render_scene(std::move(a), invocation, threads, ranks, told);
    at_frame(a, a.frames->last);  // throws before hours of rendering
    Invocation of_frame{invocation.start, invocation.command_line, {}};
    for (int frame = a.frames->first; frame <= a.frames->last; frame += a.frames->step) {
        const int code = render_scene(at_frame(a, frame), of_frame, threads, ranks, told);
        if (code != 0) return code;
        // An interrupt that comes while a whole frame is written ends the others.
        if (InterruptGuard::flag() && frame <= a.frames->last - a.frames->step)
            throw Error(ErrorKind::interrupted,
                        fmt::format("interrupted after frame {} of {}", frame, a.frames->last));
        kept_scene().reset();  // before the next one takes as much memory
        of_frame.start = std::chrono::steady_clock::now();
    }
    return 0;
}

int run_render(RenderArguments a, const Invocation& invocation) {
    const ThreadLimit threads(a.threads);
    parse_texts(a);
    const std::unique_ptr<Ranks> ranks = join_ranks();
    if (!ranks) return render_frames(std::move(a), invocation, threads, nullptr);
    try {
        return render_frames(std::move(a), invocation, threads, ranks.get());
    } catch (...) {
        // All processes are ended at once: the others may wait for this one, which would wait for
        // them in MPI_Finalize.
        const int code = report_failure(std::current_exception());
        ranks->abort(code);
        return code;
    }
}

}  // namespace

void add_render(CLI::App& app, Invocation& invocation) {
    auto a = std::make_shared<RenderArguments>();
    CLI::App* c = app.add_subcommand("render", "Render a scene into an EXR with layers");
    add_render_options(c, *a);
    c->callback([a, &invocation] {
        invocation.action = [a, &invocation] { return run_render(*a, invocation); };
    });
}

}  // namespace covtrace::cli
