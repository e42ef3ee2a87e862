// Light that reaches a diffuse floor over a mirror: found by the guide, and counted right.
#include <gtest/gtest.h>

#include "bsdf/fresnel.h"
#include "core/parallel.h"
#include "integrator/path.h"
#include "tests/render/fixtures.h"
#include "tests/statistical/chi_square.h"

namespace covtrace {
namespace {

using namespace test;

constexpr float kLampRadius = 0.05f, kLampRadiance = 500;

// The scene: a lamp at (0, 1, 0) over a floor that the camera sees near the origin, a mirror at x =
// 1. It is an instance, so that light is not sampled by it (flat_mirrors.h).
const std::string kMirrorScene = R"(
Integrator "path" "integer maxdepth" 4
Film "rgb" "integer xresolution" 48 "integer yresolution" 48
PixelFilter "box"
LookAt 0 3 -3  0 0 0  0 1 0
Camera "perspective" "float fov" 0.5
WorldBegin
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 500 500 500 ]
Translate 0 1 0
Shape "sphere" "float radius" 0.05
AttributeEnd
Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ]
  "point3 P" [ -1 0 -1  -1 0 1  1 0 1  1 0 -1 ]
Material "conductor" "rgb reflectance" [ 0.9 0.9 0.9 ] "float roughness" 0
ObjectBegin "mirror"
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ]
  "point3 P" [ 1 0 -1  1 0 1  1 2 1  1 2 -1 ]
ObjectEnd
ObjectInstance "mirror"
)";

/// Irradiance of the floor at the origin: a sphere of radius r at distance d gives pi L (r / d)^2
/// cos(theta), its image in the mirror (at (2, 1, 0)) the part that Fresnel leaves of that.
double floor_radiance() {
    const double source = kPi * kLampRadiance * kLampRadius * kLampRadius;
    const double direct = source;
    // The mirror is met at an angle whose cosine is 2 / sqrt(5).
    const float k = 2 * std::sqrt(0.9f / 0.1f);
    const double reflected = fresnel_conductor(2 / std::sqrt(5.0f), Rgb(1), Rgb(k)).g;
    const double image = source / 5 * (1 / std::sqrt(5.0)) * reflected;
    return 0.5 / kPi * (direct + image);
}

// The bound is 4.5 standard errors: false alarm 7e-6.
TEST(CausticGuide, LightOverAMirrorSumsToTheImageOfTheLamp) {
    const Summary s = summarize_image(render_text(kMirrorScene, uniform(64)).image);
    EXPECT_NEAR(s.mean, floor_radiance(), 4.5 * s.standard_error + 2e-3 * floor_radiance());
    // The standard error is small only because the guide aims at the image: the part that it finds
    // is 7 % of the whole.
    EXPECT_LT(s.standard_error, 4e-3 * floor_radiance());  // without the guide above 9e-3
}

/// Mean and second moment of paths from the camera to the middle of its image.
std::pair<double, double> moments(const RenderScene& scene, int paths = 60000) {
    double sum = 0, squares = 0;
    for (int i = 0; i < paths; ++i) {
        Sampler sampler(3, i, 0, 0);
        const Ray ray = scene.camera.generate_ray({24, 24}, {}, 0);
        const double l = trace_path(scene, ray, sampler, 4, nullptr).radiance.g;
        sum += l;
        squares += l * l;
    }
    return {sum / paths, squares / paths};
}

TEST(CausticGuide, FindsWhatTheFloorAloneFindsByChance) {
    const auto variance = [](const RenderScene& scene) {
        const auto [mean, square] = moments(scene);
        return square - mean * mean;
    };
    RenderScene scene(read_pbrt_string(kMirrorScene, "test", "."));
    scene.path_guide = PathGuide();  // it leads to the mirror, too
    const double guided = variance(scene);
    scene.guide = CausticGuide();
    EXPECT_GT(variance(scene), 20 * guided);
}

