/// The options of a render. The defaults are those of the command line. All places that a new one
/// touches: docs/internals/architecture.md, "To add".
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/enum_names.h"
#include "frequency/brdf_covariance.h"
#include "image/image.h"
#include "integrator/guides/guide_outcome.h"
#include "planner/density.h"
#include "reconstruction/denoiser.h"
#include "reconstruction/filter_field.h"
#include "scene/scene_description.h"
#include "texture/spectra.h"

namespace covtrace {

enum class Method {
    uniform,     ///< the plain path tracer: every pixel the same count, the scene's filter
    covariance,  ///< the method of Belcour 2012, section 5.1: prediction, counts, Gaussian gather
    hybrid       ///< prediction and samples together: adaptive counts, candidates, selection
};

template <>
inline constexpr auto kEnumNames<Method> = enum_names<Method>({{Method::uniform, "uniform"},
                                                               {Method::covariance, "covariance"},
                                                               {Method::hybrid, "hybrid"}});

/// Source from which the frequency analysis learns of occluders beside a ray.
enum class Occlusion {
    none,    ///< no occluders
    grid,    ///< a voxel grid of the scene, whose voxels tell of edges at their distance
    voxels,  ///< the grid as in Belcour 2012: each occupied voxel on the way occludes
    query    ///< the outlines of the geometry itself
};

template <>
inline constexpr auto kEnumNames<Occlusion> = enum_names<Occlusion>({{Occlusion::none, "none"},
                                                                     {Occlusion::grid, "grid"},
                                                                     {Occlusion::voxels, "voxels"},
                                                                     {Occlusion::query, "query"}});

constexpr bool asks_grid(Occlusion o) {
    return o == Occlusion::grid || o == Occlusion::voxels;
}

struct RenderOptions {
    Method method = Method::hybrid;
    std::optional<double> spp;      ///< average samples per pixel; default: the scene's
    std::optional<double> seconds;  ///< wall clock, from `start_time` to the finished file
    std::optional<double>
        error;  ///< stop at this estimated sqrt(relMSE) of the image; not covariance
    /// Covariance paths per pixel, below 1 in so many of the pixels; default 2, hybrid: 1.
    std::optional<double> cov_spp;
    DensityRule density = DensityRule::verified;
    /// Factor k of N = k sqrt|S|, a budget that no average bounds; covariance with
    /// DensityRule::thesis.
    std::optional<double> density_factor;
    Occlusion occlusion = Occlusion::query;
    int voxels = 200;  ///< width of the grid
    BrdfCovariance brdf_covariance = BrdfCovariance::local;
    TextureBandwidth texture_bandwidth = TextureBandwidth::own;
    FilterRule filter = FilterRule::verified;
    std::optional<int> max_spp;  ///< most samples in any pixel; default 16 times the average
    /// Samples on demand, covariance only: each round samples where the noise of the samples so far
    /// asks for it, and `max_spp` limits the samples of a pixel in one round, not in all.
    bool progressive = false;
    /// Denoiser whose image is one more candidate, hybrid only; null: none. Has no influence on the
    /// samples but on when `error` and `seconds` end them.
    std::shared_ptr<const Denoiser> denoiser;
    /// The part that the denoiser has in the image; none: high quality, or fast where `seconds`
    /// leave too little for it.
    std::optional<DenoiserQuality> denoiser_quality;
    Guides guides = Guides::automatic;  ///< what leads paths: for whoever builds the scene
    bool even_counts = false;           ///< hybrid: every pixel the same count, for comparisons
    bool emitters_apart = false;        ///< uniform: keeps the light of emitters in view apart
    bool features = false;  ///< keeps what denoisers are told of each pixel, for the layers
    /// Keeps the first surfaces for the layers, in world space unless the scene says otherwise.
    bool surfaces = false;
    uint64_t seed = 0;
};

/// The space in which a film keeps the first surfaces, if it does.
FilmDescription::Surfaces kept_surfaces(const FilmDescription& film, const RenderOptions& options);

/// The average of samples per pixel that is asked for; none where time, error or the factor of the
/// density alone decide.
std::optional<double> target_spp(const SceneDescription& scene, const RenderOptions& options);

}  // namespace covtrace
