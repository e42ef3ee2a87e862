// Lenses whose surfaces are traced: focus, irradiance, vignetting, shapes of the aperture.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "camera/aperture_mask.h"
#include "camera/camera.h"
#include "camera/exit_pupil.h"
#include "camera/lens_system.h"
#include "core/rng.h"

namespace covtrace {
namespace {

constexpr float kMm = 1e-3f;

/// A pair of thick menisci, one the other's mirror image, around a stop; about 80 mm.
LensDescription periscopic() {
    LensDescription lens;
    lens.surfaces = {{30 * kMm, 6 * kMm, 1.6f, 12 * kMm},
                     {45 * kMm, 9 * kMm, 1, 11 * kMm},
                     {0, 9 * kMm, 1, 9 * kMm},
                     {-45 * kMm, 6 * kMm, 1.6f, 11 * kMm},
                     {-30 * kMm, 50 * kMm, 1, 12 * kMm}};
    lens.film_diagonal = 43 * kMm;
    return lens;
}

/// A lens that ends with its stop, so that the stop itself is the exit pupil.
LensDescription rear_stop() {
    LensDescription lens;
    lens.surfaces = {{60 * kMm, 5 * kMm, 1.5f, 40 * kMm},
                     {-60 * kMm, 8 * kMm, 1, 40 * kMm},
                     {0, 30 * kMm, 1, 10 * kMm}};
    return lens;
}

CameraDescription with_lens(const LensDescription& lens, float pupil, float focus) {
    CameraDescription d;
    d.lens = std::make_shared<const LensDescription>(lens);
    d.lens_radius = pupil;
    d.focal_distance = focus;
    d.film_irradiance = 0.5f;
    return d;
}

/// Mean weight of a camera's rays at a place of its film, and its standard error.
struct Mean {
    double value = 0, error = 0;
};
Mean mean_weight(const Camera& camera, Vec2 film, int count = 40000) {
    Rng rng(7);
    double sum = 0, squares = 0;
    for (int i = 0; i < count; ++i) {
        const double w = camera.generate_ray(film, rng.next_2d(), 0).weight;
        sum += w, squares += w * w;
    }
    const double mean = sum / count;
    return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean) / count)};
}

TEST(ParaxialLens, ThickSingletFollowsTheLensmakersEquation) {
    const float r1 = 40 * kMm, r2 = -60 * kMm, d = 12 * kMm, n = 1.5f;
    const std::vector<LensSurface> surfaces{{r1, d, n, 10 * kMm}, {r2, 0, 1, 10 * kMm}};
    const ParaxialLens lens = paraxial_lens(surfaces);
    const double power =
        (n - 1) * (1.0 / r1 - 1.0 / r2 + (n - 1.0) * d / (n * double(r1) * double(r2)));
    EXPECT_NEAR(lens.focal_length * power, 1, 1e-5);
    // Principal planes of a thick lens, from its vertices
    const double f = 1 / power;
    EXPECT_NEAR(lens.front_principal_plane, -f * (n - 1) * d / (n * double(r2)), 1e-6);
    EXPECT_NEAR(lens.rear_principal_plane, -f * (n - 1) * d / (n * double(r1)), 1e-6);
    EXPECT_EQ(lens.stop_per_pupil, 0);
    EXPECT_FALSE(lens.image_distance(lens.nearest_focus() * 0.999));
    const double s = *lens.image_distance(lens.nearest_focus() * 1.0001);
    EXPECT_NEAR(s / (2 * f), 1, 0.05) << "nearest at a magnification of 1";
}

TEST(LensSystem, RaysOfAPlaceInFocusMeet) {
    const float focus = 3;
    const LensSystem lens(periscopic(), 3 * kMm, focus, {});
    const float film = 1 * kMm;
    std::vector<Vec3> met;
    for (const float x : {-0.4f, 0.0f, 0.4f}) {
        const auto ray = lens.trace({film, 0}, {x * kMm, 0});
        ASSERT_TRUE(ray);
        EXPECT_NEAR(ray->origin.z, lens.front_z(), 1 * kMm);
        EXPECT_NEAR(length(ray->direction), 1, 1e-5f);
        const float t = (focus - ray->origin.z) / ray->direction.z;
        met.push_back(ray->origin + ray->direction * t);
    }
    const float magnification = met[1].x / -film;
    EXPECT_NEAR(magnification, (focus - 0.1f) / lens.image_distance(), 2);
    // The rays are 0.8 mm apart in the lens, and next to each other 3 m away
    for (const Vec3& p : met) EXPECT_NEAR(p.x, met[1].x, 0.1f * kMm) << "in front of the lens";
    // Out of focus they are apart by what the thin lens of the same image says
    const auto a = lens.trace({film, 0}, {-0.4f * kMm, 0}),
               b = lens.trace({film, 0}, {0.4f * kMm, 0});
    const auto place = [](const LensRay& r, float z) {
        return r.origin.x + r.direction.x * (z - r.origin.z) / r.direction.z;
    };
    EXPECT_NEAR(place(*a, 2 * focus) - place(*b, 2 * focus),
                -(place(*a, lens.front_z()) - place(*b, lens.front_z())), 0.1f * kMm);
}

