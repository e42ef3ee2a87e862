/// All that a render is between two of its samples: what it was asked for, where it stands, and its
/// film. Whoever has it can go on, to the same bits, or make the image.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "integrator/render_scene.h"
#include "planner/error_goal.h"
#include "prediction/covariance_buffer.h"
#include "reconstruction/filter_field.h"
#include "render/film.h"
#include "render/options.h"
#include "render/pass.h"

namespace covtrace {

/// What happens in the round in progress, or in the next one.
enum class Stage {
    first_paths,  ///< one covariance path in every pixel: how bright paths are
    pilot,        ///< the other covariance paths; `hybrid`: and the first samples without
    rounds        ///< samples where the plan wants them
};

/// What must agree for a render to go on, by name: version, scene, sampling options.
using RenderIdentity = std::map<std::string, std::string>;

struct RenderState {
    RenderIdentity identity;
    Method method = Method::uniform;
    FilterRule filter = FilterRule::verified;
    PixelBounds region;      ///< the pixels to render
    PixelBounds display;     ///< the full frame
    bool has_holes = false;  ///< nothing lies behind the scene
    Metadata metadata;       ///< of the image: version, scene, camera

    Stage stage = Stage::rounds;
    double covariance_spp = 0;           ///< covariance paths per pixel
    std::optional<double> weight_limit;  ///< of covariance paths after the first ones
    /// Average samples per pixel, as planned, at the end of the last whole round, and of the round
    /// in progress.
    double taken = 0, target = 0;
    /// Of the round in progress: samples of each pixel at its end, for each film. Empty between
    /// rounds.
    std::vector<std::vector<uint32_t>> plan;
    std::optional<double> spp;            ///< the budget, where it was a count
    bool complete = false;                ///< the budget is spent
    ErrorGoal goal;                       ///< what the errors after earlier rounds told
    double seconds = 0, seconds_spp = 0;  ///< what tracing cost: seconds for samples per pixel

    std::vector<Film> films;                 ///< one; `hybrid`: two halves
    std::optional<CovarianceBuffers> parts;  ///< `hybrid`: up to the end of the pilot
    std::vector<PackedCovariance> all;       ///< `hybrid`: both parts, from then on
    std::vector<float> density;              ///< what the last plan wanted, samples per pixel

    uint64_t rejected = 0;                       ///< samples that were not finite
    std::vector<RejectedSample> first_rejected;  ///< a few of them

    /// Films that were made by shards: how many there are, and which of them these samples are of
    /// (from 0). None: all pixels are here.
    int shards = 1;
    std::vector<int> present;

    /// Before the first sample.
    RenderState(const RenderScene& scene, const RenderOptions& options);
    /// For reading: films without content.
    RenderState() = default;

    size_t pixels() const { return size_t(region.width()) * size_t(region.height()); }
    bool in_round() const { return !plan.empty(); }
    /// Whether every pixel of the shard's tiles has at least `counts` samples in film k.
    bool has(size_t k, std::span<const uint32_t> counts, const Shard& shard) const;
    /// Whether every pixel of the shard's tiles has what the plan wants.
    bool reached(const Shard& shard) const;
    double mean_count() const;
    /// Of both parts of the light.
    CovarianceBuffer covariance() const {
        return parts ? merge(*parts) : unpack(all, region.width(), region.height());
    }
    /// Bytes by what they are for: "film"; "plan"; "prediction" where there is one.
    std::map<std::string, size_t> memory() const;
    /// Leaves zeros in all pixels but those of the shard's tiles.
    void keep_only(const Shard& shard);
};

/// Bytes that a render keeps for each pixel, plan and prediction included, where they are most.
/// `uniform_parts`: what `uniform` keeps beside its pixels.
size_t film_bytes_per_pixel(Method method, FilmParts uniform_parts = {});

/// What the films of one method keep.
FilmParts film_parts(Method method);

/// To be called where all pixels have what the plan wants: draws the conclusions and goes to the
/// next stage.
void finish_round(RenderState& state);

/// Version and commit of this program: what films keep as their "version".
std::string program_version();

/// What must agree between a film and a render that is to go on with it.
RenderIdentity render_identity(const RenderScene& scene, const RenderOptions& options);

/// Several lines for people: the method, where it stands, what it was asked for, what it holds.
std::string describe(const RenderState& state);

/// The first difference, as "--seed: 1, not 2"; none where all agree.
std::optional<std::string> difference(const RenderIdentity& is, const RenderIdentity& expected);

}  // namespace covtrace
