// Headers of film files: whatever they say, they are refused, or the film can be used.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>

#include "core/error.h"
#include "film_fixtures.h"
#include "render/describe_state.h"
#include "render/develop.h"
#include "render/film_header.h"
#include "render/merge.h"
#include "render/render_memory.h"

namespace covtrace {
namespace {

using test::random_state;

TEST(FilmHeader, LyingHeadersAllocateNothing) {
    RenderState s = random_state(Method::hybrid, Stage::pilot, true, {0, 0, 3, 2});
    s.region = {0, 0, 1 << 24, 1 << 24};
    const std::string huge = film_header(s);
    try {
        parse_film_header(huge, size_t{1} << 34);
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::limit);
    }
}

TEST(FilmHeader, KeepsTheRuleOfTheFilters) {
    for (const FilterRule rule :
         {FilterRule::verified, FilterRule::predicted, FilterRule::matched, FilterRule::thesis}) {
        RenderState s = random_state(Method::covariance, Stage::rounds, false, {0, 0, 3, 2});
        s.filter = rule;
        // Both formats have the same arrays of this method.
        for (uint32_t format = kOldestFilmFormat; format <= kFilmFormat; ++format)
            EXPECT_EQ(parse_film_header(film_header(s), size_t{1} << 30, format).filter, rule);
    }
}

/// Uses a film that was read in every way in which the program does.
void use(RenderState state) {
    EXPECT_NE(describe(state), "");
    EXPECT_EQ(develop(state).pixel_count(), state.pixels());
    FilmMerge merge;
    merge.add("a", state);
    EXPECT_THROW(merge.add("b", state), Error);
    EXPECT_NE(describe(std::move(merge).result()), "");
}

/// Headers with random changes, their checksums right, are refused or read, with no other error,
/// and states that are read can be used.
TEST(FilmHeader, ChangedHeadersAreRefused) {
    const std::string pieces[] = {"-1",
                                  "1e999",
                                  "null",
                                  "[]",
                                  "{}",
                                  "\"\"",
                                  "true",
                                  "0.5",
                                  "9e18",
                                  "[[[[",
                                  "\xff",
                                  "",
                                  "18446744073709551616",
                                  "\"rounds\""};
    std::mt19937 random(3);
    const auto below = [&](size_t n) {
        return std::uniform_int_distribution<size_t>(0, n - 1)(random);
    };
    for (Method method : {Method::uniform, Method::covariance, Method::hybrid}) {
        const std::string good =
            film_header(random_state(method, Stage::rounds, true, {0, 0, 3, 2}));
        int refused = 0;
        for (int i = 0; i < 5000; ++i) {
            std::string text = good;
            const size_t at = below(text.size());
            text.replace(at, below(12), pieces[below(std::size(pieces))]);
            try {
                use(parse_film_header(text, 1 << 20));
            } catch (const Error&) {
                ++refused;
            }
        }
        EXPECT_GT(refused, 2500);
    }
}

/// Well-formed headers that contradict themselves.
TEST(FilmHeader, LyingHeadersAreRefused) {
    const auto refused = [](Method method, Stage stage, const std::string& from,
                            const std::string& to) {
        std::string text = film_header(random_state(method, stage, true, {0, 0, 3, 2}));
        const size_t at = text.find(from);
        ASSERT_NE(at, std::string::npos) << from;
        text.replace(at, from.size(), to);
        EXPECT_THROW(parse_film_header(text, 1 << 20), Error) << to;
    };
    const std::string present = "\"present\": [\n  1,\n  3\n ]";
    for (const char* wrong : {"[]", "[1,1]", "[3,1]", "[-1,1]", "[1,5]"})
        refused(Method::uniform, Stage::rounds, present, std::string("\"present\": ") + wrong);
    refused(Method::uniform, Stage::rounds, "\"shards\": 5", "\"shards\": 1");
    // The first number would be 5 again if cut to 32 bits.
    for (const char* wrong : {"4294967301", "-4294967291", "5.0", "1e70", "true", "\"5\""})
        refused(Method::uniform, Stage::rounds, "\"shards\": 5",
                std::string("\"shards\": ") + wrong);
    refused(Method::uniform, Stage::rounds, "\"rounds\"", "\"first_paths\"");
    refused(Method::uniform, Stage::rounds, "\"rounds\"", "\"pilot\"");
    refused(Method::hybrid, Stage::rounds, "\"rounds\"", "\"pilot\"");
    refused(Method::hybrid, Stage::pilot, "\"pilot\"", "\"rounds\"");
    refused(Method::covariance, Stage::rounds, "\"scattered\"", "\"all\"");
    refused(Method::uniform, Stage::rounds, "\"uniform\"", "\"covariance\"");
}

/// Films of one identity with other pixels or other arrays don't join.
TEST(FilmMerge, OtherArraysAreNotMerged) {
    const auto part = [](Method method, PixelBounds region, std::vector<int> present) {
        RenderState s = random_state(method, Stage::rounds, true, region);
        s.present = std::move(present);
        return s;
    };
    const PixelBounds region{0, 0, 40, 20};
    RenderState with_emitters = part(Method::uniform, region, {0});
    with_emitters.films[0].in_view.resize(with_emitters.pixels());
    for (RenderState other : {part(Method::uniform, {0, 0, 40, 19}, {0}),
                              part(Method::covariance, region, {0}), with_emitters}) {
        FilmMerge merge;
        merge.add("a", part(Method::uniform, region, {1}));
        EXPECT_THROW(merge.add("b", std::move(other)), Error);
    }
}

/// Bytes per pixel: at most 64 for `uniform`, 160 for `covariance`, 320 for `hybrid`.
TEST(BytesPerPixel, AreAsTheRecordsSay) {
    EXPECT_EQ(sizeof(FilmPixel), 60u);
    EXPECT_EQ(sizeof(PathFeatures), 28u);
    EXPECT_EQ(sizeof(FeatureSquares), 20u);
    EXPECT_EQ(sizeof(FirstSurface), 52u);
    EXPECT_EQ(sizeof(PackedCovariance), 40u);
    const std::pair<Method, size_t> expected[] = {
        {Method::uniform, 64}, {Method::covariance, 160}, {Method::hybrid, 312}};
    for (const auto& [method, most] : expected) {
        EXPECT_EQ(film_bytes_per_pixel(method), most);
        size_t largest = 0;
        for (Stage stage : {Stage::first_paths, Stage::pilot, Stage::rounds}) {
            if (method == Method::uniform && stage != Stage::rounds) continue;
            const RenderState s = random_state(method, stage, true, {0, 0, 20, 10});
            size_t bytes = 0;
            for (const auto& [name, count] : s.memory()) bytes += count;
            largest = std::max(largest, bytes / s.pixels());
        }
        EXPECT_EQ(largest, most) << name_of(method);
    }
    EXPECT_EQ(film_bytes_per_pixel(Method::uniform, {.in_view = true}), 76u);
    EXPECT_EQ(film_bytes_per_pixel(Method::uniform, {.features = true}), 116u);
    for (const Method method : {Method::uniform, Method::covariance, Method::hybrid})
        EXPECT_EQ(film_bytes_per_pixel(method, {.surfaces = true}),
                  film_bytes_per_pixel(method) + (method == Method::hybrid ? 2 : 1) * 52u);
    for (const Method method : {Method::uniform, Method::covariance, Method::hybrid}) {
        const FilmParts plain = film_parts(method);
        FilmParts more = plain;
        more.opacity = true;
        const size_t added = Film({0, 0, 4, 3}, more).memory() - Film({0, 0, 4, 3}, plain).memory();
        EXPECT_EQ(added, 4u * 12);
        EXPECT_EQ(film_bytes_per_pixel(method, more),
                  film_bytes_per_pixel(method, plain) + (method == Method::hybrid ? 2 : 1) * 4u);
    }
}

}  // namespace
}  // namespace covtrace
