// Promises of the library beside its mathematics: values only, no allocation, no exceptions, any
// vector type, both precisions, compile time where nothing forbids it.
#include <gtest/gtest.h>

#include <atomic>
#include <covariance/covariance.hpp>
#include <cstdlib>
#include <new>
#include <type_traits>

namespace {
std::atomic<long> allocations{0};
}  // namespace

[[gnu::noinline]] void* operator new(std::size_t size) {
    ++allocations;
    if (void* p = std::malloc(size)) return p;
    throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept {
    std::free(p);
}
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept {
    std::free(p);
}

namespace {

using namespace covariance;

/// A vector type as a renderer might have it.
struct RendererVec {
    float x, y, z;
};

static_assert(Vec3Like<RendererVec>);
static_assert(!Vec3Like<int>);

/// A vector type whose coordinates are functions.
struct PrivateVec {
    constexpr double x() const { return 1; }
    constexpr double y() const { return 2; }
    constexpr double z() const { return 3; }
};
static_assert(Vec3<float>(PrivateVec{}) == Vec3<float>{1, 2, 3});
static_assert(std::is_trivially_copyable_v<LightField<float>>);
static_assert(sizeof(SymmetricMatrix5<float>) == 15 * sizeof(float));
static_assert(sizeof(LightField<float>) == 24 * sizeof(float));
static_assert(std::is_nothrow_default_constructible_v<Accumulator<double>>);

// Operators that are evaluated at compile time.
constexpr SymmetricMatrix5<double> kTravelled =
    travel(SymmetricMatrix5<double>::diagonal(4, 1, 0, 0, 0), 0.5);
static_assert(kTravelled(0, 2) == -2 && kTravelled(2, 2) == 1 && kTravelled(2, 0) == -2);
static_assert(convolve_angular(kTravelled, Sym2<double>{})(0, 0) == 0);
static_assert(transform(kTravelled, travel_matrix(-0.5))(2, 2) == 0);
static_assert(preintegrate(SymmetricMatrix5<double>::diagonal(1, 2, 0, 0, 0)) ==
              Sym2<double>{1, 0, 2});

static_assert(noexcept(travel(LightField<float>{}, 1)));
static_assert(noexcept(surface_exit(LightField<float>{}, Surface<float>{})));
static_assert(noexcept(reflect_glossy(LightField<float>{}, Surface<float>{}, Vec3<float>{},
                                      Sym2<float>{})));
static_assert(noexcept(scatter_in_volume(LightField<float>{}, Vec3<float>{}, 0.5F)));
static_assert(noexcept(pass_through(LightField<float>{}, Surface<float>{}, Sym2<float>{})));
static_assert(roughened(Sym2<double>::diagonal(1, 2), Sym2<double>{}) ==
              Sym2<double>::diagonal(1, 2));
static_assert(absorb(SymmetricMatrix5<double>{}, {0, 0, 0, 0, 0}) == SymmetricMatrix5<double>{});
static_assert(edge_visibility(0.0) == 1 && edge_visibility(1.0) == 0);
static_assert(noexcept(sample_count(SymmetricMatrix5<float>{}, sensor_window<float>(), 1)));

template <typename T>
class Contract : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(Contract, Precisions);

TYPED_TEST(Contract, WholePathWithTheCallersVectorsAllocatesNothing) {
    using T = TypeParam;
    const RendererVec n{0, 0, 1}, t1{1, 0, 0}, t2{0, 1, 0}, down{0, 0, -1}, up{0, 0, 1};
    const long before = allocations;

    const Surface<T> floor{n, t1, t2, {}};
    const Motion<T> moving{RendererVec{1, 0, 0}, RendererVec{0, 0, 0}};
    LightField<T> f = area_source(disc_moments(T(0.5)), frame_along<T>(down));
    f = travel(f, 1);
    f = occlude(f, RendererVec{0.5F, 0, 0}, T(0.01), RendererVec{0, 1, 0});
    f = travel(f, 1);
    f = motion_enter(f, moving);
    f = surface_enter(f, floor);
    const LightField<T> glossy = reflect_glossy(f, floor, up, micro_ggx(T(0.3), T(0.3)));
    const LightField<T> clear = refract_glossy(f, floor, down, 1, T(1.5), phong_cov(T(50)));
    const auto brdf = [](const auto& wi, const auto& wo) { return wi.z * wo.z; };
    const auto world = [](const Vec3<T>& v) { return v; };
    const auto pair = reflection_pair(f.frame, floor, up, micro_ggx(T(0.3), T(0.3)));
    const LightField<T> own =
        scatter(f, local_lobe(brdf, world, f.frame, pair, cosine_window(f.frame, floor.n)));
    const auto bumps = normal_field(floor, MapSlopes<T>{T(0.1), 0, {1, 2, 3, 4}});
    const LightField<T> bent = surface_exit(
        reflect_specular(surface_enter(f, floor, bumps), shading_surface(floor, bumps), up), floor,
        bumps);
    const LightField<T> fog = scatter_in_volume(pass_through(f, floor, {}), up, T(0.5));
    f = reflect_diffuse(f, floor, up);
    f = add_texture(f, checkerboard_texture(T(0.1), T(0.2), T(0.01)));
    f = merge(surface_exit(f, floor), 2, surface_exit(glossy, floor), 1);
    f = motion_exit(f, moving);
    f = travel(f, 3);
    const ThinLens<T> camera{t1, t2, down, 2, T(0.1), 100, 100, T(0.1)};
    Accumulator<T> pixel;
    const bool added = pixel.add(sensor(f, camera), 1);
    const Sym2<T> spectrum = preintegrate(pixel.mean());
    const Sym2<T> q = filter_quadratic(spectrum, 2);
    const SampleCount<T> count =
        sample_count(pixel.mean(), sensor_window<T>(), image_factor(T(2), 4));

    EXPECT_EQ(allocations, before);
    EXPECT_TRUE(added);
    for (const LightField<T>& each : {clear, own, bent, fog}) EXPECT_TRUE(is_finite(each.sigma));
    EXPECT_GT(q.xx, 0);
    EXPECT_GT(count.total, 0);
    EXPECT_GE(count.integration, 1);
}

TYPED_TEST(Contract, NotANumberStaysVisible) {
    using T = TypeParam;
    LightField<T> f;
    f.sigma(0, 0) = std::numeric_limits<T>::quiet_NaN();
    const Surface<T> floor;
    EXPECT_FALSE(is_finite(travel(f, 1).sigma));
    EXPECT_FALSE(is_finite(surface_enter(f, floor).sigma));
    EXPECT_FALSE(is_finite(reflect_diffuse(f, floor, RendererVec{0, 0, 1}).sigma));
    EXPECT_FALSE(is_finite(sensor(travel(f, 1), ThinLens<T>{.e3 = {0, 0, -1}})));
    EXPECT_TRUE(std::isnan(preintegrate(f.sigma).xx));
    Accumulator<T> pixel;
    EXPECT_FALSE(pixel.add(f.sigma, 1));
}

}  // namespace