// The camera sees a spot of the floor, so that the trial measures what its middle has. It knows the
// brightness there from few paths for each block of the image, with what they found, and so tells
// too little of the noise without the guide, whose measure here has a standard error of 9 %.
TEST(CausticGuide, TellsWhatItLeavesOfTheNoise) {
    RenderScene scene(read_pbrt_string(kMirrorScene, "test", "."));
    const GuideOutcome outcome = scene.guide_outcomes().at("caustics");
    ASSERT_EQ(outcome.state, GuideState::guides);
    EXPECT_GT(outcome.bytes, 0u);
    scene.path_guide = PathGuide();
    const double guided = moments(scene).second;
    scene.guide = CausticGuide();
    const double left = guided / moments(scene, 600000).second;
    EXPECT_GT(outcome.second_moment, 0.7 * left);
    EXPECT_LT(outcome.second_moment, 3 * left);
}

// A lamp so large that paths meet its image often, under a sky: what the guide takes from other
// light would cost more than it saves.
TEST(CausticGuide, GivesUpWherePathsMeetTheLightAnyway) {
    std::string text = kMirrorScene;
    const auto replace = [&text](const std::string& what, const std::string& with) {
        ASSERT_NE(text.find(what), std::string::npos);
        text.replace(text.find(what), what.size(), with);
    };
    replace("500 500 500", "5 5 5");
    replace("\"float radius\" 0.05", "\"float radius\" 0.5");
    replace("\"float fov\" 0.5", "\"float fov\" 40");
    replace("WorldBegin", "WorldBegin\nLightSource \"infinite\" \"rgb L\" [ 0.3 0.3 0.3 ]");
    const RenderScene scene(read_pbrt_string(text, "test", "."));
    const GuideOutcome outcome = scene.guide_outcomes().at("caustics");
    EXPECT_EQ(outcome.state, GuideState::gave_up);
    EXPECT_GT(outcome.second_moment, 0.78);
    EXPECT_EQ(outcome.bytes, 0u);
    EXPECT_EQ(scene.guide.at({0.1f, 0, 0.1f}, {0, 1, 0}).share(), 0);
}

// Each of 400 balls shows the lamp to all of the floor.
TEST(CausticGuide, LooksAtFewOfManyImages) {
    std::string text = kMirrorScene +
                       "ObjectBegin \"ball\" Shape \"sphere\" \"float radius\" 0.02 "
                       "ObjectEnd\n";
    for (int i = 0; i < 400; ++i)
        text += "AttributeBegin Translate " + std::to_string(0.06f * float(i % 20) - 0.6f) +
                " 0.1 " + std::to_string(0.06f * float(i / 20) - 0.6f) +
                " ObjectInstance \"ball\" AttributeEnd\n";
    text.replace(text.find("\"float fov\" 0.5"), 15, "\"float fov\" 30");
    const RenderScene scene(read_pbrt_string(text, "test", "."));
    const size_t most_probed = scene.guide_outcomes().at("caustics").most_probed;
    EXPECT_GT(most_probed, 32u);
    EXPECT_LE(most_probed, 128u);
}

