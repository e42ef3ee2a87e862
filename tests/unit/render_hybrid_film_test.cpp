// What the reconstruction is told of films.
#include "render/hybrid_film.h"

#include <gtest/gtest.h>

#include "render/render_state.h"

namespace covtrace {
namespace {

TEST(HybridFilm, OneSamplePerPixelOfWhatIsEvenHasNoNoise) {
    // As with --spp 1: every pixel is known to one of the halves, in turn.
    constexpr int kSize = 24;
    std::vector<Film> films(2, Film({0, 0, kSize, kSize}, film_parts(Method::hybrid)));
    FilmSample sample;
    sample.radiance = sample.albedo = Rgb(0.8f, 0.5f, 0.2f);
    sample.normal = {0, 0.6f, 0.8f};
    sample.hit = true;
    sample.depth = 7;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x)
            films[size_t(x + y) % 2].add(size_t(y) * kSize + size_t(x), sample);
    for (const HalfBuffer& half : halves_of(films)) {
        for (const Plane& variance : half.color_variance)
            for (float v : variance.values) ASSERT_NEAR(v, 0, 1e-9);
        for (const Plane& variance : half.feature_variance)
            for (float v : variance.values) ASSERT_NEAR(v, 0, 1e-9);
    }
}

}  // namespace
}  // namespace covtrace
