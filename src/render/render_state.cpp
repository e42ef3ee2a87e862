#include "render/render_state.h"

#include <algorithm>
#include <cmath>

#include "render/overrides.h"
#include "render/version.h"

namespace covtrace {

namespace {

std::vector<float> flat(const Matrix4& m) {
    // OpenEXR's convention is row vectors times matrix: the values go column by column.
    std::vector<float> v;
    for (size_t c = 0; c < 4; ++c)
        for (size_t r = 0; r < 4; ++r) v.push_back(static_cast<float>(m.m[r][c]));
    return v;
}

/// Metadata that any image of the render has: version, options and camera.
Metadata scene_metadata(const RenderScene& scene, const RenderOptions& options) {
    Metadata m;
    m["covtrace:version"] = std::string(kVersion);
    m["covtrace:commit"] = std::string(kCommit);
    m["covtrace:seed"] = std::to_string(options.seed);
    m["covtrace:method"] = std::string(name_of(options.method));
    m["covtrace:isa"] = scene.geometry.isa();
    m["covtrace:sceneHash"] = scene_hash(scene);
    m["worldToCamera"] = flat(scene.camera.world_to_camera());
    m["worldToNDC"] = flat(scene.camera.world_to_ndc());
    return m;
}

/// Number of covariance paths per pixel.
double covariance_paths(const RenderOptions& options, std::optional<double> spp) {
    // Further paths change nothing for `hybrid` (docs/decisions/0040) and narrow the filters of
    // `covariance` without need (docs/decisions/0045).
    constexpr double kHybrid = 1, kCovariance = 2;
    if (options.method == Method::uniform) return 0;
    double paths = options.method == Method::covariance ? kCovariance : kHybrid;
    paths = options.cov_spp.value_or(paths);
    if (options.max_spp) paths = std::min(paths, double(*options.max_spp));
    return spp ? std::min(paths, *spp) : paths;
}

/// Calls visit(film pixel index) for all pixels of tiles that belong, or don't belong, to the
/// shard.
template <typename Visit>
void for_each_pixel(const PixelBounds& region, const Shard& shard, bool belonging,
                    const Visit& visit) {
    const Tiles tiles(region);
    for (int64_t tile = 0; tile < tiles.count(); ++tile) {
        if (tiles.belongs_to(tile, shard) != belonging) continue;
        const PixelBounds b = tiles.bounds(tile);
        for (int y = b.y0; y < b.y1; ++y)
            for (int x = b.x0; x < b.x1; ++x)
                visit(size_t(y - region.y0) * size_t(region.width()) + size_t(x - region.x0));
    }
}

template <typename T>
void clear_at(std::vector<T>& values, size_t i) {
    if (!values.empty()) values[i] = T{};
}

}  // namespace

FilmParts film_parts(Method method) {
    return {.in_view = method == Method::covariance, .features = method == Method::hybrid};
}

RenderState::RenderState(const RenderScene& scene, const RenderOptions& options)
    : identity(render_identity(scene, options)),
      method(options.method),
      filter(options.filter),
      region(render_region(scene.description.film)),
      display{0, 0, scene.description.film.width, scene.description.film.height},
      has_holes(scene.has_holes),
      metadata(scene_metadata(scene, options)),
      stage(method == Method::uniform ? Stage::rounds : Stage::first_paths),
      spp(target_spp(scene.description, options)) {
    covariance_spp = covariance_paths(options, spp);
    FilmParts kept = film_parts(method);
    if (method == Method::uniform) kept = {options.emitters_apart, options.features};
    kept.surfaces =
        kept_surfaces(scene.description.film, options) != FilmDescription::Surfaces::none;
    kept.opacity = scene.tells_opacity;
    for (int k = 0; k < (method == Method::hybrid ? 2 : 1); ++k) films.emplace_back(region, kept);
    if (method != Method::uniform) covariances = CovarianceBuffers(region.width(), region.height());
}

bool RenderState::has(size_t k, std::span<const uint32_t> counts, const Shard& shard) const {
    bool all_of_them = true;
    for_each_pixel(region, shard, true,
                   [&](size_t i) { all_of_them &= films[k].pixels[i].count >= counts[i]; });
    return all_of_them;
}

bool RenderState::reached(const Shard& shard) const {
    for (size_t k = 0; k < plan.size(); ++k)
        if (!has(k, plan[k], shard)) return false;
    return true;
}

double RenderState::mean_count() const {
    double sum = 0;
    for (const Film& film : films) sum += film.mean_count();
    return sum;
}

std::map<std::string, size_t> RenderState::memory() const {
    std::map<std::string, size_t> bytes;
    for (const Film& film : films) bytes["film"] += film.memory();
    for (const auto& counts : plan) bytes["plan"] += counts.size() * sizeof(uint32_t);
    bytes["plan"] += density.size() * sizeof(float);
    if (const auto* parts = std::get_if<CovarianceBuffers>(&covariances))
        bytes["prediction"] = parts->memory();
    else if (const auto* all = std::get_if<std::vector<PackedCovariance>>(&covariances))
        bytes["prediction"] = all->size() * sizeof(PackedCovariance);
    return bytes;
}

CovarianceBuffer RenderState::covariance() const {
    const auto* parts = std::get_if<CovarianceBuffers>(&covariances);
    // As it is once it is packed: a budget of time asks within the pilot already, and changes no
    // image.
    if (parts && method == Method::hybrid)
        return unpack(packed_merge(*parts), region.width(), region.height());
    if (parts) return merge(*parts);
    return unpack(std::get<std::vector<PackedCovariance>>(covariances), region.width(),
                  region.height());
}

void RenderState::keep_only(const Shard& shard) {
    for_each_pixel(region, shard, false, [&](size_t i) {
        for (Film& film : films) {
            clear_at(film.pixels, i);
            clear_at(film.in_view, i);
            clear_at(film.features, i);
            clear_at(film.feature_squares, i);
            clear_at(film.rays, i);
            clear_at(film.surfaces, i);
            clear_at(film.opacity, i);
        }
        for (auto& counts : plan) clear_at(counts, i);
        if (auto* parts = std::get_if<CovarianceBuffers>(&covariances)) {
            clear_at(parts->scattered, i);
            clear_at(parts->in_view, i);
        } else if (auto* all = std::get_if<std::vector<PackedCovariance>>(&covariances)) {
            clear_at(*all, i);
        }
        clear_at(density, i);
    });
}

void finish_round(RenderState& state) {
    if (state.stage == Stage::first_paths) {
        state.weight_limit = limit_weights(state.films[0], state.parts());
        state.stage = Stage::pilot;
    } else if (state.stage == Stage::pilot) {
        if (state.method == Method::hybrid) {
            state.covariances = packed_merge(state.parts());
        }
        state.stage = Stage::rounds;
    }
    state.taken = state.target;
    state.plan.clear();
}

}  // namespace covtrace
