/// Chi-square tests of `sample` against `pdf`: every model, over roughness, incidence and both
/// sides.
///
/// The tests together alarm falsely with probability 0.01; the seeds are fixed. The share of failed
/// and of specular samples is a cell of its own, so that the integral of the density is tested,
/// too.
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "bsdf/coat_table.h"
#include "bsdf/hair.h"
#include "bsdf/multiple_scattering.h"
#include "bsdf/sheen.h"
#include "chi_square.h"
#include "core/rng.h"

namespace covtrace {
namespace {

struct Case {
    std::string name;
    Bsdf bsdf;
    float alpha;  ///< roughness of the widest of the glossy lobes, 0 where there is none
    float eta;    ///< index of refraction, 1 where there is none
    Vec3 wo;
};
std::ostream& operator<<(std::ostream& out, const Case& c) {
    return out << c.name;
}

Vec3 direction(double theta, double phi) {
    return {static_cast<float>(std::sin(theta) * std::cos(phi)),
            static_cast<float>(std::sin(theta) * std::sin(phi)),
            static_cast<float>(std::cos(theta))};
}

std::vector<Case> all_cases() {
    static const CoatTable coat(1.5f, 0.01f), white(kWhiteIndex, 0);
    static const SheenTable fibres;
    const SheenLobe sheen{{0.9f, 0.5f, 0.1f}, 0.2f, &fibres};
    static const CoatTable border(1.5f, 0), bouncing(1.5f, white);
    ConductorBsdf tinted{Rgb(1), Rgb(0), 0.1f, 0.4f};
    tinted.schlick = metal_of_edge({0.9f, 0.5f, 0}, {0.6f, 1, 0});
    ConductorBsdf filmed = tinted;
    filmed.film = {0.8f, 1.4f, 350};
    static const CoatTable inner_border(1 / 1.5f, 0);
    static const FilmTable under_film(FilmKernel(1.5f), 2.5f, 150);
    DielectricBsdf filmed_glass{1.5f, 0.5f, 0.5f};
    filmed_glass.film = {0.8f, 2.5f, 150};
    const Vec3 aside = normalize(Vec3{0.2f, -0.3f, 1});
    const Rgb eta(0.2f, 0.92f, 1.1f), k(3.9f, 2.45f, 2.14f), tan(0.7f, 0.5f, 0.2f);
    struct Model {
        std::string name;
        Bsdf bsdf;
        float alpha, eta;
    };
    std::vector<Model> models = {
        {"diffuse", DiffuseBsdf{tan}, 0, 1},
        {"transmitting", DiffuseTransmissionBsdf{{0.5f, 0.3f, 0.1f}, {0.1f, 0.2f, 0.2f}}, 0, 1},
        {"varnish", make_coated_diffuse(coat, reflectance_powers(tan), 0, 0, 5), 0, 1},
        {"conductor_brushed", ConductorBsdf{eta, k, 0.1f, 0.4f}, 0.4f, 1},
        {"conductor_bouncing", with_multiple_scattering(ConductorBsdf{eta, k, 0.5f, 0.5f}, white),
         0.5f, 1},
        {"conductor_tinted", tinted, 0.4f, 1},
        {"conductor_filmed", filmed, 0.4f, 1},
        {"dielectric_brushed", DielectricBsdf{1.5f, 0.3f, 0.1f}, 0.3f, 1.5f},
        {"dielectric_filmed",
         with_multiple_scattering(filmed_glass, border, inner_border, &under_film), 0.5f, 1.5f},
        {"dielectric_thin", DielectricBsdf{1 / 1.33f, 0.2f, 0.2f}, 0.2f, 1 / 1.33f},
        {"pane_brushed", ThinDielectricBsdf{1.5f, tan, 0.3f, 0.1f}, 0.3f, 1},
        {"coated_brushed", make_coated_diffuse(coat, reflectance_powers(tan), 0.1f, 0.3f, 5), 0.3f,
         1},
        {"coated_tinted", make_coated_total(coat, tan, 0.1f, 0.3f, {{0.6f, 0.2f, 0}, 0.9f, &white}),
         0.3f, 1},
        {"coated_filmed",
         make_coated_total(coat, tan, 0.2f, 0.2f, {{0.6f, 0.2f, 0}, 0.9f, &white, filmed.film}),
         0.2f, 1},
        {"coated_bouncing", make_coated_total(bouncing, tan, 0.6f, 0.6f, {}, &white), 0.6f, 1},
        {"velvet", LayeredBsdf{make_coated_total(coat, tan, 0.3f, 0.3f), sheen, {}}, 0.3f, 1},
        {"clear_smooth", LayeredBsdf{DiffuseBsdf{tan}, {}, {0.8f, 0, aside}}, 0, 1},
        {"clear_on_metal", LayeredBsdf{ConductorBsdf{eta, k, 0.3f, 0.3f}, {}, {1, 0.1f}}, 0.3f, 1},
        {"lacquer_on_metal",
         LayeredBsdf{tinted, {}, {0.8f, 0.2f, {0, 0, 1}, &border, {0.9f, 0.4f, 0}}}, 0.4f, 1},
        {"clear_on_velvet", LayeredBsdf{DiffuseBsdf{tan}, sheen, {1, 0.2f, aside}}, 0.2f, 1},
    };
    for (const float beta : {0.3f, 0.6f, 1.0f})
        for (const float offset : {0.0f, -0.8f}) {
            HairBsdf hair = make_hair({.beta_m = beta, .beta_n = beta}, {0.1f, 0.3f, 1});
            hair.offset = offset;
            models.push_back({"hair_" + std::to_string(static_cast<int>(beta * 100)) +
                                  (offset == 0 ? "_middle" : "_edge"),
                              hair, 0, 1});
        }
    for (float alpha : {0.02f, 0.1f, 0.3f, 1.0f}) {
        const std::string suffix = std::to_string(static_cast<int>(alpha * 100));
        models.push_back({"conductor_" + suffix, ConductorBsdf{eta, k, alpha, alpha}, alpha, 1});
        models.push_back({"dielectric_" + suffix, DielectricBsdf{1.5f, alpha, alpha}, alpha, 1.5f});
        models.push_back(
            {"pane_" + suffix,
             with_multiple_scattering(ThinDielectricBsdf{1.5f, tan, alpha, alpha}, white), alpha,
             1});
        models.push_back({"coated_" + suffix,
                          make_coated_diffuse(coat, reflectance_powers(tan), alpha, alpha, 5),
                          alpha, 1});
    }
    std::vector<Case> cases;
    for (const Model& m : models)
        for (int degrees : {0, 40, 75, 88, 110, 160})
            cases.push_back({m.name + "_at_" + std::to_string(degrees), m.bsdf, m.alpha, m.eta,
                             direction(degrees * M_PI / 180, 0.8)});
    return cases;
}

/// Edges of `n` cells on [a, b], narrow about `center`.
std::vector<double> edges_about(double a, double b, double center, double scale, int n) {
    const double lo = std::asinh((a - center) / scale), hi = std::asinh((b - center) / scale);
    std::vector<double> edges;
    for (int i = 0; i <= n; ++i)
        edges.push_back(center + scale * std::sinh(lo + (hi - lo) * i / n));
    edges.front() = a;
    edges.back() = b;
    return edges;
}

/// Cells over the sphere, in polar angle and azimuth, fine where the lobes are; the horizon is an
/// edge.
struct Grid {
    std::vector<double> theta, phi;
    explicit Grid(const Case& c) {
        constexpr int kTheta = 16, kPhi = 24;
        const double theta_o = std::acos(c.wo.z), phi_o = std::atan2(c.wo.y, c.wo.x);
        const bool above = theta_o < M_PI / 2;
        const double sin_t = std::min(1.0, std::sin(theta_o) / (above ? c.eta : 1 / c.eta));
        const double theta_r = theta_o,
                     theta_t = above ? M_PI - std::asin(sin_t) : std::asin(sin_t);
        const double scale = c.alpha > 0 ? std::min(1.0, 2.0 * c.alpha) : 1.0;
        theta = edges_about(0, M_PI / 2, above ? theta_r : theta_t, scale, kTheta);
        const auto below = edges_about(M_PI / 2, M_PI, above ? theta_t : theta_r, scale, kTheta);
        theta.insert(theta.end(), below.begin() + 1, below.end());
        // Refraction ends where its microfacets would lie on their sides: |wi.z| = |wo.z| / eta.
        const double rim = std::abs(c.wo.z) / (above ? c.eta : 1 / c.eta);
        if (rim < 1) theta.push_back(std::acos(above ? -rim : rim));
        std::sort(theta.begin(), theta.end());
        // Azimuth 0 of the grid is opposite to the plane's side where the lobes lie.
        const double spread = std::min(1.0, scale / std::max(std::sin(theta_o), 0.1));
        phi = edges_about(-M_PI, M_PI, 0, spread, kPhi);
        lobe_phi = phi_o + M_PI;
    }
    double lobe_phi = 0;
    size_t columns() const { return phi.size() - 1; }
    size_t cells() const { return (theta.size() - 1) * columns(); }
    size_t find(Vec3 w) const {
        double p = std::remainder(std::atan2(w.y, w.x) - lobe_phi, 2 * M_PI);
        const double t = std::acos(std::clamp(w.z, -1.0f, 1.0f));
        const auto row =
            std::upper_bound(theta.begin() + 1, theta.end() - 1, t) - theta.begin() - 1;
        const auto column = std::upper_bound(phi.begin() + 1, phi.end() - 1, p) - phi.begin() - 1;
        return static_cast<size_t>(row) * columns() + static_cast<size_t>(column);
    }
};

/// Adaptive two-dimensional Gauss quadrature of the density over theta and phi.
class CellIntegral {
  public:
    CellIntegral(const Case& c, double lobe_phi) : case_(c), lobe_phi_(lobe_phi) {}
    double operator()(double t0, double t1, double p0, double p1) const {
        return refine(t0, t1, p0, p1, gauss(t0, t1, p0, p1), 1e-6, 0);
    }