TEST(LensSystem, FocusIsMeasuredFromTheFilm) {
    // Refocusing moves the lens, not the object: a nearer one needs a lens farther from the film
    const LensDescription lens = periscopic();
    const LensSystem far(lens, 1 * kMm, 100, {}), near(lens, 1 * kMm, 0.5f, {});
    EXPECT_GT(near.rear_z(), far.rear_z() + 5 * kMm);
    EXPECT_NEAR(near.front_z() - near.rear_z(), 30 * kMm, 1e-6f);
    EXPECT_THROW(LensSystem(lens, 1 * kMm, 0.2f, {}), Error);
}

TEST(TracedCamera, GivesTheIrradianceOfItsExitPupil) {
    // Exact for a disc seen from its axis: pi sin^2
    const LensDescription lens = rear_stop();
    const CameraDescription d = with_lens(lens, 9 * kMm, 2);
    const LensSystem system(lens, 9 * kMm, 2, {});
    const Camera camera(d, 100, 100);
    const Mean mean = mean_weight(camera, {50, 50});
    const double a = system.stop_radius(), z = system.rear_z();
    EXPECT_NEAR(mean.value * 0.5, kPi * a * a / (a * a + z * z), 5 * 0.5 * mean.error);
    EXPECT_LT(mean.error * std::sqrt(40000.0), 0.4 * mean.value) << "few rays are blocked";
    // Off the axis a small one falls with the fourth power of the cosine
    const Camera small(with_lens(lens, 1 * kMm, 2), 100, 100);
    const Mean middle = mean_weight(small, {50, 50}), corner = mean_weight(small, {0, 0});
    const double off = 17.5 * kMm, cos2 = z * z / (z * z + off * off);
    EXPECT_NEAR(corner.value / middle.value, cos2 * cos2,
                5 * (corner.error + middle.error) / middle.value + 2e-3);
}

TEST(TracedCamera, VignettesAsRaysThroughTheWholeRearElementDo) {
    // The reference samples a box that holds every pupil; 5 standard errors are passed by chance
    // once in 1.7 million
    LensDescription lens = periscopic();
    lens.surfaces.front().aperture_radius = lens.surfaces.back().aperture_radius = 8 * kMm;
    const CameraDescription d = with_lens(lens, 8 * kMm, 4);
    const LensSystem system(lens, 8 * kMm, 4, {});
    const Camera camera(d, 80, 60);
    double middle = 0;
    for (const Vec2 film : {Vec2{40, 30}, Vec2{20, 30}, Vec2{40, 3}, Vec2{1, 1}, Vec2{79, 2}}) {
        const Vec2 place{43 * kMm * (40 - film.x) / 100, 43 * kMm * (film.y - 30) / 100};
        const float box = 1.5f * system.rear_radius(), z = system.rear_z();
        Rng rng(11);
        constexpr int kCount = 200000;
        double sum = 0, squares = 0;
        for (int i = 0; i < kCount; ++i) {
            const Vec2 u = rng.next_2d();
            const Vec2 rear{box * (2 * u.x - 1), box * (2 * u.y - 1)};
            if (!system.trace(place, rear)) continue;
            const double cos2 = z * z / (z * z + double(dot(rear - place, rear - place)));
            const double w = cos2 * cos2 * 4 * box * box / (z * z);
            sum += w, squares += w * w;
        }
        const double mean = sum / kCount;
        const double error = std::sqrt((squares / kCount - mean * mean) / kCount);
        const Mean own = mean_weight(camera, film);
        EXPECT_NEAR(own.value * 0.5, mean, 5 * (error + 0.5 * own.error))
            << film.x << " " << film.y;
        if (film.x == 40 && film.y == 30) middle = mean;
        if (film.x == 1) EXPECT_LT(mean, 0.8 * middle) << "the corner is dark";
        // The bounds are near: few of the pupils' rays are blocked
        EXPECT_LT(own.error * std::sqrt(40000.0), 0.5 * own.value) << film.x << " " << film.y;
    }
}

