// Paths side by side: each is the path that it is on its own, whichever others are with it.
#include "integrator/path_batch.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/render/fixtures.h"

namespace covtrace {
namespace {

using namespace test;

/// Glass, a mirror, fog behind an interface, a leaf with alpha, a body that scatters light inside,
/// a lamp; `balls` are shapes that Embree does not know, `moving` makes one of them move.
std::string scene_text(bool balls, bool moving) {
    std::string text = R"(
LookAt 0 1 -6  0 0.5 0  0 1 0
Camera "perspective" "float fov" 40
WorldBegin
LightSource "infinite" "rgb L" [ 0.2 0.25 0.3 ]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 8 8 8 ]
Shape "trianglemesh" "point3 P" [ -1 4 -1  1 4 -1  1 4 1  -1 4 1 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd
Shape "trianglemesh" "point3 P" [ -5 0 -5  5 0 -5  5 0 5  -5 0 5 ] "integer indices" [ 0 2 1 0 3 2 ]
AttributeBegin
Material "conductor" "float roughness" 0
Shape "trianglemesh" "point3 P" [ -5 0 4  5 0 4  5 5 4  -5 5 4 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd
Texture "leaf" "float" "constant" "float value" 0.5
AttributeBegin
Shape "trianglemesh" "point3 P" [ -2 0 1  0 0 1  -1 2 1 ] "integer indices" [ 0 1 2 ] "texture alpha" "leaf"
AttributeEnd
MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [ 0.1 0.2 0.3 ] "rgb sigma_s" [ 0.8 0.6 0.4 ]
AttributeBegin
MediumInterface "fog" ""
Material "interface"
Shape "trianglemesh" "point3 P" [ 0 0 0  2 0 0  1 0 2  1 2 1 ] "integer indices" [ 0 1 2  0 3 1  1 3 2  2 3 0 ]
AttributeEnd
AttributeBegin
Translate 0.3 0.1 -2
Scale 0.5 0.5 0.5
Material "subsurface" "rgb reflectance" [ 0.8 0.6 0.4 ] "rgb mfp" [ 0.3 0.2 0.1 ]
Shape "trianglemesh" "point3 P" [ 0 0 0  2 0 0  1 0 2  1 2 1 ] "integer indices" [ 0 1 2  0 3 1  1 3 2  2 3 0 ]
AttributeEnd
)";
    if (balls)
        text += R"(
AttributeBegin
Translate -1.5 1 -1
Material "dielectric"
Shape "sphere" "float radius" 0.7
AttributeEnd
)";
    if (moving)
        text += R"(
AttributeBegin
ActiveTransform EndTime
Translate 0.5 0 0
ActiveTransform All
Translate 1.5 2 -1
Shape "sphere" "float radius" 0.4
AttributeEnd
)";
    return text;
}

bool same_bits(const PathResult& a, const PathResult& b) {
    const auto same = [](const auto& x, const auto& y) {
        return std::memcmp(&x, &y, sizeof(x)) == 0;
    };
    return same(a.radiance, b.radiance) && same(a.in_view, b.in_view) && same(a.albedo, b.albedo) &&
           same(a.normal, b.normal) && same(a.depth, b.depth) && a.hit == b.hit &&
           same(a.features, b.features) && same(a.rays, b.rays) && a.vertices == b.vertices;
}

struct Start {
    Ray ray;
    Sampler sampler;
};

Start start(const RenderScene& scene, int i) {
    const int x = i * 37 % 64, y = i * 11 % 48;
    Sampler sampler(5, x, y, uint32_t(i));
    const Sampler::CameraSample u = sampler.camera();
    const Vec2 film{(float(x) + u.film.x) * 20, (float(y) + u.film.y) * 15};
    return {scene.camera.generate_ray(film, u.lens, u.time), sampler};
}

const auto kNever = [] { return false; };

TEST(PathBatch, MakesOfEachPathWhatItIsAlone) {
    constexpr int kPaths = 3000, kDepth = 12;
    for (const auto& [balls, moving] : {std::pair{false, false}, {true, false}, {true, true}}) {
        const RenderScene scene(read_pbrt_string(scene_text(balls, moving), "test", "."));
        std::vector<PathResult> alone;
        RayCounts rays;
        for (int i = 0; i < kPaths; ++i) {
            const Start s = start(scene, i);
            alone.push_back(trace_path(scene, s.ray, s.sampler, kDepth, nullptr));
            rays.add(alone.back().rays);
        }
        EXPECT_GT(rays.shadow, uint64_t(kPaths));
        EXPECT_GT(rays.bounce, uint64_t(kPaths));
        PathBatch batch(scene, kDepth);
        size_t size = 1;
        for (int first = 0; first < kPaths; first += int(batch.size())) {
            batch.clear();
            size = size * 5 % PathBatch::kMost + 1;
            for (int i = first; i < kPaths && batch.size() < size; ++i) {
                const Start s = start(scene, i);
                batch.add(s.ray, s.sampler);
            }
            ASSERT_TRUE(batch.trace(kNever));
            for (size_t k = 0; k < batch.size(); ++k)
                EXPECT_TRUE(same_bits(batch.result(k), alone[size_t(first) + k]))
                    << "path " << size_t(first) + k << " of a batch of " << batch.size();
        }
    }
}

TEST(PathBatch, StopsBetweenTheStepsOfItsPaths) {
    const RenderScene scene(read_pbrt_string(scene_text(true, false), "test", "."));
    PathBatch batch(scene, 1000);
    while (!batch.full()) {
        const Start s = start(scene, int(batch.size()));
        batch.add(s.ray, s.sampler);
    }
    int asked = 0;
    EXPECT_FALSE(batch.trace([&] { return ++asked == 3; }));
    EXPECT_EQ(asked, 3);
}

}  // namespace
}  // namespace covtrace