  private:
    double gauss(double t0, double t1, double p0, double p1) const {
        static constexpr std::array<double, 3> x{-0.7745966692414834, 0, 0.7745966692414834};
        static constexpr std::array<double, 3> w{5.0 / 18, 8.0 / 18, 5.0 / 18};
        double sum = 0;
        for (size_t i = 0; i < 3; ++i) {
            const double t = (t0 + t1) / 2 + x[i] * (t1 - t0) / 2;
            for (size_t j = 0; j < 3; ++j) {
                const double p = (p0 + p1) / 2 + x[j] * (p1 - p0) / 2;
                sum += w[i] * w[j] * std::sin(t) *
                       pdf(case_.bsdf, case_.wo, direction(t, p + lobe_phi_));
            }
        }
        return sum * (t1 - t0) * (p1 - p0);
    }
    double refine(double t0, double t1, double p0, double p1, double whole, double tolerance,
                  int depth) const {
        const double t = (t0 + t1) / 2, p = (p0 + p1) / 2;
        const std::array<double, 4> parts{gauss(t0, t, p0, p), gauss(t0, t, p, p1),
                                          gauss(t, t1, p0, p), gauss(t, t1, p, p1)};
        const double sum = parts[0] + parts[1] + parts[2] + parts[3];
        if (depth >= 7 || (depth >= 1 && std::abs(sum - whole) < tolerance)) return sum;
        tolerance /= 4;
        return refine(t0, t, p0, p, parts[0], tolerance, depth + 1) +
               refine(t0, t, p, p1, parts[1], tolerance, depth + 1) +
               refine(t, t1, p0, p, parts[2], tolerance, depth + 1) +
               refine(t, t1, p, p1, parts[3], tolerance, depth + 1);
    }
    const Case& case_;
    double lobe_phi_;
};

class BsdfSampling : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Models, BsdfSampling, testing::ValuesIn(all_cases()),
                         [](const auto& c) { return c.param.name; });

TEST_P(BsdfSampling, FollowsTheDensity) {
    const Case& c = GetParam();
    constexpr int kSamples = 150000;
    const Grid grid(c);
    // The last cell counts samples without density: failures and specular lobes.
    std::vector<double> observed(grid.cells() + 1), expected(grid.cells() + 1);
    Rng rng(hash_combine(2024, static_cast<uint64_t>(c.alpha * 1000),
                         static_cast<uint64_t>(c.wo.z * 1e6f)));
    for (int i = 0; i < kSamples; ++i) {
        const float u_lobe = rng.next_float();
        const auto s = sample(c.bsdf, c.wo, u_lobe, rng.next_2d());
        observed[s && !is_specular(s->lobe) ? grid.find(s->wi) : grid.cells()] += 1;
    }
    const CellIntegral integral(c, grid.lobe_phi);
    double total = 0;
    for (size_t i = 0; i < grid.cells(); ++i) {
        const size_t row = i / grid.columns(), column = i % grid.columns();
        expected[i] =
            integral(grid.theta[row], grid.theta[row + 1], grid.phi[column], grid.phi[column + 1]);
        total += expected[i];
        expected[i] *= kSamples;
    }
    EXPECT_LE(total, 1 + 1e-4);
    expected.back() = std::max(0.0, 1 - total) * kSamples;
    // Smaller rests are the quadrature's error, not a share of the samples.
    if (expected.back() < 1e-4 * kSamples && observed.back() == 0) expected.back() = 0;
    const ChiSquare test = chi_square_test(observed, expected);
    EXPECT_GT(test.p, sidak(0.01, all_cases().size()))
        << "chi-square " << test.value << " at " << test.degrees << " degrees of freedom; "
        << observed.back() << " samples without density, " << expected.back() << " expected";
}

}  // namespace
}  // namespace covtrace
