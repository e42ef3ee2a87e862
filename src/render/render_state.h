/// All that a render is between two of its samples: what it was asked for, where it stands, and its
/// film. Whoever has it can go on, to the same bits, or make the image.
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

/// What happens in the round in progress, or in the next one.
enum class Stage {
    first_paths,  ///< one covariance path in every pixel: how bright paths are
    pilot,        ///< the other covariance paths; `hybrid`: and the first samples without
    rounds        ///< samples where the plan wants them
};

template <>
inline constexpr auto kEnumNames<Stage> = enum_names<Stage>({{Stage::first_paths, "first_paths"},
                                                             {Stage::pilot, "pilot"},
                                                             {Stage::rounds, "rounds"}});

/// What is known of the light's frequencies. `uniform`: nothing. `covariance`: emitters in view and
/// scattered light, apart. `hybrid`: the same up to the end of the pilot, from then on both
/// together, a matrix per pixel.
using Covariances = std::variant<std::monostate, CovarianceBuffers, std::vector<PackedCovariance>>;

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

    std::vector<Film> films;  ///< one; `hybrid`: two halves
    Covariances covariances;
    std::vector<float> density;  ///< what the last plan wanted, samples per pixel

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
    /// Emitters in view and scattered light apart; only where the covariances are held so.
    CovarianceBuffers& parts() { return std::get<CovarianceBuffers>(covariances); }
    const CovarianceBuffers& parts() const { return std::get<CovarianceBuffers>(covariances); }
    /// All light together; not for `uniform`.
    CovarianceBuffer covariance() const;
    /// Bytes by what they are for: "film"; "plan"; "prediction" where there is one.
    std::map<std::string, size_t> memory() const;
    /// Leaves zeros in all pixels but those of the shard's tiles.
    void keep_only(const Shard& shard);
};

/// What the films of one method keep.
FilmParts film_parts(Method method);

/// To be called where all pixels have what the plan wants: draws the conclusions and goes to the
/// next stage.
void finish_round(RenderState& state);

}  // namespace covtrace
