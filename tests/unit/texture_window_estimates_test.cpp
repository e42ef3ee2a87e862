#include "texture/window_estimates.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstring>
#include <deque>

#include "core/parallel.h"
#include "core/rng.h"
#include "texture/image_spectrum.h"

namespace covtrace {
namespace {

ScalarField noise(int width, int height, bool repeat_x, bool repeat_y, uint64_t seed) {
    ScalarField f(width, height, repeat_x, repeat_y);
    Rng rng(seed);
    for (float& v : f.values) v = rng.next_float() - 0.5f;
    return f;
}

/// A field and two coarser ones, with the estimates of all three.
struct Levels {
    std::deque<ScalarField> values;
    std::deque<WindowEstimates> estimates;

    explicit Levels(const ScalarField& finest) {
        std::deque<ScalarField> squares{finest};
        for (float& v : squares[0].values) v *= v;
        values.push_back(finest);
        for (int i = 1; i < 3; ++i) {
            values.push_back(halved(values.back()));
            squares.push_back(halved(squares.back()));
        }
        squares[0] = {};
        const WindowEstimates* coarser = nullptr;
        for (size_t i = 3; i-- > 0;)
            coarser = &estimates.emplace_front(
                values[i], squares[i], float(1 << i), 0.5f,
                i == 0 ? std::vector<float>{2, 1} : std::vector<float>{2}, coarser);
    }
};

RC_GTEST_PROP(WindowEstimates, SaysTheSameOfAPartAsOfAll, ()) {
    const int width = *rc::gen::inRange(1, 200), height = *rc::gen::inRange(1, 200);
    const bool repeat_x = *rc::gen::arbitrary<bool>(), repeat_y = *rc::gen::arbitrary<bool>();
    const ScalarField f = noise(width, height, repeat_x, repeat_y, *rc::gen::arbitrary<uint64_t>());
    const Levels levels(f);
    const auto all = levels.estimates[0].of({0, 0, width, height});
    const int x0 = *rc::gen::inRange(0, width), y0 = *rc::gen::inRange(0, height);
    const CellRect part{x0, y0, *rc::gen::inRange(x0 + 1, width + 1),
                        *rc::gen::inRange(y0 + 1, height + 1)};
    const auto some = Levels(f).estimates[0].of(part);
    for (int y = part.y0; y < part.y1; ++y)
        RC_ASSERT(std::memcmp(&some[size_t(y - part.y0) * size_t(part.width())],
                              &all[size_t(y) * size_t(width) + size_t(part.x0)],
                              size_t(part.width()) * sizeof(WindowEstimate)) == 0);
}

TEST(WindowEstimates, CanBeAskedForByManyThreads) {
    const ScalarField f = noise(300, 260, true, true, 7);
    const auto ask = [&f](int threads) {
        const ThreadLimit limit(threads);
        const ImageSpectrum s(f.values, f.width, f.height, ImageSpectrum::Wrap::repeat);
        std::vector<SpatialCovariance2> found(2000);
        parallel_for(int64_t(found.size()), [&](int64_t i) {
            // The places are all over the image, at the finest and at blends of coarser
            // resolutions.
            const float u = 0.618034f * float(i), texels = 1 + 0.01f * float(i % 500);
            found[size_t(i)] = s.at(u, 0.0731f * float(i), {texels / 300, texels / 260});
        });
        return found;
    };
    const auto one = ask(1), four = ask(4);
    EXPECT_EQ(std::memcmp(one.data(), four.data(), one.size() * sizeof(one[0])), 0);
}

}  // namespace
}  // namespace covtrace
