// Films as the reconstruction sees them.
#include "render/hybrid_film.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/sampler.h"

#include "render/render_state.h"

namespace covtrace {
namespace {

constexpr int kSize = 24;

/// Films of both halves without samples.
std::vector<Film> empty_films() {
    return std::vector<Film>(2, Film({0, 0, kSize, kSize}, film_parts(Method::hybrid)));
}

FilmSample grey_sample(float radiance) {
    FilmSample sample;
    sample.radiance = sample.features.albedo = Rgb(radiance);
    sample.features.normal = {0, 0.6f, 0.8f};
    sample.hit = true;
    sample.depth = sample.features.depth = 7;
    return sample;
}

TEST(HybridFilm, OneSamplePerPixelOfWhatIsEvenHasNoNoise) {
    // The films are as with --spp 1: the first half knows all pixels.
    std::vector<Film> films = empty_films();
    for (size_t i = 0; i < size_t(kSize * kSize); ++i) films[0].add(i, grey_sample(0.8f));
    for (const HalfBuffer& half : halves_of(films)) {
        for (const Plane& variance : half.color_variance)
            for (float v : variance.values) ASSERT_NEAR(v, 0, 1e-9);
        for (const Plane& variance : half.feature_variance)
            for (float v : variance.values) ASSERT_NEAR(v, 0, 1e-9);
    }
}

TEST(HybridFilm, PixelsOfTheFirstHalfAloneAreDealtToBoth) {
    // Each pixel has samples of 0 and of 1, as with --spp 2.
    std::vector<Film> films = empty_films();
    for (size_t i = 0; i < size_t(kSize * kSize); ++i)
        for (const float radiance : {0.0f, 1.0f}) films[0].add(i, grey_sample(radiance));
    const Halves halves = halves_of(films);
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            const size_t owner = size_t(x + y) % 2;
            EXPECT_EQ(halves[owner].count(x, y), 2);
            EXPECT_EQ(halves[1 - owner].count(x, y), 0);
            EXPECT_EQ(halves[owner].color[0](x, y), 0.5f);
            // The samples of a pixel tell its noise, not what it differs by from its neighbours
            EXPECT_NEAR(halves[owner].color_variance[0](x, y), 0.25f, 1e-5);
        }
}

TEST(HybridFilm, PixelsOfTheFirstHalfAreDealtWhateverTheyAre) {
    // Every second pixel of an odd width has a sample, as with --spp 0.5, or all of the first half
    // and few of the second, as with a little more than 2: neither half is left with few pixels.
    const PixelBounds bounds{0, 0, kSize + 1, kSize};
    const size_t pixels = size_t(kSize + 1) * kSize;
    for (const bool all : {false, true}) {
        std::vector<Film> films(2, Film(bounds, film_parts(Method::hybrid)));
        for (size_t i = 0; i < pixels; i += all ? 1 : 2) films[0].add(i, grey_sample(0.8f));
        if (all) films[1].add(100, grey_sample(0.8f));
        double seen = 0;
        for (const HalfBuffer& half : halves_of(films)) {
            const auto& count = half.count.values;
            const auto known =
                std::count_if(count.begin(), count.end(), [](float c) { return c > 0; });
            EXPECT_NEAR(double(known), (all ? 0.5 : 0.25) * double(pixels), 0.05 * double(pixels));
            seen += double(known);
        }
        EXPECT_EQ(seen, all ? double(pixels) + 1 : double(pixels / 2));
    }
}

TEST(HybridSeed, IsTheOneThatMeasurementsTakeForTheSameSamples) {
    EXPECT_EQ(hybrid_seed(1), 15899793147604821525u);  // as bench/quality/same_samples.py has it
    EXPECT_EQ(hybrid_seed(2), 2246501998551543546u);
}

TEST(PlaceInSequence, BothHalvesTogetherHaveTheFirstSamples) {
    for (uint32_t each = 2; each <= 1024; each *= 2) {
        std::set<uint32_t> places;
        for (uint32_t half = 0; half < 2; ++half)
            for (uint32_t i = 0; i < each; ++i) places.insert(place_in_sequence(half, i));
        EXPECT_EQ(places.size(), 2 * each);
        EXPECT_EQ(*places.rbegin(), 2 * each - 1);
    }
}

TEST(PlaceInSequence, TheMeanOfBothHalvesIsAsEvenAsOneSequence) {
    // The errors are squared ones of the mean of x + y over the film, of 1000 pixels: of both
    // halves, and of halves with seeds of their own.
    double together = 0, apart = 0;
    for (int pixel = 0; pixel < 1000; ++pixel) {
        double sum = 0, own = 0;
        for (uint32_t half = 0; half < 2; ++half)
            for (uint32_t i = 0; i < 8; ++i) {
                const Vec2 a = Sampler(5, pixel, 7, place_in_sequence(half, i)).film(),
                           b = Sampler(5 + half, pixel, 7, i).film();
                sum += double(a.x + a.y) - 1;
                own += double(b.x + b.y) - 1;
            }
        together += sum * sum;
        apart += own * own;
    }
    EXPECT_LT(together, 0.5 * apart);
}

}  // namespace
}  // namespace covtrace