TEST(CausticGuide, PointsAtTheImageAndIsADensity) {
    const RenderScene scene(read_pbrt_string(kMirrorScene, "test", "."));
    const Vec3 p{0.1f, 0, 0.1f}, up{0, 1, 0};
    const GuideMixture guide = scene.guide.at(p, up);
    ASSERT_GT(guide.share(), 0.01f);
    const Vec3 towards = normalize(Vec3{2, 1, 0} - p);
    EXPECT_GT(guide.pdf(towards), 50);  // a uniform density were 1 / (2 pi)

    // Compare by chi-square over cells of angle from the image's direction and azimuth, alpha 1e-4
    constexpr int kRings = 24, kSectors = 8, kSamples = 200000;
    constexpr float kReach = 0.2f;  // radians
    const Frame frame = Frame::from_z(towards);
    const auto cell = [&](Vec3 w) {
        const Vec3 l = frame.to_local(w);
        const float angle = std::atan2(std::hypot(l.x, l.y), l.z);
        if (angle >= kReach) return kRings * kSectors;
        const float turn = (std::atan2(l.y, l.x) + kPi) / (2 * kPi);
        return int(angle / kReach * kRings) * kSectors +
               std::min(int(turn * kSectors), kSectors - 1);
    };
    std::vector<double> observed(kRings * kSectors + 1), expected(kRings * kSectors + 1);
    for (int i = 0; i < kSamples; ++i) {
        Sampler s(5, i, 0, 0);
        const float u = s.next_1d();
        ++observed[size_t(cell(guide.sample(u, s.next_2d())))];
    }
    double inside = 0;
    for (int r = 0; r < kRings; ++r)
        for (int t = 0; t < kSectors; ++t) {
            double sum = 0;
            constexpr int kSteps = 16;
            for (int i = 0; i < kSteps; ++i)
                for (int j = 0; j < kSteps; ++j) {
                    const float angle = kReach * (float(r) + (float(i) + 0.5f) / kSteps) / kRings;
                    const float turn = (float(t) + (float(j) + 0.5f) / kSteps) / kSectors;
                    const float phi = 2 * kPi * turn - kPi;
                    const Vec3 w =
                        frame.to_world({std::sin(angle) * std::cos(phi),
                                        std::sin(angle) * std::sin(phi), std::cos(angle)});
                    sum += guide.pdf(w) * std::sin(angle);
                }
            const double area = kReach / kRings / kSteps * 2 * kPi / kSectors / kSteps;
            expected[size_t(r * kSectors + t)] = sum * area * kSamples;
            inside += sum * area;
        }
    expected.back() = std::max(0.0, 1 - inside) * kSamples;
    EXPECT_GT(inside, 0.9);
    EXPECT_LT(inside, 1 + 1e-3);
    EXPECT_GT(chi_square_test(observed, expected).p, 1e-4);
}

// The lamp's image is seen at (2, 1, 0) from everywhere, so each photon has come its distance from
// there, whatever interfaces between media the light passed through after the mirror.
TEST(CausticGuide, PhotonsCountTheWayThroughInterfaces) {
    std::string with_media = kMirrorScene;  // the integrator "path" leaves media out
    with_media.replace(with_media.find("\"path\""), 6, "\"volpath\"");
    const RenderScene scene(read_pbrt_string(with_media + R"(
MakeNamedMedium "air" "string type" "homogeneous" "rgb sigma_a" [ 0 0 0 ]
  "rgb sigma_s" [ 1e-6 1e-6 1e-6 ]
MediumInterface "air" ""
Material "interface"
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ]
  "point3 P" [ -1 0.3 -1  -1 0.3 1  0.95 0.3 1  0.95 0.3 -1 ]
)",
                                             "test", "."));
    ASSERT_TRUE(scene.has_interfaces);
    const auto photons = trace_caustic_photons(scene, 0, 4096);
    int through = 0;  // photons that came over a point of the mirror above the interface
    for (const CausticPhoton& photon : photons) {
        const Vec3 met =
            photon.position + photon.direction * ((1 - photon.position.x) / photon.direction.x);
        if (met.y > 0.3f && photon.position.x < 0.9f) ++through;
        EXPECT_NEAR(photon.distance, length(Vec3{2, 1, 0} - photon.position), 1.01f * kLampRadius);
    }
    EXPECT_GT(through, 20);
}

// A small lamp over a ball of glass above a floor, seen from the side.
const std::string kGlassScene = R"(
Integrator "path" "integer maxdepth" 6
Film "rgb" "integer xresolution" 48 "integer yresolution" 32
PixelFilter "box"
LookAt 0 1 6  0 0 0  0 1 0
Camera "perspective" "float fov" 40
WorldBegin
LightSource "infinite" "rgb L" [ 0.02 0.02 0.02 ]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 500 500 500 ]
Translate 0 4 0
Shape "sphere" "float radius" 0.08
AttributeEnd
AttributeBegin
Material "dielectric"
Translate 0 0.2 0
Shape "sphere" "float radius" 0.5
AttributeEnd
Material "diffuse" "rgb reflectance" [ 0.6 0.6 0.6 ]
Shape "bilinearmesh" "point3 P" [ -4 -1 -4  4 -1 -4  -4 -1 4  4 -1 4 ]
)";

