/// Micro-benchmarks of the functions that a path calls most (Google Benchmark). Arguments are drawn
/// beforehand, so that branches are taken as in a render; each iteration uses the next of them.
#include <benchmark/benchmark.h>

#include <vector>

#include "bsdf/bsdf.h"
#include "bsdf/coat_table.h"
#include "camera/pixel_filter.h"
#include "core/rng.h"
#include "core/sampler.h"
#include "core/warp.h"
#include "light/environment_map.h"
#include "light/spherical_triangle.h"
#include "light/tree.h"
#include "render/film.h"

namespace {

using namespace covtrace;

constexpr size_t kDraws = 1024;

/// Repeats `function(next argument)`; `make(rng)` draws an argument.
template <typename Make, typename Function>
void repeat(benchmark::State& state, const Make& make, const Function& function) {
    Rng rng(1);
    std::vector<decltype(make(rng))> arguments;
    for (size_t i = 0; i < kDraws; ++i) arguments.push_back(make(rng));
    size_t i = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(function(arguments[i]));
        i = (i + 1) % kDraws;
    }
}

Vec3 unit_vector(Rng& rng) {
    return square_to_sphere(rng.next_2d());
}
Vec3 upper(Rng& rng) {
    return square_to_cosine_hemisphere(rng.next_2d());
}
Vec3 in_cube(Rng& rng) {
    const Vec2 u = rng.next_2d();
    return Vec3{u.x, u.y, rng.next_float()} * 10;
}

void sampler_camera(benchmark::State& state) {
    repeat(
        state, [](Rng& rng) { return rng.next_uint(); },
        [](uint32_t index) { return Sampler(1, 20, 30, index).camera(); });
}
BENCHMARK(sampler_camera);

void sampler_bounce(benchmark::State& state) {
    repeat(
        state, [](Rng& rng) { return rng.next_uint(); },
        [](uint32_t index) { return Sampler(1, 20, 30, index).next_four_2d(); });
}
BENCHMARK(sampler_bounce);

void pixel_filter(benchmark::State& state) {
    const PixelFilter filter{FilterDescription{}};
    repeat(
        state, [](Rng& rng) { return rng.next_2d(); }, [&](Vec2 u) { return filter.sample(u); });
}
BENCHMARK(pixel_filter);

void film_add(benchmark::State& state) {
    FilmPixel pixel;
    repeat(
        state,
        [](Rng& rng) {
            FilmSample s;
            s.radiance = Rgb(rng.next_float());
            s.hit = true;
            return s;
        },
        [&](const FilmSample& s) {
            pixel.add(s);
            return pixel.mean.r;
        });
}
BENCHMARK(film_add);

/// A choice among `state.range(0)` lamps in a cube.
void light_tree_sample(benchmark::State& state) {
    Rng rng(2);
    std::vector<LightBounds> lights(static_cast<size_t>(state.range(0)));
    for (LightBounds& light : lights) {
        light.box.extend(in_cube(rng));
        light.axis = unit_vector(rng);
        light.intensity = rng.next_float();
    }
    const LightTree tree(lights);
    struct At {
        Vec3 p, n;
        float u;
    };
    repeat(
        state,
        [](Rng& r) {
            return At{in_cube(r), unit_vector(r), r.next_float()};
        },
        [&](const At& at) { return tree.sample(at.p, at.n, at.u); });
}
BENCHMARK(light_tree_sample)->Arg(2)->Arg(30)->Arg(1000);

void spherical_triangle_sample(benchmark::State& state) {
    struct At {
        Vec3 p;
        Vec2 u;
    };
    const WorldTriangle triangle{{0, 0, 12}, {10, 0, 12}, {0, 10, 12}};
    repeat(
        state,
        [](Rng& rng) {
            return At{in_cube(rng), rng.next_2d()};
        },
        [&](const At& at) { return sample_direction(spherical_triangle(triangle, at.p), at.u); });
}
BENCHMARK(spherical_triangle_sample);

/// A sky with a sun, lat-long where range(0) is 2, equal-area where it is 1.
EnvironmentMap sky(int64_t aspect) {
    const int height = 512, width = static_cast<int>(aspect) * height;
    std::vector<Rgb> texels(static_cast<size_t>(width) * static_cast<size_t>(height));
    Rng rng(3);
    for (Rgb& t : texels) t = Rgb(0.5f + rng.next_float());
    for (size_t i = 0; i < 40; ++i) texels[texels.size() / 3 + i] = Rgb(1e5f);
    return {texels, width, height};
}
void environment_sample(benchmark::State& state) {
    const EnvironmentMap map = sky(state.range(0));
    repeat(
        state, [](Rng& rng) { return rng.next_2d(); }, [&](Vec2 u) { return map.sample(u); });
}
BENCHMARK(environment_sample)->Arg(1)->Arg(2);
void environment_look(benchmark::State& state) {
    const EnvironmentMap map = sky(state.range(0));
    repeat(state, unit_vector, [&](Vec3 w) { return map.look(w); });
}
BENCHMARK(environment_look)->Arg(1)->Arg(2);

/// Models by number: diffuse, rough metal, rough glass, coated diffuse, coated metal.
Bsdf model(int64_t which) {
    static const CoatTable coat(1.5f, 0.01f);
    const ConductorBsdf metal{Rgb(0.2f, 0.9f, 1.1f), Rgb(3.9f, 2.4f, 2.2f), 0.2f, 0.2f};
    switch (which) {
        case 0:
            return DiffuseBsdf{Rgb(0.5f)};
        case 1:
            return metal;
        case 2:
            return DielectricBsdf{1.5f, 0.2f, 0.2f};
        case 3:
            return make_coated_diffuse(coat, reflectance_powers(Rgb(0.5f)), 0.2f, 0.2f, 5);
        default:
            return CoatedConductorBsdf{{1.5f, 0.1f, 0.1f}, metal, 0.01f, 5, 1};
    }
}
void bsdf_sample(benchmark::State& state) {
    const Bsdf bsdf = model(state.range(0));
    struct At {
        Vec3 wo;
        float u_lobe;
        Vec2 u;
    };
    repeat(
        state,
        [](Rng& rng) {
            return At{upper(rng), rng.next_float(), rng.next_2d()};
        },
        [&](const At& at) { return sample(bsdf, at.wo, at.u_lobe, at.u); });
}
BENCHMARK(bsdf_sample)->DenseRange(0, 4);
void bsdf_eval_and_pdf(benchmark::State& state) {
    const Bsdf bsdf = model(state.range(0));
    struct Pair {
        Vec3 wo, wi;
    };
    repeat(
        state,
        [](Rng& rng) {
            return Pair{upper(rng), upper(rng)};
        },
        [&](const Pair& pair) { return eval_and_pdf(bsdf, pair.wo, pair.wi); });
}
BENCHMARK(bsdf_eval_and_pdf)->DenseRange(0, 4);

}  // namespace

BENCHMARK_MAIN();
