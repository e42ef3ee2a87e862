/// The state of a render between two of its samples: what it was asked for, how far it is, and its
/// film. Whoever has the state can go on, to the same bits, or make the image.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/enum_names.h"
#include "integrator/render_scene.h"
#include "planner/error_goal.h"
#include "prediction/covariance_buffer.h"
#include "reconstruction/filter_field.h"
#include "render/film.h"
#include "render/options.h"
#include "render/pass.h"
#include "render/render_identity.h"

namespace covtrace {

/// Stage of a render: the kind of samples that the round in progress, or the next one, takes.
enum class Stage {
    first_paths,  ///< one covariance path in every pixel, to learn how bright paths are
    pilot,        ///< the other covariance paths and, for `hybrid`, the first samples without
    rounds        ///< samples where the plan wants them
};

template <>
inline constexpr auto kEnumNames<Stage> = enum_names<Stage>({{Stage::first_paths, "first_paths"},
                                                             {Stage::pilot, "pilot"},
                                                             {Stage::rounds, "rounds"}});

/// Knowledge of the light's frequencies. `uniform`: none. `covariance`: emitters in view and
/// scattered light, apart. `hybrid`: these two up to the end of the pilot, from then on both
/// together, a matrix per pixel.
using Covariances = std::variant<std::monostate, CovarianceBuffers, std::vector<PackedCovariance>>;

struct RenderState {
    RenderIdentity identity;
    Method method = Method::uniform;
    FilterRule filter = FilterRule::verified;
    PixelBounds region;      ///< the pixels to render
    PixelBounds display;     ///< the full frame
    bool has_holes = false;  ///< LitScene::has_holes
    Metadata metadata;       ///< metadata of the image: version, scene, camera

    Stage stage = Stage::rounds;
    double covariance_spp = 0;           ///< covariance paths per pixel
    std::optional<double> weight_limit;  ///< limit for covariance paths after the first ones
    /// Average samples per pixel, as planned: at the end of the last whole round, and at the end of
    /// the round in progress.
    double taken = 0, target = 0;
    /// Plan of the round in progress: for each film, samples of each pixel at its end. Empty
    /// between rounds.
    std::vector<std::vector<uint32_t>> plan;
    std::optional<double> spp;            ///< the budget, where it was a count
    bool complete = false;                ///< whether the budget is spent
    ErrorGoal goal;                       ///< the errors that earlier rounds ended with
    double seconds = 0, seconds_spp = 0;  ///< cost of tracing: seconds for samples per pixel

    std::vector<Film> films;  ///< one film; for `hybrid` two, the halves
    Covariances covariances;
    std::vector<float> density;  ///< the last plan's density, samples per pixel

    uint64_t rejected = 0;                       ///< samples that were not finite
    std::vector<RejectedSample> first_rejected;  ///< a few of these samples

    /// Shards of the render: how many there are, and the indices (from 0) of those whose samples
    /// are here. `present` is empty where all pixels are here.
    int shards = 1;
    std::vector<int> present;

    /// Makes the state before the first sample.
    RenderState(const RenderScene& scene, const RenderOptions& options);
    /// Makes an empty state, to be filled by a reader of films.
    RenderState() = default;

    size_t pixels() const { return size_t(region.width()) * size_t(region.height()); }
    bool in_round() const { return !plan.empty(); }
    /// Whether every pixel of the shard's tiles has at least `counts` samples in film k.
    bool has(size_t k, std::span<const uint32_t> counts, const Shard& shard) const;
    /// Whether every pixel of the shard's tiles has the samples of the plan.
    bool reached(const Shard& shard) const;
    double mean_count() const;
    /// Covariances of emitters in view and of scattered light, apart; only where they are held so.
    CovarianceBuffers& parts() { return std::get<CovarianceBuffers>(covariances); }
    const CovarianceBuffers& parts() const { return std::get<CovarianceBuffers>(covariances); }
    /// Covariance of all light together; not for `uniform`.
    CovarianceBuffer covariance() const;
    /// Bytes by use: "film"; "plan"; "prediction" where there is one.
    std::map<std::string, size_t> memory() const;
    /// Leaves zeros in all pixels but those of the shard's tiles.
    void keep_only(const Shard& shard);
};

/// The records that films of a method keep beside their pixels.
FilmParts film_parts(Method method);

/// Ends a round: draws its conclusions and goes to the next stage. To be called where all pixels
/// have the samples of the plan.
void finish_round(RenderState& state);

}  // namespace covtrace
