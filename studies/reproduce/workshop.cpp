#include "reproduce/workshop.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include "pbrt/read_scene.h"
#include "render/overrides.h"

namespace covtrace::reproduce {

double cpu_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
        return double(t.tv_sec) + 1e-6 * double(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

namespace {

/// The word as a shell takes it for one.
std::string quoted(const std::string& word) {
    constexpr auto kPlain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789/._-+=:,@%";
    if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
    std::string result = "'";
    for (const char c : word) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
}

}  // namespace

Workshop::Workshop(Size chosen, fs::path folder, const fs::path& given_scenes,
                   const std::atomic<bool>& interrupted, Say say)
    : size(chosen),
      settings(settings_of(chosen)),
      output(std::move(folder)),
      scenes(given_scenes, output / "scenes"),
      say_(std::move(say)),
      start_(cpu_seconds()),
      interrupted_(interrupted) {}

LoadedScene Workshop::load(const std::string& name, const fs::path& file,
                           std::array<int, 2> resolution,
                           std::optional<std::array<float, 2>> shutter) {
    const double start = cpu_seconds();
    SceneDescription description = read_pbrt(file);
    SceneOverrides overrides;
    overrides.resolution = resolution;
    overrides.shutter = shutter;
    apply(overrides, description);
    LoadedScene loaded{name, file, resolution,
                       std::make_unique<RenderScene>(std::move(description)), 0};
    loaded.load_cpu = cpu_seconds() - start;
    return loaded;
}

Timed Workshop::render(LoadedScene& scene, const RenderOptions& options,
                       std::function<void(Monitor&, Image)> watcher) {
    Monitor monitor;
    if (watcher) monitor.watcher = [&](Image image) { watcher(monitor, std::move(image)); };
    monitor.interrupted = &interrupted_;
    Timed timed;
    timed.command = render_command(scene, options);
    const double start = cpu_seconds();
    timed.result = covtrace::render(*scene.scene, options, monitor);
    timed.cpu = cpu_seconds() - start;
    timed.wall = monitor.elapsed();
    if (interrupted_) throw Error(ErrorKind::interrupted, "interrupted");
    return timed;
}

std::string reproduce_command(const Workshop& workshop, const std::string& experiment) {
    return fmt::format("covtrace reproduce {} -o {}{}", experiment,
                       quoted(workshop.output.string()),
                       workshop.size == Size::full ? "" : " --" + name_of(workshop.size));
}

std::string render_command(const LoadedScene& scene, const RenderOptions& o) {
    const RenderOptions d;
    std::string s = fmt::format("covtrace render {} --resolution {}x{} --method {}",
                                quoted(scene.file.string()), scene.resolution[0],
                                scene.resolution[1], name_of(o.method));
    if (o.method == Method::hybrid && !o.denoiser) s += " --denoiser none";
    if (o.spp) s += fmt::format(" --spp {}", *o.spp);  // as few digits as give the same number
    if (o.cov_spp) s += fmt::format(" --cov-spp {}", *o.cov_spp);
    if (o.max_spp) s += fmt::format(" --max-spp {}", *o.max_spp);
    if (o.density != d.density) s += fmt::format(" --density {}", name_of(o.density));
    if (o.density_factor) s += fmt::format(" --k {}", *o.density_factor);
    if (o.filter != d.filter) s += fmt::format(" --filter {}", name_of(o.filter));
    if (o.occlusion != d.occlusion) s += fmt::format(" --occlusion {}", name_of(o.occlusion));
    if (asks_grid(o.occlusion)) s += fmt::format(" --voxels {}", o.voxels);
    if (o.brdf_covariance != d.brdf_covariance) s += " --brdf-covariance global";
    if (o.texture_bandwidth != d.texture_bandwidth) s += " --texture-bandwidth highest";
    if (o.progressive) s += " --progressive";
    return s + fmt::format(" --seed {}", o.seed);
}

}  // namespace covtrace::reproduce
