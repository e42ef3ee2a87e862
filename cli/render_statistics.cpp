#include "cli/render_statistics.h"

#include <sys/resource.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "image/finite_pixels.h"

namespace covtrace::cli {

namespace {

/// Bytes by use, and the most that the process ever had in memory.
nlohmann::json memory_json(const RenderScene& scene, const RenderResult& result) {
    std::map<std::string, size_t> bytes = scene.memory();
    for (const auto& [name, count] : result.statistics.memory)
        bytes[name == "spectra" ? "textures" : name] += count;
    nlohmann::json memory = bytes;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    memory["peak_resident"] = int64_t(usage.ru_maxrss) * 1024;
    return memory;
}

/// Name, file and quality of the denoiser that was used, or the reason why there is none; null
/// where none is needed.
nlohmann::json denoiser_json(const FoundDenoiser& found, const Metadata& image) {
    const auto failure = image.find("covtrace:denoiserFailure");
    if (failure != image.end())
        return {{"why_none", std::get<std::string>(failure->second)},
                {"file", found.library.string()}};
    if (found.denoiser) {
        nlohmann::json used{{"name", found.denoiser->name()}, {"file", found.library.string()}};
        const auto quality = image.find("covtrace:denoiserQuality");
        if (quality != image.end()) used["quality"] = std::get<std::string>(quality->second);
        return used;
    }
    if (!found.why_none.empty()) return {{"why_none", found.why_none}};
    return nullptr;
}

/// Number of the pixels that are not as rendered, the first of them, and their layers.
nlohmann::json replaced_json(const Metadata& image) {
    const auto r = replaced_pixels(image);
    if (!r) return {{"count", 0}};
    return {{"count", r->pixels}, {"first", {r->x, r->y}}, {"layers", r->layers}};
}

/// The outcome of each guide.
nlohmann::json guides_json(const RenderScene& scene) {
    nlohmann::json all;
    for (const auto& [name, o] : scene.guide_outcomes())
        all[name] = {{"state", std::string(name_of(o.state))},
                     {"seconds", o.seconds},
                     {"bytes", o.bytes},
                     {"second_moment",
                      o.second_moment > 0 ? nlohmann::json(o.second_moment) : nlohmann::json()}};
    return all;
}

}  // namespace

nlohmann::json statistics_json(const RenderScene& scene, const RenderResult& result,
                               const FoundDenoiser& denoiser, const Monitor& monitor) {
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
    const std::optional<double>& k = result.statistics.density_factor;
    return {{"seconds_total", monitor.elapsed()},
            {"seconds", named(result.statistics.seconds)},
            {"denoiser", denoiser_json(denoiser, result.image.metadata)},
            {"guides", guides_json(scene)},
            {"memory", memory_json(scene, result)},
            {"spp", result.statistics.samples_per_pixel},
            {"k", k ? nlohmann::json(*k) : nlohmann::json()},
            {"covariance", pass(result.statistics.covariance)},
            {"radiance", pass(result.statistics.radiance)},
            {"replaced_pixels", replaced_json(result.image.metadata)},
            {"complete", result.complete}};
}

}  // namespace covtrace::cli
