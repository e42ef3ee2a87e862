#include "bsdf/thin_film.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>

#include "bsdf/models.h"

namespace covtrace::test {
namespace {

double skewed(double l, double peak, double centre, double left, double right) {
    const double x = (l - centre) / (l < centre ? left : right);
    return peak * std::exp(-0.5 * x * x);
}

/// The colour matching functions of CIE 1931 at l nm (Wyman, Sloan and Shirley 2013).
std::array<double, 3> matching(double l) {
    return {skewed(l, 1.056, 599.8, 37.9, 31.0) + skewed(l, 0.362, 442.0, 16.0, 26.7) -
                skewed(l, 0.065, 501.1, 20.4, 26.2),
            skewed(l, 0.821, 568.8, 46.9, 40.5) + skewed(l, 0.286, 530.9, 16.3, 31.1),
            skewed(l, 1.217, 437.0, 11.8, 36.0) + skewed(l, 0.681, 459.0, 26.0, 13.8)};
}

/// Airy's reflectance of a film on a surface of index n for one wavelength, all rounds of light,
/// mean of both polarisations.
double airy(const ThinFilm& film, double cos_i, double n, double nm) {
    const double eta = double(film.eta), sin2 = 1 - cos_i * cos_i;
    const double cos_film = std::sqrt(1 - sin2 / (eta * eta)),
                 cos_n = std::sqrt(1 - sin2 / (n * n));
    const double path = 2 * eta * double(film.thickness) * cos_film;
    const std::complex<double> turn = std::polar(1.0, 2 * M_PI * path / nm);
    const auto reflectance = [&](double r12, double r23) {
        return std::norm((r12 + r23 * turn) / (1.0 + r12 * r23 * turn));
    };
    const auto r = [](double a, double b) { return (a - b) / (a + b); };
    return 0.5 * (reflectance(r(cos_i, eta * cos_film), r(eta * cos_film, n * cos_n)) +
                  reflectance(r(eta * cos_i, cos_film), r(n * cos_film, eta * cos_n)));
}

/// Its colour under light of even power, which is white.
Rgb integrated(const ThinFilm& film, double cos_i, double n) {
    std::array<double, 3> sum{}, white{};
    for (double nm = 360; nm <= 830; nm += 1) {
        const auto m = matching(nm);
        const double r = airy(film, cos_i, n, nm);
        for (size_t c = 0; c < 3; ++c) {
            sum[c] += r * m[c];
            white[c] += m[c];
        }
    }
    const auto rec709 = [](const std::array<double, 3>& v) {
        return Rgb{float(3.2404542 * v[0] - 1.5371385 * v[1] - 0.4985314 * v[2]),
                   float(-0.9692660 * v[0] + 1.8760108 * v[1] + 0.0415560 * v[2]),
                   float(0.0556434 * v[0] - 0.2040259 * v[1] + 1.0572252 * v[2])};
    };
    return rec709(sum) / rec709(white);
}

float at_normal(float n) {
    return sqr((n - 1) / (n + 1));
}

TEST(ThinFilm, HasTheColoursOfTheSpectrum) {
    struct Case {
        ThinFilm film;
        float n;
    };
    for (const Case& c :
         {Case{{1, 1.3f, 400}, 1.5f}, Case{{1, 1.33f, 250}, 1.5f}, Case{{1, 1.8f, 300}, 1.5f},
          Case{{1, 1.5f, 500}, 4.0f}, Case{{1, 1.3f, 100}, 1.5f}, Case{{1, 1.3f, 1200}, 1.5f},
          Case{{1, 1.5f, 300}, 20.0f}, Case{{1, 2.4f, 60}, 3.0f}})
        for (const float cosine : {1.0f, 0.8f, 0.5f, 0.2f}) {
            const Rgb found = film_reflectance(c.film, cosine, Rgb(at_normal(c.n))),
                      expected = integrated(c.film, double(cosine), double(c.n));
            // The fits are within 1 % of the integral of white, and interference moves light from
            // one colour to another
            const float tolerance = 0.01f + 0.03f * max_component(expected);
            for (int k = 0; k < 3; ++k)
                EXPECT_NEAR(found[k], std::max(0.0f, expected[k]), tolerance)
                    << c.film.thickness << " nm, index " << c.film.eta << " on " << c.n
                    << ", cosine " << cosine << ", channel " << k;
        }
}

TEST(ThinFilm, OfNoThicknessOrOfTheOutsidesIndexIsNone) {
    for (const float cosine : {1.0f, 0.6f, 0.1f}) {
        const float bare = fresnel_dielectric(cosine, 1.5f).reflectance;
        for (const ThinFilm film : {ThinFilm{1, 1.8f, 0}, ThinFilm{1, 1, 700}}) {
            const Rgb found = film_reflectance(film, cosine, Rgb(at_normal(1.5f)));
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], bare, 1e-4f);
        }
    }
}

