// Media whose density varies: transmittance, emission, scattering whose images are known.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "core/rng.h"
#include "tests/render/fixtures.h"

namespace covtrace {
namespace {

using namespace test;

/// Parallel rays along +z through a square of 2 x 2 units, and a ball of radius 1.5 of the medium.
std::string scene(int max_depth, const std::string& medium, const std::string& light) {
    return fmt::format(R"(
Integrator "volpath" "integer maxdepth" {}
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
PixelFilter "box"
LookAt 0 0 -4  0 0 0  0 1 0
Camera "orthographic"
WorldBegin
MakeNamedMedium "m" "string type" {}
{}
MediumInterface "m" ""
Material "interface"
Shape "sphere" "float radius" 3
)",
                       max_depth, medium, light);
}

/// A grid of 4 x 4 x 5 cells in the cube from -1 to 1: densities from 0 to 3.
std::string grid_of(const std::string& name, float factor = 1) {
    std::string text = fmt::format(" \"float {}\" [", name);
    Rng rng(5);
    for (int i = 0; i < 80; ++i) text += fmt::format(" {}", factor * 3 * rng.next_float());
    return text + " ]";
}
const std::string kCells =
    R"( "integer nx" 4 "integer ny" 4 "integer nz" 5 "point3 p0" [ -1 -1 -1 ] "point3 p1" [ 1 1 1 ])";

const char* const kSky = "LightSource \"infinite\" \"rgb L\" [ 1 1 1 ]";

/// The density of grid_of at a place, by its definition.
double density_at(double x, double y, double z) {
    static const std::vector<double> values = [] {
        Rng rng(5);
        std::vector<double> v;
        for (int i = 0; i < 80; ++i) v.push_back(3 * double(rng.next_float()));
        return v;
    }();
    if (std::abs(x) > 1 || std::abs(y) > 1 || std::abs(z) > 1) return 0;
    const std::array<double, 3> p{(x + 1) * 2 - 0.5, (y + 1) * 2 - 0.5, (z + 1) * 2.5 - 0.5};
    const std::array<int, 3> n{4, 4, 5};
    double sum = 0;
    for (int i = 0; i < 8; ++i) {
        double weight = 1;
        std::array<int, 3> c;
        bool inside = true;
        for (size_t a = 0; a < 3; ++a) {
            const double floor = std::floor(p[a]), t = p[a] - floor;
            c[a] = int(floor) + (i >> a & 1);
            weight *= (i >> a & 1) ? t : 1 - t;
            inside = inside && c[a] >= 0 && c[a] < n[a];
        }
        if (inside) sum += weight * values[size_t(c[0] + 4 * (c[1] + 4 * c[2]))];
    }
    return sum;
}

/// The mean over the image of f(column density up to t, t), integrated over the densities of rays.
template <class F>
double mean_over_rays(const F& along) {
    constexpr int kAcross = 48;
    double sum = 0;
    for (int i = 0; i < kAcross; ++i)
        for (int j = 0; j < kAcross; ++j)
            sum += along(-1 + 2 * (i + 0.5) / kAcross, -1 + 2 * (j + 0.5) / kAcross) /
                   (kAcross * kAcross);
    return sum;
}

double mean_of(const Image& image, int channel) {
    double sum = 0;
    for (size_t i = 0; i < image.pixel_count(); ++i)
        sum += double(image.rgb(i)[channel]) / double(image.pixel_count());
    return sum;
}
double error_of(const Image& image, int channel) {
    double sum = 0;
    for (size_t i = 0; i < image.pixel_count(); ++i)
        sum += double(image.rgb(i, "variance.")[channel]);
    return std::sqrt(sum) / double(image.pixel_count());
}

constexpr int kSteps = 400;

TEST(MediaGrid, AttenuatesByTheIntegralOfItsDensity) {
    const auto passes = [](double sigma) {
        return mean_over_rays([&](double x, double y) {
            double column = 0;
            for (int k = 0; k < kSteps; ++k)
                column += density_at(x, y, -1 + 2 * (k + 0.5) / kSteps) * 2 / kSteps;
            return std::exp(-sigma * column);
        });
    };
    const std::string medium = "\"uniformgrid\"" + kCells + grid_of("density") +
                               R"( "rgb sigma_a" [ 0.5 0 0.2 ] "rgb sigma_s" [ 0 0.1 0.3 ])";
    const Image image = render_text(scene(0, medium, kSky), uniform(256)).image;
    for (const auto& [channel, sigma] : {std::pair{0, 0.5}, {1, 0.1}, {2, 0.5}}) {
        const double expected = passes(sigma);
        EXPECT_NEAR(mean_of(image, channel), expected,
                    5 * error_of(image, channel) + 2e-3 * expected);
    }
}

TEST(MediaGrid, FollowsItsTransform) {
    // The cube is turned about the view and made twice as large, so that the picture shows its
    // middle
    const std::string medium = "\"uniformgrid\"" + kCells + grid_of("density") +
                               R"( "rgb sigma_a" [ 1 1 1 ] "rgb sigma_s" [ 0 0 0 ])";
    std::string turned = scene(0, medium, kSky);
    turned.replace(turned.find("MakeNamedMedium"), 0,
                   "AttributeBegin\nScale 2 2 2\nRotate 90 0 0 1\n");
    turned.replace(turned.find("LightSource"), 0, "AttributeEnd\n");
    const double expected = mean_over_rays([](double x, double y) {
        double column = 0;
        // A quarter turn takes x to y, and y to -x
        for (int k = 0; k < kSteps; ++k)
            column += density_at(y / 2, -x / 2, -1 + 2 * (k + 0.5) / kSteps) * 4 / kSteps;
        return std::exp(-column);
    });
    const Image image = render_text(turned, uniform(256)).image;
    EXPECT_NEAR(mean_of(image, 0), expected, 5 * error_of(image, 0) + 2e-3 * expected);
}

TEST(MediaGrid, AWhiteOneInAWhiteWorldIsNotSeen) {
    const std::string medium =
        "\"uniformgrid\"" + kCells + grid_of("density", 3) +
        R"( "rgb sigma_a" [ 0 0 0 ] "rgb sigma_s" [ 0.5 1 2 ] "float g" 0.4)";
    const Image image = render_text(scene(400, medium, kSky), uniform(128, 3)).image;
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(mean_of(image, c), 1, 5 * error_of(image, c) + 2e-4) << c;
}

TEST(MediaGrid, SingleScatteringOfALampBesideIt) {
    // A point light at (0, 3, 0.5): L = int sigma_s rho I / (4 pi r^2) exp(-columns) ds
    const double s = 0.4, a = 0.2, intensity = 20;
    const auto column = [](double x, double y, double z, double lx, double ly, double lz) {
        constexpr int kPieces = 60;
        const double length = std::sqrt(lx * lx + ly * ly + lz * lz);
        double sum = 0;
        for (int k = 0; k < kPieces; ++k) {
            const double t = (k + 0.5) / kPieces;
            sum += density_at(x + t * lx, y + t * ly, z + t * lz) * length / kPieces;
        }
        return sum;
    };
    constexpr int kAcross = 12, kAlong = 60;
    double expected = 0;
    for (int i = 0; i < kAcross; ++i)
        for (int j = 0; j < kAcross; ++j) {
            const double x = -1 + 2 * (i + 0.5) / kAcross, y = -1 + 2 * (j + 0.5) / kAcross;
            double before = 0;
            for (int k = 0; k < kAlong; ++k) {
                const double step = 2.0 / kAlong, z = -1 + step * (k + 0.5),
                             rho = density_at(x, y, z);
                before += rho * step / 2;
                const double lx = -x, ly = 3 - y, lz = 0.5 - z, r2 = lx * lx + ly * ly + lz * lz;
                expected += s * rho * intensity / (4 * M_PI * r2) *
                            std::exp(-(s + a) * (before + column(x, y, z, lx, ly, lz))) * step /
                            (kAcross * kAcross);
                before += rho * step / 2;
            }
        }
    const std::string medium = "\"uniformgrid\"" + kCells + grid_of("density") +
                               R"( "rgb sigma_a" [ 0.2 0.2 0.2 ] "rgb sigma_s" [ 0.4 0.4 0.4 ])";
    const Image image =
        render_text(
            scene(1, medium,
                  "LightSource \"point\" \"rgb I\" [ 20 20 20 ] \"point3 from\" [ 0 3 0.5 ]"),
            uniform(512, 5))
            .image;
    EXPECT_NEAR(mean_of(image, 1), expected, 5 * error_of(image, 1) + 0.01 * expected);
}

TEST(MediaGrid, EmitsWhateverItsDensity) {
    // L = int e exp(-column) ds, e the field, which a medium without density has as well
    const std::array<double, 3> a{0.3, 1, 0}, e{2, 0.5, 3};
    std::string cells = " \"rgb emission\" [";
    std::istringstream values(grid_of("density").substr(grid_of("density").find('[') + 1));
    for (double v; values >> v;)
        for (const double c : e) cells += " " + std::to_string(v * c);
    for (const double dense : {0, 1}) {
        const std::string medium = "\"uniformgrid\"" + kCells + grid_of("density") + cells +
                                   " ] \"float scale\" " + std::to_string(dense) +
                                   R"( "rgb sigma_a" [ 0.3 1 0 ] "rgb sigma_s" [ 0 0 0 ])";
        const Image image = render_text(scene(5, medium, ""), uniform(512, 3)).image;
        for (size_t c = 0; c < 3; ++c) {
            const double expected = mean_over_rays([&](double x, double y) {
                double light = 0, column = 0;
                for (int k = 0; k < kSteps; ++k) {
                    const double z = -1 + 2 * (k + 0.5) / kSteps, rho = density_at(x, y, z);
                    column += dense * rho / kSteps;
                    light += rho * e[c] * std::exp(-a[c] * column) * 2 / kSteps;
                    column += dense * rho / kSteps;
                }
                return light;
            });
            EXPECT_NEAR(mean_of(image, int(c)), expected,
                        5 * error_of(image, int(c)) + 2e-3 * expected)
                << c << " " << dense;
        }
    }
}

TEST(MediaGrid, GlowsAsItsFieldTells) {
    // L = int sigma_a rho Le f exp(-column) ds, f the field; with other absorption in each channel
    const std::array<double, 3> a{0.3, 1, 0}, le{2, 1, 3};
    for (const bool has_field : {true, false}) {
        const std::string medium =
            "\"uniformgrid\"" + kCells + grid_of("density") +
            (has_field ? grid_of("Lescale") : "") +
            R"( "rgb sigma_a" [ 0.3 1 0 ] "rgb sigma_s" [ 0 0 0 ] "rgb Le" [ 2 1 3 ])";
        const Image image =
            render_text(scene(5, medium, "LightSource \"infinite\" \"rgb L\" [ 0 0 0 ]"),
                        uniform(512, 3))
                .image;
        for (size_t c = 0; c < 3; ++c) {
            const double expected = mean_over_rays([&](double x, double y) {
                double light = 0, column = 0;
                for (int k = 0; k < kSteps; ++k) {
                    const double z = -1 + 2 * (k + 0.5) / kSteps, rho = density_at(x, y, z);
                    column += rho / kSteps;
                    light += a[c] * rho * le[c] * (has_field ? rho : 1) * std::exp(-a[c] * column) *
                             2 / kSteps;
                    column += rho / kSteps;
                }
                return light;
            });
            EXPECT_NEAR(mean_of(image, int(c)), expected,
                        5 * error_of(image, int(c)) + 2e-3 * expected)
                << c << " " << has_field;
        }
    }
}

}  // namespace
}  // namespace covtrace
