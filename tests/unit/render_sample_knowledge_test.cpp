// The planner's knowledge from a film: brightness, the variance of one sample, and its cost.
#include "render/sample_knowledge.h"

#include <gtest/gtest.h>

namespace covtrace {
namespace {

FilmSample sample(float radiance, uint32_t rays) {
    FilmSample s;
    s.radiance = {radiance, radiance, radiance};
    s.rays = rays;
    return s;
}

TEST(SampleKnowledge, IsOfOneSample) {
    Film film({0, 0, 2, 1}, {false, true});
    for (const float v : {1.0f, 3.0f}) film.add(0, sample(v, 5));
    film.add(1, sample(7, 2));
    const SampleKnowledge known = knowledge_from(film, {});
    EXPECT_FLOAT_EQ(known.brightness[0], 2);
    EXPECT_FLOAT_EQ(known.variance[0], 2);  // (1 + 1) / (2 - 1)
    EXPECT_FLOAT_EQ(known.cost[0], 5);
    EXPECT_FLOAT_EQ(known.brightness[1], 7);
    EXPECT_FLOAT_EQ(known.variance[1], 0);  // one sample tells nothing of its variance
    EXPECT_FLOAT_EQ(known.cost[1], 2);
}

TEST(SampleKnowledge, SamplesCostTheSameWhereRaysAreNotCounted) {
    Film film({0, 0, 2, 1});
    film.add(0, sample(1, 9));
    const SampleKnowledge known = knowledge_from(film, {});
    EXPECT_EQ(known.cost[0], known.cost[1]);
}

}  // namespace
}  // namespace covtrace
