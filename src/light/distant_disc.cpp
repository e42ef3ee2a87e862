#include "light/distant_disc.h"

#include <cmath>

#include "core/warp.h"
#include "light/weight.h"

namespace covtrace {

DistantDisc::DistantDisc(const DistantLight& light, Vec3 centre)
    : frame_(Frame::from_z(centre)), irradiance_(light.radiance) {
    const double radius = 0.5 * double(light.angle) * (M_PI / 180), sine = std::sin(radius);
    const double chord = 2 * std::sin(0.5 * radius);
    radius_ = static_cast<float>(radius);
    sine_ = static_cast<float>(sine);
    chord_squared_ = static_cast<float>(chord * chord);
    pdf_ = static_cast<float>(1 / (M_PI * chord * chord));
    // The integral of the cosine over the disc is pi sin^2
    radiance_ = static_cast<float>(1 / (M_PI * sine * sine)) * irradiance_;
}

Vec3 DistantDisc::sample(Vec2 u) const {
    // Lambert's azimuthal projection keeps areas: it takes a plane disc, whose radius is the
    // largest chord, to the cap
    const Vec2 d = square_to_disc(u);
    const float square = (d.x * d.x + d.y * d.y) * chord_squared_;
    const float scale = std::sqrt(chord_squared_ * (1 - 0.25f * square));
    return normalize(frame_.to_world({d.x * scale, d.y * scale, 1 - 0.5f * square}));
}

float DistantDisc::choice_weight_at(Vec3 n) const {
    const float facing = choice_weight(irradiance_);
    if (n == Vec3{}) return facing;
    // A wide disc lights surfaces that it stands beside of, too
    return facing * std::max(side_weight(dot(frame_.z, n)), 0.25f * sine_);
}

}  // namespace covtrace
