#include "light/environment.h"

#include <cmath>
#include <vector>

#include "core/warp.h"
#include "light/delta.h"
#include "light/weight.h"

namespace covtrace {

namespace {

/// Cells per axis of a portal's table: as fine as the image, within limits.
constexpr int kLeastCells = 256, kMostCells = 1024;
/// Directions per axis and cell: with one, a cell that the edge of a sun crosses would now and then
/// be taken for dark, and its light found too seldom.
constexpr int kLeastTaps = 3;

/// A map of a gradient. Between its rows it is interpolated, so that few of them do.
EnvironmentMap map_of(const HeightGradient& gradient) {
    constexpr int kRows = 64;
    std::vector<Rgb> texels;
    for (int y = 0; y < kRows; ++y) {
        const float sine = std::cos((float(y) + 0.5f) * kPi / kRows);
        const float end = sine > 0 ? gradient.up : gradient.down;
        texels.insert(texels.end(), 2 * kRows, Rgb(std::lerp(gradient.level, end, std::abs(sine))));
    }
    return {texels, 2 * kRows, kRows};
}

/// Whether the linear part of t is a rotation or reflection, to single precision.
bool preserves_lengths(const Transform& t) {
    const Vec3 x = t.vector({1, 0, 0}), y = t.vector({0, 1, 0}), z = t.vector({0, 0, 1});
    const auto is = [](float value, float expected) { return std::abs(value - expected) < 1e-5f; };
    return is(dot(x, x), 1) && is(dot(y, y), 1) && is(dot(z, z), 1) && is(dot(x, y), 0) &&
           is(dot(y, z), 0) && is(dot(z, x), 0);
}

}  // namespace

Environment::Environment(const InfiniteLight& light, const Transform& light_to_world,
                         const SourceLocation& where, Warnings& warnings)
    : light_to_world_(light_to_world),
      to_world_(linear(light_to_world)),
      to_light_(linear(light_to_world.inverse())),
      is_rigid_(preserves_lengths(light_to_world)),
      scale_(light.radiance) {
    determinant_ = std::abs(dot(cross(to_light_.x, to_light_.y), to_light_.z));
    if (light.image)
        map_ = EnvironmentMap::read(*light.image, where, warnings);
    else if (light.gradient)
        map_ = map_of(*light.gradient);
    if (light.illuminance) {
        const Rgb measured = scale_ * (map_ ? map_->irradiance_from_above() : Rgb(kPi));
        scale_ *= normalisation(*light.illuminance, luminance(measured));
    }
    if (light.portal) {
        const int rows = map_ ? map_->height() : 1;
        const int cells = std::clamp(rows, kLeastCells, kMostCells);
        portal_.emplace(
            *light.portal, [this](Vec3 w) { return sky(w); }, cells,
            std::max(kLeastTaps, (rows + cells - 1) / cells + 1), where);
    }
}

Environment::Environment(const DistantLight& light, const Transform& light_to_world)
    : light_to_world_(light_to_world),
      to_world_(linear(light_to_world)),
      to_light_(linear(light_to_world.inverse())),
      disc_(std::in_place, light, make_distant_emitter(light, light_to_world).direction) {}

Environment::Linear Environment::linear(const Transform& t) {
    return {t.vector({1, 0, 0}), t.vector({0, 1, 0}), t.vector({0, 0, 1})};
}

Vec3 Environment::direction(Vec3 p, Vec3 n, const EnvironmentMap::Draw& draw) const {
    if (portal_) {
        const auto view = portal_->view(p);
        return view ? portal_->sample(*view, draw.u) : Vec3{0, 0, 1};
    }
    if (disc_) return disc_->sample(draw.u);
    if (map_) return normalize(to_world_(map_->direction(draw)));
    if (n == Vec3{}) return square_to_sphere(draw.u);
    return normalize(Frame::from_z(n).to_world(square_to_cosine_hemisphere(draw.u)));
}

EnvironmentMap::Sight Environment::look(Vec3 p, Vec3 n, Vec3 w) const {
    if (!portal_) return look_at_sky(n, w);
    if (!portal_->is_open(p, w)) return {};
    const auto view = portal_->view(p);
    return {sky(w), view ? portal_->pdf(*view, w) : 0.0f};
}

EnvironmentMap::Sight Environment::look_at_sky(Vec3 n, Vec3 w) const {
    if (disc_) return disc_->look(w);
    if (!map_) return {scale_, n == Vec3{} ? kUniformSpherePdf : cosine_hemisphere_pdf(dot(n, w))};
    Vec3 local = to_light_(w);
    float stretch = 1;
    if (!is_rigid_) {
        // A linear map A stretches solid angles by |det A| / |A w|^3.
        const float l = length(local);
        local = local / l;
        stretch = determinant_ / (l * l * l);
    }
    EnvironmentMap::Sight sight = map_->look(local);
    sight.radiance *= scale_;
    sight.pdf *= stretch;
    return sight;
}

float Environment::irradiance(Vec3 p, Vec3 n) const {
    if (disc_) return disc_->choice_weight_at(n);
    if (portal_) {
        const auto view = portal_->view(p);
        return view ? static_cast<float>(view->light) : 0.0f;
    }
    return map_ ? kPi * choice_weight(scale_ * map_->mean()) * map_->drawn_share()
                : kPi * choice_weight(scale_);
}

Rgb Environment::power(float radius) const {
    if (portal_) return portal_->area() * portal_->fluence();
    if (disc_) return kPi * sqr(radius) * disc_->irradiance();
    return 4 * sqr(kPi * radius) * (map_ ? scale_ * map_->mean() : scale_);
}

}  // namespace covtrace