/// The point of the floor, in x, that a ray from the lamp's centre reaches through the ball, which
/// it meets at the height `b` over the axis, by Snell's law; the second is the direction from there
/// to where the ray left the ball.
std::pair<Vec3, Vec3> through_the_ball(double b) {
    const double lamp = 3.8, radius = 0.5, eta = 1.5;  // distance of the centres
    // The angles at the centre between axis and the point met, and of the ray with the axis
    const double met = std::asin(b / radius), slope = std::atan2(b, lamp - radius * std::cos(met));
    const double in = met + slope, inside = std::asin(std::sin(in) / eta);
    // Within the ball the radius turns by pi - 2 inside; outwards the ray bends as much as inwards.
    const double left = met + kPi - 2 * inside, bent = slope - 2 * (in - inside);
    const double x = radius * std::sin(left), y = 0.2 + radius * std::cos(left);
    const double w = std::tan(bent);  // x per unit of height that the ray loses
    const Vec3 floor{float(x + w * (y + 1)), -1, 0};
    return {floor, normalize(Vec3{float(x), float(y), 0} - floor)};
}

// Light through the ball meets on a line, not in a point; the guide knows for each place from where
// on the ball light comes, also where it passed sides that the camera does not see.
TEST(CausticGuide, PointsAtTheLampThroughGlass) {
    const RenderScene scene(read_pbrt_string(kGlassScene, "test", "."));
    for (const double b : {-0.3, -0.2, -0.1, 0.1, 0.2, 0.3}) {
        const auto [place, towards] = through_the_ball(b);
        ASSERT_LT(std::abs(place.x), 0.6f);
        const GuideMixture guide = scene.guide.at(place, {0, 1, 0});
        EXPECT_GT(guide.share(), 0.2f) << b;
        EXPECT_GT(guide.pdf(towards), 3) << b;  // of sampling the cosine: at most 1 / pi
    }
}

// The bound is 4.5 standard errors of the floor that no guide helped, the larger: false alarm 7e-6.
TEST(CausticGuide, LightThroughGlassIsFoundAndCountedRight) {
    const auto moments = [](const RenderScene& scene, int paths) {
        double sum = 0, squares = 0;
        for (int i = 0; i < paths; ++i) {
            Sampler sampler(3, i, 0, 0);
            const Ray ray{{0.05f, -0.5f, 0}, {0, -1, 0}, 0, kInfinity};
            const double l = trace_path(scene, ray, sampler, 5, nullptr).radiance.g;
            sum += l;
            squares += l * l;
        }
        const double mean = sum / paths;
        return std::pair{mean, squares / paths - mean * mean};
    };
    RenderScene scene(read_pbrt_string(kGlassScene, "test", "."));
    const auto [guided, variance] = moments(scene, 60000);
    scene.guide = CausticGuide();
    constexpr int kPlain = 600000;
    const auto [plain, plain_variance] = moments(scene, kPlain);
    EXPECT_NEAR(guided, plain, 4.5 * std::sqrt(plain_variance / kPlain + variance / 60000));
    EXPECT_GT(plain_variance, 5 * variance);
}

// The same guide and the same outcome for any number of threads.
TEST(CausticGuide, DoesNotDependOnThreads) {
    std::vector<float> found[2];
    for (int threads : {1, 3}) {
        const ThreadLimit limit(threads);
        const RenderScene scene(read_pbrt_string(kGlassScene, "test", "."));
        std::vector<float>& numbers = found[threads == 1 ? 0 : 1];
        numbers.push_back(float(scene.guide_outcomes().at("caustics").second_moment));
        for (int i = -20; i <= 20; ++i) {
            const GuideMixture guide = scene.guide.at({0.03f * float(i), -1, 0.1f}, {0, 1, 0});
            numbers.push_back(guide.share());
            numbers.push_back(guide.share() > 0 ? guide.pdf({0, 1, 0}) : 0);
        }
    }
    EXPECT_GT(found[0][0], 0);
    EXPECT_EQ(found[0], found[1]);
}

TEST(CausticGuide, IsEmptyWithoutMirrors) {
    const RenderScene scene(read_pbrt_string(R"(
Film "rgb" "integer xresolution" 16 "integer yresolution" 16
WorldBegin
LightSource "infinite"
Shape "sphere")",
                                             "test", "."));
    EXPECT_EQ(scene.guide.at({0, 1, 0}, {0, 1, 0}).share(), 0);
}

}  // namespace
}  // namespace covtrace
