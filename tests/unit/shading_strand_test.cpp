#include "shading/strand.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/frame.h"
#include "core/rng.h"
#include "core/warp.h"

namespace covtrace {
namespace {

/// A tube about x of so many sides, and a ray that meets it.
struct Tube {
    int sides;
    float turn;
    bool is_mirrored;  ///< v runs the other way about

    Vec3 corner(int k) const {
        const float a = turn + 2 * kPi * static_cast<float>(k) / static_cast<float>(sides);
        return {0, std::cos(a), std::sin(a)};
    }
    /// Meets the line through `from` along `d`, both in the cross section, from outside.
    std::optional<SurfaceHit> meet(Vec3 from, Vec3 d) const {
        for (int k = 0; k < sides; ++k) {
            const Vec3 a = corner(k), edge = corner(k + 1) - a;
            const Vec3 normal = normalize(cross(edge, {1, 0, 0}));
            if (dot(normal, d) >= 0) continue;
            const Vec3 at = from + d * (dot(a - from, normal) / dot(d, normal));
            const float along = dot(at - a, edge) / length_squared(edge);
            if (along < 0 || along > 1) continue;
            const float v = (static_cast<float>(k) + along) / static_cast<float>(sides);
            SurfaceHit hit;
            hit.position = at;
            hit.ng = hit.ns = normal;
            hit.dpdu = {3, 0, 0};
            hit.uv = {0.4f, is_mirrored ? 1 - v : v};
            hit.dpdv = edge * (is_mirrored ? -1.0f : 1.0f);
            return hit;
        }
        return std::nullopt;
    }
};

TEST(Strand, PlacesAcrossAreThoseOfTheRayWhateverTheSides) {
    Rng rng(4);
    int met = 0;
    for (int i = 0; i < 2000; ++i) {
        const Tube tube{std::array{3, 5, 6, 24}[size_t(i % 4)], 2 * kPi * rng.next_float(),
                        rng.next_float() < 0.5f};
        // Look along a direction that leans to the strand
        const Vec3 wo = square_to_sphere(rng.next_2d());
        const Vec3 flat = normalize(Vec3{0, wo.y, wo.z}), across = cross(flat, {1, 0, 0});
        float first = kInfinity, last = -kInfinity;
        for (int k = 0; k < tube.sides; ++k) {
            first = std::min(first, dot(tube.corner(k), across));
            last = std::max(last, dot(tube.corner(k), across));
        }
        const float share = rng.next_float();
        const auto hit = tube.meet(flat * 5 + across * std::lerp(first, last, share), -flat);
        if (!hit) continue;
        ++met;
        EXPECT_NEAR(place_across(*hit, tube.sides, wo), 2 * share - 1, 2e-4f) << tube.sides;
    }
    EXPECT_GT(met, 1950);
}

TEST(Strand, OnlyHairOnTubesIsPlaced) {
    SurfaceHit hit;
    hit.ng = {0, 0, 1};
    hit.dpdu = {1, 0, 0};
    hit.dpdv = {0, -1, 0};
    hit.uv = {0, 0.5f / 6};
    const Vec3 wo = normalize(Vec3{0.3f, -0.5f, 1});
    Bsdf hair = HairBsdf{}, other = DiffuseBsdf{Rgb(0.5f)};
    std::get<HairBsdf>(hair).offset = 0.25f;
    place_on_strand(hair, hit, 0, wo);
    EXPECT_EQ(std::get<HairBsdf>(hair).offset, 0.25f);
    place_on_strand(hair, hit, 6, wo);
    EXPECT_EQ(std::get<HairBsdf>(hair).offset, place_across(hit, 6, wo));
    place_on_strand(other, hit, 6, wo);
    EXPECT_EQ(std::get<DiffuseBsdf>(other).reflectance, Rgb(0.5f));
}

}  // namespace
}  // namespace covtrace
