#include "bsdf/thin_film.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace covtrace {
namespace {

/// A Gaussian over the wavenumber nu, 1/m: size exp(-(nu - centre)^2 / (2 variance)).
struct Gaussian {
    float size, centre, variance;
};
/// The colour matching functions, as Belcour and Barla fitted them; x has a second lobe.
constexpr std::array<Gaussian, 3> kMatching{{{5.4856e-13f, 1.6810e6f, 4.3278e9f},
                                             {4.4201e-13f, 1.7953e6f, 9.3046e9f},
                                             {5.2481e-13f, 2.2084e6f, 6.6121e9f}}};
constexpr Gaussian kSecondLobe{9.7470e-14f, 2.2399e6f, 4.5282e9f};

/// Real part of a Gaussian's Fourier transform at the optical path difference `opd`, m.
float transform(const Gaussian& g, float opd) {
    const float phase = 2 * kPi * opd;
    return g.size * std::sqrt(2 * kPi * g.variance) * std::cos(g.centre * phase) *
           std::exp(-g.variance * sqr(phase));
}

Rgb colour_of_cosine(float opd) {
    std::array<float, 3> xyz{};
    for (size_t c = 0; c < 3; ++c) xyz[c] = transform(kMatching[c], opd);
    xyz[0] += transform(kSecondLobe, opd);
    const auto& [x, y, z] = xyz;
    return {3.2404542f * x - 1.5371385f * y - 0.4985314f * z,
            -0.9692660f * x + 1.8760108f * y + 0.0415560f * z,
            0.0556434f * x - 0.2040259f * y + 1.0572252f * z};
}

/// Mean over the spectrum of the cosine of 2 pi nu opd, by colour; 1 where opd is 0.
Rgb mean_cosine(float opd) {
    static const Rgb white = colour_of_cosine(0);
    return colour_of_cosine(opd) / white;
}

/// Amplitude that a border reflects of light of one polarisation, from the products of index and
/// cosine on both sides, which parallel light has crosswise.
float amplitude(float near, float far) {
    return (near - far) / (near + far);
}

}  // namespace

Rgb film_reflectance(const ThinFilm& film, float cos_i, Rgb base) {
    constexpr float kGrazing = 1e-3f;  // beyond it both borders reflect all
    cos_i = std::max(cos_i, kGrazing);
    const float t = clamp01(film.thickness / kThinnestFilm);
    const float eta = std::lerp(1.0f, film.eta, sqr(t) * (3 - 2 * t));
    const float sin2 = std::max(0.0f, 1 - sqr(cos_i)), sin2_film = sin2 / sqr(eta);
    if (sin2_film >= 1) return Rgb(1);
    const float cos_film = std::sqrt(1 - sin2_film);
    const float opd = 2 * eta * film.thickness * cos_film * 1e-9f;
    const std::array<Rgb, 2> cosine{mean_cosine(opd), mean_cosine(2 * opd)};
    const std::array<float, 2> first{amplitude(cos_i, eta * cos_film),
                                     amplitude(eta * cos_i, cos_film)};
    Rgb sum;
    for (int c = 0; c < 3; ++c) {
        // The index of the surface that reflects `base`
        constexpr float kMost = 0.9999f;
        const float root = std::sqrt(std::clamp(base[c], 0.0f, kMost));
        const float n = (1 + root) / (1 - root), cos_base = std::sqrt(1 - sin2 / sqr(n));
        const std::array<float, 2> second{amplitude(eta * cos_film, n * cos_base),
                                          amplitude(n * cos_film, eta * cos_base)};
        for (size_t polarisation = 0; polarisation < 2; ++polarisation) {
            // A round within the film multiplies the amplitude by q, and turns it by the path
            const float reflected = sqr(first[polarisation]), through = 1 - reflected;
            if (!(through > 0)) {  // rounded to a mirror: the sum has no value
                sum[c] += 0.5f;
                continue;
            }
            const float q = -first[polarisation] * second[polarisation];
            const float later = sqr(through * second[polarisation]) / (1 - sqr(q));
            const float interference =
                2 * (later - through) * q * (cosine[0][c] + q * cosine[1][c]);
            sum[c] += 0.5f * (reflected + later + interference);
        }
    }
    return {clamp01(sum.r), clamp01(sum.g), clamp01(sum.b)};
}

}  // namespace covtrace
