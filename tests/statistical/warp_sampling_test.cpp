// Chi-square tests of the sampling routines below BSDFs and lights: warps (the lens among them),
// pixel filters, environment maps, phase functions, distances in media.
//
// The tests together alarm falsely with probability 0.01; the seeds are fixed.
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "bsdf/phase_function.h"
#include "camera/pixel_filter.h"
#include "chi_square.h"
#include "core/rng.h"
#include "core/warp.h"
#include "light/environment_map.h"
#include "shading/medium.h"

namespace covtrace {
namespace {

constexpr int kSamples = 200000;
constexpr size_t kTests = 3 + 1 + 1 + 6 + 3 + 8 + 6;

void expect_follows(const std::vector<double>& observed, const std::vector<double>& expected,
                    const std::string& what) {
    double total = 0;
    for (double e : expected) total += e;
    EXPECT_NEAR(total, kSamples, 2e-3 * kSamples)
        << what << ": the density does not integrate to 1";
    const ChiSquare test = chi_square_test(observed, expected);
    EXPECT_GT(test.p, sidak(0.01, kTests))
        << what << ": chi-square " << test.value << " at " << test.degrees << " degrees of freedom";
}

/// Cells of equal measure over the sphere: 16 of the height, 24 of the azimuth.
struct SphereCells {
    static constexpr int kHeight = 16, kAzimuth = 24;
    static size_t find(Vec3 w) {
        const int i = std::clamp(int((w.z + 1) / 2 * kHeight), 0, kHeight - 1);
        const double phi = std::atan2(w.y, w.x) / (2 * M_PI);
        const int j = std::clamp(int((phi < 0 ? phi + 1 : phi) * kAzimuth), 0, kAzimuth - 1);
        return size_t(i) * kAzimuth + size_t(j);
    }
    /// Integrals of a density over the cells by the midpoint rule with n x n points in each.
    static std::vector<double> integrate(const std::function<double(Vec3)>& density, int n) {
        std::vector<double> sums(kHeight * kAzimuth);
        const int rows = kHeight * n, columns = kAzimuth * n;
        const double area = 4 * M_PI / (double(rows) * columns);
        for (int i = 0; i < rows; ++i)
            for (int j = 0; j < columns; ++j) {
                const double z = -1 + 2 * (i + 0.5) / rows, phi = 2 * M_PI * (j + 0.5) / columns;
                const double r = std::sqrt(1 - z * z);
                sums[size_t(i / n) * kAzimuth + size_t(j / n)] +=
                    area * density({float(r * std::cos(phi)), float(r * std::sin(phi)), float(z)});
            }
        return sums;
    }
};

void expect_directions(const std::function<Vec3(Vec2)>& sample,
                       const std::function<double(Vec3)>& density, int points, uint64_t seed,
                       const std::string& what) {
    std::vector<double> observed(SphereCells::kHeight * SphereCells::kAzimuth);
    Rng rng(seed);
    for (int i = 0; i < kSamples; ++i) observed[SphereCells::find(sample(rng.next_2d()))] += 1;
    std::vector<double> expected = SphereCells::integrate(density, points);
    for (double& e : expected) e *= kSamples;
    expect_follows(observed, expected, what);
}

TEST(WarpSampling, SphereHemisphereAndCone) {
    expect_directions(
        square_to_sphere, [](Vec3) { return kUniformSpherePdf; }, 2, 1, "sphere");
    expect_directions(
        square_to_cosine_hemisphere, [](Vec3 w) { return cosine_hemisphere_pdf(w.z); }, 16, 2,
        "hemisphere");
    // The cone ends on the border between two rows of cells.
    constexpr float h = 0.375f;
    expect_directions([](Vec2 u) { return square_to_cone(u, h); },
                      [](Vec3 w) { return w.z > 1 - h ? cone_pdf(h) : 0.0f; }, 4, 3, "cone");
}

TEST(WarpSampling, TheLensIsUniform) {
    // Cells have equal area: 12 rings of the squared radius, 24 of the angle.
    std::vector<double> observed(12 * 24), expected(12 * 24, double(kSamples) / (12 * 24));
    Rng rng(4);
    for (int i = 0; i < kSamples; ++i) {
        const Vec2 p = square_to_disc(rng.next_2d());
        const int ring = std::min(11, int(dot(p, p) * 12));
        const double phi = std::atan2(p.y, p.x) / (2 * M_PI);
        const int sector = std::clamp(int((phi < 0 ? phi + 1 : phi) * 24), 0, 23);
        observed[size_t(ring * 24 + sector)] += 1;
    }
    expect_follows(observed, expected, "lens");
}

TEST(WarpSampling, Triangles) {
    // Cells are quarters along each of the corners' two coordinates.
    std::vector<double> observed(16), expected(16);
    Rng rng(5);
    for (int i = 0; i < kSamples; ++i) {
        const Vec2 b = square_to_triangle(rng.next_2d());
        ASSERT_GE(b.x, 0);
        ASSERT_GE(b.y, 0);
        ASSERT_LE(b.x + b.y, 1 + 1e-6f);
        observed[size_t(std::min(3, int(b.x * 4)) * 4 + std::min(3, int(b.y * 4)))] += 1;
    }
    for (size_t i = 0; i < 4; ++i)
        for (size_t j = 0; i + j < 4; ++j)
            expected[i * 4 + j] = kSamples * (i + j < 3 ? 2.0 : 1.0) / 16;
    expect_follows(observed, expected, "triangle");
}

TEST(WarpSampling, PixelFilters) {
    using Kind = FilterDescription::Kind;
    struct Case {
        const char* name;
        FilterDescription filter;
        std::function<double(double)> value;  // the filter along one axis, in any scale
    };
    const auto sinc = [](double x) { return x == 0 ? 1 : std::sin(M_PI * x) / (M_PI * x); };
    const auto mitchell = [](double x) {
        const double v = std::abs(x) * 2 / 2.5, b = 0.25, c = 0.375;
        return v < 1 ? ((12 - 9 * b - 6 * c) * v * v * v + (-18 + 12 * b + 6 * c) * v * v +
                        (6 - 2 * b)) /
                           6
                     : ((-b - 6 * c) * v * v * v + (6 * b + 30 * c) * v * v +
                        (-12 * b - 48 * c) * v + (8 * b + 24 * c)) /
                           6;
    };
    const std::vector<Case> cases{
        {"box", {Kind::box, 0.5f, 0.5f}, [](double) { return 1; }},
        {"triangle", {Kind::triangle, 2, 2}, [](double x) { return 2 - std::abs(x); }},
        {"gaussian",
         {Kind::gaussian, 1.5f, 1.5f, 0.5f},
         [](double x) { return std::exp(-2 * x * x) - std::exp(-2 * 2.25); }},
        {"narrow gaussian",
         {Kind::gaussian, 1, 1, 0.3f},
         [](double x) { return std::exp(-x * x / 0.18) - std::exp(-1 / 0.18); }},
        {"mitchell", {Kind::mitchell, 2.5f, 2.5f, 0.5f, 0.25f, 0.375f}, mitchell},
        {"sinc",
         {Kind::lanczos_sinc, 4, 4, 0.5f, 0, 0, 3},
         [&](double x) { return sinc(x) * sinc(x / 3); }},
    };
    for (const Case& c : cases) {
        // Cells are the signs of both axes and the place: |f| is sampled, and the weight's sign
        // tells f's.
        const PixelFilter filter(c.filter);
        constexpr int n = 12, points = 512;
        const double radius = c.filter.x_radius;
        std::array<double, n> positive{}, negative{};
        double absolute = 0;
        for (int i = 0; i < n * points; ++i) {
            const double x = -radius + 2 * radius * (i + 0.5) / (n * points);
            const double f = c.value(x);
            (f < 0 ? negative : positive)[size_t(i / points)] += std::abs(f);
            absolute += std::abs(f);
        }
        std::vector<double> observed(2 * n * n), expected(2 * n * n);
        for (size_t i = 0; i < n; ++i)
            for (size_t j = 0; j < n; ++j) {
                const double scale = kSamples / (absolute * absolute);
                expected[i * n + j] =
                    scale * (positive[i] * positive[j] + negative[i] * negative[j]);
                expected[n * n + i * n + j] =
                    scale * (positive[i] * negative[j] + negative[i] * positive[j]);
            }
        Rng rng(hash_combine(6, uint64_t(&c - cases.data())));
        const auto cell = [&](float x) {
            return size_t(std::clamp(int((x / radius + 1) / 2 * n), 0, n - 1));
        };
        for (int i = 0; i < kSamples; ++i) {
            const PixelFilter::Sample s = filter.sample(rng.next_2d());
            observed[(s.weight < 0 ? n * n : 0) + cell(s.offset.x) * n + cell(s.offset.y)] += 1;
        }
        expect_follows(observed, expected, c.name);
    }
}

TEST(WarpSampling, EnvironmentMaps) {
    // The maps are smooth waves with a sun of one texel.
    const auto texels = [](int width, int height) {
        std::vector<Rgb> t;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                t.push_back(Rgb(1 + std::sin(0.3f * float(x)) * std::cos(0.4f * float(y))));
        t[size_t(height / 3) * size_t(width) + size_t(width / 5)] = Rgb(60);
        return t;
    };
    for (const auto& [width, height] : {std::pair{32, 32}, {64, 32}, {7, 7}}) {
        const EnvironmentMap map(texels(width, height), width, height);
        expect_directions([&](Vec2 u) { return map.sample(u); }, [&](Vec3 w) { return map.pdf(w); },
                          48, hash_combine(7, uint64_t(width)),
                          "environment " + std::to_string(width) + "x" + std::to_string(height));
    }
}

TEST(WarpSampling, PhaseFunctions) {
    const Vec3 wo = normalize(Vec3{0.3f, -0.5f, 0.4f});
    for (float g : {-0.9f, -0.5f, -1e-4f, 0.0f, 1e-3f, 0.3f, 0.7f, 0.95f}) {
        // Cells are about the direction of travel, fine where the lobe is: equal parts of u.
        const Frame frame = Frame::from_z(-wo);
        constexpr int n = 24;
        std::vector<double> observed(n * 8), expected(n * 8);
        std::vector<double> edges{-1};
        for (int i = 1; i < n; ++i) edges.push_back(sample_henyey_greenstein(g, float(i) / n));
        edges.push_back(1);
        for (size_t i = 0; i < n; ++i) {
            double mass = 0;
            constexpr int points = 4000;
            for (int k = 0; k < points; ++k) {
                const double c = edges[i] + (edges[i + 1] - edges[i]) * (k + 0.5) / points;
                mass += henyey_greenstein(g, float(c)) * (edges[i + 1] - edges[i]) / points;
            }
            for (size_t j = 0; j < 8; ++j) expected[i * 8 + j] = kSamples * 2 * M_PI * mass / 8;
        }
        Rng rng(hash_combine(8, uint64_t((g + 1) * 1e6f)));
        for (int i = 0; i < kSamples; ++i) {
            const Vec3 w = frame.to_local(sample_phase(g, wo, rng.next_2d()));
            const auto row = std::upper_bound(edges.begin() + 1, edges.end() - 1, double(w.z)) -
                             edges.begin() - 1;
            const double phi = std::atan2(w.y, w.x) / (2 * M_PI);
            const int column = std::clamp(int((phi < 0 ? phi + 1 : phi) * 8), 0, 7);
            observed[size_t(row) * 8 + size_t(column)] += 1;
        }
        expect_follows(observed, expected, "phase function of g = " + std::to_string(g));
    }
}

TEST(WarpSampling, DistancesInMedia) {
    // Density of scattering at t: sum over the channels of share * sigma_s * exp(-sigma_t t), but
    // for a part that is even in the angle at a light; the last cell is the way through.
    struct Case {
        Medium medium;
        float length;
        Rgb throughput;
        std::optional<LightBeside> light = std::nullopt;
    };
    const std::array<Case, 6> cases{
        Case{{Rgb(0.0f), Rgb(1.5f), {}, 0}, 2, Rgb(1)},
        Case{{{0.2f, 1, 3}, {1, 1, 0.1f}, {}, 0}, 1.5f, {1, 0.4f, 2}},
        Case{{{0, 0.5f, 0}, {0, 2, 8}, {}, 0}, kInfinity, {1, 0.5f, 0.25f}},
        Case{{{5, 0, 1}, {0.01f, 0, 20}, {}, 0}, 0.1f, {1, 0, 1}},
        Case{{Rgb(0.0f), Rgb(1.5f), {}, 0}, 2, Rgb(1), LightBeside{0.7f, 0.05f, 1}},
        Case{{{0.2f, 1, 3}, {1, 1, 0.1f}, {}, 0},
             1.5f,
             {1, 0.4f, 2},
             LightBeside{-0.1f, 0.2f, 0.6f}}};
    for (const Case& c : cases) {
        constexpr int n = 20;
        const double end = std::isfinite(c.length) ? c.length : 4;
        const Rgb t = c.medium.extinction(), albedo = c.medium.albedo();
        const double sum = c.throughput.r + c.throughput.g + c.throughput.b;
        const auto by_distance_before = [&](double d) {
            double p = 0;
            for (int k = 0; k < 3; ++k)
                if (t[k] > 0)
                    p += c.throughput[k] / sum * albedo[k] * -std::expm1(-double(t[k]) * d);
            return p;
        };
        double by_angle = 0;
        if (c.light) {
            const Rgb passes = transmittance(c.medium, std::clamp(c.light->along, 0.0f, c.length));
            by_angle = 0.5 * c.light->share * by_distance_before(c.length);
            by_angle *= (c.throughput.r * passes.r + c.throughput.g * passes.g +
                         c.throughput.b * passes.b) /
                        sum;
        }
        const auto scattered_before = [&](double d) {
            const double p = (1 - by_angle) * by_distance_before(d);
            if (!c.light) return p;
            const auto angle = [&](double at) {
                return std::atan((at - c.light->along) / c.light->away);
            };
            return p + by_angle * (angle(std::min(d, double(c.length))) - angle(0)) /
                           (angle(c.length) - angle(0));
        };
        std::vector<double> observed(n + 2), expected(n + 2);
        for (int i = 0; i < n; ++i)
            expected[size_t(i)] =
                kSamples * (scattered_before(end * (i + 1) / n) - scattered_before(end * i / n));
        const double all = scattered_before(c.length);
        expected[n] = kSamples * (all - scattered_before(end));
        expected[n + 1] = kSamples * (1 - all);
        // The weights estimate transmittance and the scattered share without bias, channel by
        // channel: 5 standard errors (false alarm 6e-7 each).
        std::array<double, 3> through{}, through2{}, scattered{}, scattered2{};
        Rng rng(hash_combine(9, uint64_t(&c - cases.data())));
        for (int i = 0; i < kSamples; ++i) {
            const MediumEvent e =
                sample_event(c.medium, {}, c.length, c.throughput, rng.next_2d(), c.light);
            const size_t cell =
                !e.scatters ? n + 1 : std::min<size_t>(n, size_t(e.distance / end * n));
            observed[cell] += 1;
            for (size_t k = 0; k < 3; ++k) {
                const double w = e.weight[int(k)];
                (e.scatters ? scattered : through)[k] += w;
                (e.scatters ? scattered2 : through2)[k] += w * w;
            }
        }
        expect_follows(observed, expected, "medium " + std::to_string(&c - cases.data()));
        const Rgb passes = transmittance(c.medium, c.length);
        for (size_t k = 0; k < 3; ++k) {
            if (!(c.throughput[int(k)] > 0)) continue;
            const auto expect_mean = [&](double s, double s2, double value) {
                const double mean = s / kSamples, variance = s2 / kSamples - mean * mean;
                EXPECT_NEAR(mean, value, 5 * std::sqrt(std::max(variance, 0.0) / kSamples) + 1e-6);
            };
            expect_mean(through[k], through2[k], passes[int(k)]);
            expect_mean(scattered[k], scattered2[k], albedo[int(k)] * (1 - passes[int(k)]));
        }
    }
}

}  // namespace
}  // namespace covtrace
