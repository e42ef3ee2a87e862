/// Rough glass and panes under films give back all light, of each colour, from either side.
#include "bsdf/film_table.h"

#include <gtest/gtest.h>

#include "bsdf/models.h"
#include "bsdf/multiple_scattering.h"
#include "core/memory_limit.h"
#include "core/rng.h"

namespace covtrace {
namespace {

constexpr float kCosines[] = {0.02f, 0.1f, 0.3f, 0.5f, 0.8f, 1};

/// The tables of glass of one index.
struct Glass {
    float eta;
    CoatTable from_outside{eta, 0}, from_inside{1 / eta, 0};
    FilmKernel kernel{eta};
};
const Glass& glass(float eta) {
    static const Glass crown{1.5f}, diamond{2.4f};
    return eta == 1.5f ? crown : diamond;
}

DielectricBsdf filmed(const Glass& g, const FilmTable& table, const ThinFilm& film, Vec2 alpha) {
    DielectricBsdf b{g.eta, alpha.x, alpha.y};
    b.film = film;
    return with_multiple_scattering(b, g.from_outside, g.from_inside, &table);
}

Vec3 towards(float cos_theta) {
    const float r = std::sqrt(1 - cos_theta * cos_theta);
    return {r * 0.8f, r * 0.6f, cos_theta};
}

/// Energy that leaves for a unit of light along wo, by colour: a quadrature at the points of an
/// additive sequence in three dimensions, the powers of a root of x^4 = x + 1, good to 0.003.
Rgb furnace(const Bsdf& bsdf, Vec3 wo) {
    constexpr int kPoints = 6000;
    constexpr std::array<double, 3> kSteps{0.8191725133961645, 0.6710436067037893,
                                           0.5497004779019703};
    std::array<double, 3> sum{};
    for (int i = 1; i <= kPoints; ++i) {
        const auto u = [&](size_t d) {
            return static_cast<float>(std::fmod(0.5 + i * kSteps[d], 1.0)) * 0x1.fffffep-1f;
        };
        const auto s = sample(bsdf, wo, u(0), {u(1), u(2)});
        for (int c = 0; s && c < 3; ++c)
            sum[static_cast<size_t>(c)] += double(s->weight[c] * sqr(s->eta)) / kPoints;
    }
    return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
}

void expect_all_returns(const Bsdf& bsdf, float tolerance) {
    for (const float cosine : kCosines)
        for (const float side : {1.0f, -1.0f}) {
            const Rgb kept = furnace(bsdf, towards(side * cosine));
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(kept[c], 1, tolerance) << side * cosine << ", channel " << c;
        }
}

TEST(FilmTable, GlassUnderAFilmLosesNothingFromEitherSide) {
    for (const float eta : {1.5f, 2.4f})
        for (const float film_eta : {1.22f, 1.6f, 2.5f})
            for (const float thickness : {100.0f, 220.0f, 380.0f, 600.0f}) {
                const ThinFilm film{1, film_eta, thickness};
                const FilmTable table(glass(eta).kernel, film_eta, thickness);
                for (const float alpha : {0.1f, 0.25f, 0.5f, 1.0f}) {
                    SCOPED_TRACE(testing::Message() << thickness << " nm, index " << film_eta
                                                    << " on " << eta << ", alpha " << alpha);
                    expect_all_returns(filmed(glass(eta), table, film, {alpha, alpha}), 0.015f);
                }
            }
}

TEST(FilmTable, AFilmThatCoversAPartOfTheGlassLosesNothing) {
    const FilmTable table(glass(1.5f).kernel, 2.5f, 150);
    expect_all_returns(filmed(glass(1.5f), table, {0.4f, 2.5f, 150}, {0.8f, 0.8f}), 0.015f);
}

// The tables are those of a mean roughness, of which brushed glass is as far without a film.
TEST(FilmTable, BrushedGlassUnderAFilmKeepsWhatItKeepsWithout) {
    const Glass& g = glass(1.5f);
    const FilmTable table(g.kernel, 1.8f, 300);
    const Bsdf bare = with_multiple_scattering(DielectricBsdf{1.5f, 0.1f, 0.5f}, g.from_outside,
                                               g.from_inside),
               covered = filmed(g, table, {1, 1.8f, 300}, {0.1f, 0.5f});
    for (const float cosine : kCosines)
        for (const Vec3 wo : {towards(cosine), towards(-cosine)}) {
            const Rgb expected = furnace(bare, wo), kept = furnace(covered, wo);
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(kept[c], expected[c], 0.04f) << wo.z;
        }
}

// A pane's facets mask what passes as they mask what they reflect: no film changes that.
TEST(FilmTable, RoughPanesUnderAFilmLoseNothing) {
    static const CoatTable white(kWhiteIndex, 0);
    ThinDielectricBsdf pane{1.5f, Rgb(1), 0.8f, 0.8f};
    pane.film = {1, 2.5f, 150};
    expect_all_returns(with_multiple_scattering(pane, white), 0.01f);
}

TEST(FilmTable, OfAllThicknessesIsThatOfEach) {
    for (const float film_eta : {0.75f, 1.22f, 2.5f}) {
        const FilmTable all(glass(1.5f).kernel, film_eta, {});
        for (const float thickness :
             {0.0f, 0.03f, 1.0f, 17.0f, 95.0f, 143.0f, 388.0f, 1111.0f, 3900.0f, 2e4f}) {
            const FilmTable one(glass(1.5f).kernel, film_eta, thickness);
            for (const float cosine : kCosines)
                for (const bool inside : {false, true})
                    for (const float row : {0.0f, 11.3f, 23.0f}) {
                        const Rgb a = all.kept(inside, row, cosine, thickness),
                                  b = one.kept(inside, row, cosine, thickness);
                        for (int c = 0; c < 3; ++c)
                            // A film in denser surroundings has its colours at grazing angles
                            // wherever the table ends.
                            EXPECT_NEAR(a[c], b[c],
                                        film_eta < 1 && thickness > 1e4f ? 0.01f : 2e-3f)
                                << thickness << " nm of " << film_eta << ", cosine " << cosine;
                    }
        }
    }
}

TEST(FilmTable, GainIsTheSameForAllDirectionsOfLight) {
    const FilmTable table(glass(1.5f).kernel, 2.5f, 150);
    DielectricBsdf once{1.5f, 0.6f, 0.6f};
    once.film = {1, 2.5f, 150};
    const Bsdf all = filmed(glass(1.5f), table, once.film, {0.6f, 0.6f});
    for (const float cosine : {-0.8f, -0.2f, 0.3f, 0.9f}) {
        const Vec3 wo = towards(cosine);
        Rng rng(5);
        std::optional<Rgb> gain;
        for (int i = 0; i < 200; ++i) {
            const auto s = sample(all, wo, rng.next_float(), rng.next_2d());
            if (!s) continue;
            EXPECT_EQ(pdf(all, wo, s->wi), pdf(once, wo, s->wi));
            const Rgb without = eval(once, wo, s->wi);
            // Where interference leaves a colour nothing, there is no ratio to tell.
            if (!(std::min({without.r, without.g, without.b}) > 1e-5f)) continue;
            const Rgb ratio = eval(all, wo, s->wi) / without;
            if (!gain) gain = ratio;
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(ratio[c], (*gain)[c], 1e-3f);
        }
        ASSERT_TRUE(gain);
        EXPECT_GT(std::min({gain->r, gain->g, gain->b}), 1.01f);
        EXPECT_GT(max_component(*gain) / std::min({gain->r, gain->g, gain->b}), 1.01f);
    }
}

TEST(FilmTable, EqualFilmsOnEqualGlassShareOne) {
    FilmTables tables;
    const FilmTable& a = tables.get(1.5f, 1.3f, 400);
    EXPECT_EQ(&a, &tables.get(1.5f, 1.3f, 400));
    EXPECT_NE(&a, &tables.get(1.5f, 1.3f, 401));
    EXPECT_NE(&a, &tables.get(1.6f, 1.3f, 400));
    EXPECT_NE(&a, &tables.get(1.5f, 1.4f, 400));
    EXPECT_NE(&a, &tables.get(1.5f, 1.3f, {}));
}

TEST(FilmTable, OfAllThicknessesIsRefusedWhereThereIsNoMemory) {
    const FilmKernel& kernel = glass(1.5f).kernel;
    const MemoryLimit limit(1 << 20);
    EXPECT_THROW(FilmTable(kernel, 1.3f, {}), Error);
    EXPECT_NO_THROW(FilmTable(kernel, 1.3f, 400));
}

}  // namespace
}  // namespace covtrace