TEST(ThinFilm, OfTheSurfacesIndexAndThickHasNoColour) {
    // Light of many wavelengths is out of step after 20 micrometres: what is left is both borders.
    const Rgb found = film_reflectance({1, 1.5f, 20000}, 1, Rgb(at_normal(2.5f)));
    const float r = at_normal(1.5f), s = at_normal(2.5f / 1.5f);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], r + sqr(1 - r) * s / (1 - r * s), 1e-3f);
}

/// The shares of light from `wo` that a clear surface reflects and lets through, by samples of
/// both.
std::array<Rgb, 2> shares(const Bsdf& bsdf, Vec3 wo) {
    std::array<Rgb, 2> found;
    for (const float u_lobe : {0.0f, 0x1.fffffep-1f})
        if (const auto s = sample(bsdf, wo, u_lobe, {0.5f, 0.5f}))
            found[is_transmission(s->lobe)] += s->weight * (s->pdf * sqr(s->eta));
    return found;
}

TEST(ThinFilm, OfClearGlassReflectsWhatDoesNotComeThrough) {
    const ThinFilm film{1, 1.8f, 350};
    DielectricBsdf glass{1.5f};
    glass.film = film;
    for (const float cosine : {1.0f, 0.7f, 0.2f}) {
        const float sine = std::sqrt(1 - sqr(cosine));
        const Rgb expected = film_reflectance(film, cosine, Rgb(at_normal(1.5f)));
        const auto outside = shares(glass, {sine, 0, cosine});
        // The same way back
        const float inner = sine / 1.5f;
        const auto inside = shares(glass, {inner, 0, -std::sqrt(1 - sqr(inner))});
        ThinDielectricBsdf sheet{1, Rgb(1)};
        sheet.film = film;
        const auto pane = shares(sheet, {sine, 0, cosine});
        const Rgb alone = film_reflectance(film, cosine, Rgb(0));
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(outside[0][k], expected[k], 1e-5f);
            EXPECT_NEAR(outside[1][k], 1 - expected[k], 1e-5f);
            EXPECT_NEAR(inside[0][k], expected[k], 1e-4f);
            EXPECT_NEAR(inside[1][k], 1 - expected[k], 1e-4f);
            EXPECT_NEAR(pane[0][k], alone[k], 1e-5f) << "a film in the air";
            EXPECT_NEAR(pane[1][k], 1 - alone[k], 1e-5f);
        }
    }
    const auto total = sample(glass, {0.8f, 0, -0.6f}, 0.9f, {0.5f, 0.5f});
    EXPECT_EQ(total->lobe, LobeKind::specular_reflection);
    EXPECT_EQ(total->weight, Rgb(1));
}

TEST(ThinFilm, ReflectsAtMostAllAndNothingThatIsNoNumber) {
    for (const float eta : {1e-6f, 0.5f, 1.0f, 1.3f, 3.0f, 1e6f})
        for (const float thickness : {0.0f, 1.0f, 90.0f, 500.0f, 1e9f})
            for (const float base : {0.0f, 0.04f, 0.9f, 1.0f})
                for (const float cosine : {0.0f, 1e-4f, 0.3f, 1.0f}) {
                    const Rgb r = film_reflectance({1, eta, thickness}, cosine, Rgb(base));
                    for (int k = 0; k < 3; ++k) {
                        EXPECT_GE(r[k], 0);
                        EXPECT_LE(r[k], 1);
                    }
                }
}

}  // namespace
}  // namespace covtrace::test