TEST(TracedCamera, ShowsTheWorldUpright) {
    const Camera camera(with_lens(periscopic(), 4 * kMm, 4), 80, 60);
    EXPECT_LT(camera.generate_ray({5, 30}, {0.5f, 0.5f}, 0).direction.x, -0.1f);
    EXPECT_GT(camera.generate_ray({40, 3}, {0.5f, 0.5f}, 0).direction.y, 0.1f);
    EXPECT_GT(camera.generate_ray({40, 30}, {0.5f, 0.5f}, 0).direction.z, 0.99f);
    // The thin lens that stands for it sees the same picture
    const SensorGeometry g = camera.sensor({});
    const Vec3 a = camera.generate_ray({40, 30}, {0.5f, 0.5f}, 0).direction,
               b = camera.generate_ray({44, 30}, {0.5f, 0.5f}, 0).direction;
    EXPECT_NEAR((b.x / b.z - a.x / a.z) * g.pixels_per_x, 4, 0.1f);
    EXPECT_EQ(g.lens_radius, 4 * kMm);
    EXPECT_NEAR(g.focal_distance, 4 - LensSystem(periscopic(), 4 * kMm, 4, {}).front_z(), 1e-5f);
}

TEST(TracedCamera, SeesNothingBesideItsImageCircle) {
    LensDescription lens = periscopic();
    lens.film_diagonal = 400 * kMm;
    const Camera camera(with_lens(lens, 4 * kMm, 4), 80, 60);
    const CameraRay corner = camera.generate_ray({1, 1}, {0.5f, 0.5f}, 0);
    EXPECT_EQ(corner.weight, 0);
    EXPECT_FALSE(corner.sees);
    EXPECT_TRUE(camera.generate_ray({40, 30}, {0.5f, 0.5f}, 0).sees);
}

TEST(TracedCamera, RaysBesideAreNextToTheRay) {
    const Camera camera(with_lens(periscopic(), 8 * kMm, 4), 80, 60);
    const float pixel = camera.half_pixel(1) * 2;
    Rng rng(3);
    for (int i = 0; i < 2000; ++i) {
        const Vec2 film{80 * rng.next_float(), 60 * rng.next_float()}, lens = rng.next_2d();
        const CameraRay ray = camera.generate_ray(film, lens, 0);
        if (ray.weight == 0) continue;
        const auto [right, below] = camera.rays_beside(film, lens, 0);
        EXPECT_NEAR(
            (right.direction.x / right.direction.z - ray.direction.x / ray.direction.z) / pixel, 1,
            0.3f);
        EXPECT_NEAR(
            (below.direction.y / below.direction.z - ray.direction.y / ray.direction.z) / pixel, -1,
            0.3f);
    }
}

TEST(ApertureMask, LetsAsMuchLightThroughAsTheRoundOne) {
    using Kind = ApertureShape::Kind;
    for (const Kind kind :
         {Kind::round, Kind::gaussian, Kind::square, Kind::pentagon, Kind::star}) {
        const ApertureMask mask({kind, {}, {}});
        constexpr int kSteps = 512;
        double sum = 0;
        for (int i = 0; i < kSteps; ++i)
            for (int j = 0; j < kSteps; ++j) {
                const Vec2 p{(2 * float(i) + 1) / kSteps - 1, (2 * float(j) + 1) / kSteps - 1};
                sum += mask(p);
                if (length(p) > mask.reach()) EXPECT_EQ(mask(p), 0);
            }
        EXPECT_NEAR(sum / (kSteps * kSteps), kPi / 4, 2e-3) << int(kind);
        EXPECT_LE(mask.reach(), 1.03f);
    }
}

TEST(ApertureMask, HasPbrtsShapes) {
    using Kind = ApertureShape::Kind;
    const ApertureMask square({Kind::square, {}, {}});
    EXPECT_NEAR(square({0.45f, -0.45f}), kPi, 0.05f);  // a quarter of the box, pi / 4 of it open
    EXPECT_EQ(square({0.55f, 0}), 0);
    const ApertureMask pentagon({Kind::pentagon, {}, {}});
    EXPECT_GT(pentagon({0, -0.75f}), 0) << "its corner is on the stop's lower side";
    EXPECT_EQ(pentagon({0, 0.75f}), 0);
    const ApertureMask star({Kind::star, {}, {}});
    EXPECT_GT(star({-0.9f, 0}), 0);
    EXPECT_EQ(star({0.9f, 0}), 0);
    const ApertureMask gaussian({Kind::gaussian, {}, {}});
    EXPECT_NEAR(gaussian({0.5f, 0}) / gaussian({}),
                (std::exp(-0.25f) - std::exp(-1.0f)) / (1 - std::exp(-1.0f)), 1e-2f);
}

}  // namespace
}  // namespace covtrace
