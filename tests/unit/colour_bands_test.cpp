/// Colours of products of spectra in bands, against sums over wavelengths.
#include "colour/colour_bands.h"

#include <gtest/gtest.h>

#include <cmath>

#include "colour/sigmoid_spectrum.h"
#include "core/rng.h"

namespace covtrace::test {
namespace {

constexpr Rgb kCandle{1, 0.3f, 0.05f};

float largest_difference(Rgb a, Rgb b) {
    return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

Rgb random_colour(Rng& rng) {
    Rgb c{rng.next_float(), rng.next_float(), rng.next_float()};
    if (rng.next_float() < 0.5f) c = c * c;
    return c;
}

/// Colour of a^i b^j at each wavelength, brought into [0, 1].
Rgb colour_of_product(Rgb a, int i, Rgb b, int j) {
    const SigmoidSpectrum first = sigmoid_spectrum(a), second = sigmoid_spectrum(b);
    std::array<double, 3> sum{};
    for (const ObserverSample& sample : observer_samples()) {
        const double value =
            std::pow(first.at(sample.wavelength), i) * std::pow(second.at(sample.wavelength), j);
        for (size_t c = 0; c < 3; ++c) sum[c] += value * sample.weight[c];
    }
    for (double& c : sum) c = std::min(std::max(c, 0.0), 1.0);
    return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
}

Rgb colour_in_bands(const ColourBands& bands, Rgb a, int i, Rgb b, int j) {
    const BandValues first = band_values(a), second = band_values(b);
    BandValues product;
    for (size_t k = 0; k < product.size(); ++k)
        product[k] =
            std::pow(first[k], static_cast<float>(i)) * std::pow(second[k], static_cast<float>(j));
    return bands.colour(product);
}

TEST(ColourBands, ProductsAreThoseOfSpectra) {
    const ColourBands bands;
    Rng rng(7);
    float largest = 0;
    for (int k = 0; k < 300; ++k) {
        const Rgb a = random_colour(rng), b = random_colour(rng);
        for (const int i : {1, 2, 4, 8})
            for (const int j : {0, 1, 3})
                largest = std::max(largest, largest_difference(colour_in_bands(bands, a, i, b, j),
                                                               colour_of_product(a, i, b, j)));
    }
    std::printf("largest difference %.4f\n", double(largest));
    EXPECT_LT(largest, 0.025f);
}

TEST(ColourBands, AReflectanceIsItsColour) {
    for (const auto& [light, tolerance] : {std::pair{Rgb(1), 3e-3f}, {kCandle, 0.03f}}) {
        const IlluminantAdaptation adaptation(light);
        const ColourBands bands(adaptation);
        Rng rng(8);
        for (int k = 0; k < 100; ++k) {
            const Rgb c = Rgb(0.02f) + 0.96f * random_colour(rng);
            EXPECT_LT(largest_difference(bands.colour(band_values(c)), adaptation(c)), tolerance)
                << c.r << " " << c.g << " " << c.b;
        }
    }
}

TEST(ColourBands, GreysAreExact) {
    const ColourBands bands{IlluminantAdaptation(kCandle)};
    for (const float grey : {0.0f, 0.3f, 1.0f}) {
        const Rgb c = bands.colour(band_values(Rgb(grey)));
        EXPECT_LT(largest_difference(c, Rgb(grey)), 1e-6f);
    }
    EXPECT_EQ(band_values(Rgb(NAN, NAN, NAN))[3], 0);
}

}  // namespace
}  // namespace covtrace::test
