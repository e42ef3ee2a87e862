#include "integrator/guides/sky_guide.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "integrator/lit_scene.h"

namespace covtrace {

namespace {

/// Paths of a trial: as many as an eighth of the pixels, within a limit. The trial is repeated
/// where it shows little of the sky.
constexpr int64_t kTrialPixels = 8, kMostTrialPaths = 2048;
constexpr int kTrialLooks = 4, kMostTrials = 4;
/// Paths of the lesson, which follows where the trial tells that it pays.
constexpr int64_t kLessonPixels = 2, kMostLessonPaths = 65536;
constexpr int kLessonLooks = 8;
/// The guide pays where it takes the second moment of sky light that is sampled, by BSDFs and by
/// lights together, below this share.
constexpr double kWorthwhile = 0.92;

constexpr size_t kFewestSights = 32;   // in all: a guide is not made of less
constexpr size_t kEnoughSights = 512;  // for a trial
constexpr size_t kCellSights = 96;     // sights of a cell
constexpr double kBlur = 0.15;         // weight of each neighbour of a block beside its own
constexpr double kPriorSights = 16;    // sights of all cells that count in a cell's share
constexpr std::array<float, 4> kShares{0, 0.5f, 0.8f, 0.95f};

/// Second moments of light found by BSDFs and lights together, by the guide's share of the sky's
/// samples: of directions that were tried with a density q, the mean of f^2 / (p q), with f the
/// light and p the density of both ways together. Surfaces count as diffuse.
struct Moments {
    std::array<double, kShares.size()> sum{};
    size_t count = 0;

    void add(const SkySight& sight, Vec3 normal) {
        ++count;
        const float by_bsdf = dot(normal, sight.direction) * kInvPi;
        for (size_t i = 0; i < kShares.size(); ++i) {
            const float by_lights = std::lerp(sight.lights_pdf, sight.guide_pdf, kShares[i]);
            sum[i] += double(sight.light) * double(sight.light) /
                      (double(sight.tried_pdf) * double(by_lights + by_bsdf));
        }
    }
    void add(const Moments& other) {
        count += other.count;
        for (size_t i = 0; i < kShares.size(); ++i) sum[i] += other.sum[i];
    }
    size_t best() const {
        return static_cast<size_t>(std::min_element(sum.begin(), sum.end()) - sum.begin());
    }
};

/// The moments of those sights that know of a guide.
template <typename Indices>
Moments moments(std::span<const SkySight> sights, const Indices& indices) {
    Moments m;
    for (const auto i : indices)
        if (sights[i].guide_pdf > 0) m.add(sights[i], sights[i].place.normal);
    return m;
}

/// The weights of a cell's blocks: samples are best spread by the root of the mean square of the
/// light, which is blurred, as windows seen from different places of a cell are beside each other.
std::array<double, SkyCell::kBlocks> block_weights(std::span<const SkySight> sights,
                                                   std::span<const uint32_t> part) {
    constexpr int n = int(SkyCell::kSide);
    std::array<double, SkyCell::kBlocks> squares{}, weights{};
    for (uint32_t i : part)
        squares[SkyCell::block(sights[i].direction)] +=
            double(sights[i].light) * double(sights[i].light) / double(sights[i].tried_pdf);
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            double sum = 0;
            for (int j = std::max(y - 1, 0); j <= std::min(y + 1, n - 1); ++j)
                for (int i = std::max(x - 1, 0); i <= std::min(x + 1, n - 1); ++i)
                    sum += squares[size_t(j * n + i)] * (i == x && j == y ? 1 : kBlur);
            weights[size_t(y * n + x)] = std::sqrt(sum);
        }
    return weights;
}

}  // namespace

SkyGuide::SkyGuide(const LitScene& scene) {
    if (!scene.lights.has_sky()) return;
    const FilmDescription& film = scene.description.film;
    const int64_t pixels = int64_t(film.width) * int64_t(film.height);
    const int64_t trial = std::clamp(pixels / kTrialPixels, int64_t(1), kMostTrialPaths);
    // Learn from a few paths, and measure on a few others whether it pays
    std::vector<SkySight> sights, more;
    int64_t paths = 0;
    for (int i = 0; i < kMostTrials && sights.size() < kEnoughSights; ++i, paths += trial) {
        more = look_for_sky(scene, *this, paths, trial, kTrialLooks);
        sights.insert(sights.end(), more.begin(), more.end());
    }
    if (sights.size() < kFewestSights) return;
    learn(sights);
    more = look_for_sky(scene, *this, paths, trial, kTrialLooks);
    std::vector<uint32_t> all(more.size());
    std::iota(all.begin(), all.end(), 0u);
    const Moments m = moments(more, all);
    outcome_.second_moment = m.sum[0] > 0 ? m.sum[m.best()] / m.sum[0] : 1;
    if (!(outcome_.second_moment < kWorthwhile)) {
        tree_ = {};
        cells_ = {};
        outcome_.state = GuideState::gave_up;
        return;
    }
    // Learn in earnest, from places and directions that matter
    sights.insert(sights.end(), more.begin(), more.end());
    learn(sights);
    const int64_t lesson = std::clamp(pixels / kLessonPixels, int64_t(1), kMostLessonPaths);
    more = look_for_sky(scene, *this, paths + trial, lesson, kLessonLooks);
    sights.insert(sights.end(), more.begin(), more.end());
    learn(sights);
    outcome_.state = GuideState::guides;
    outcome_.bytes = tree_.memory() + cells_.capacity() * sizeof(SkyCell);
}

void SkyGuide::learn(std::span<const SkySight> sights) {
    std::vector<PlaceTree::Place> places;
    places.reserve(sights.size());
    for (const SkySight& sight : sights) places.push_back(sight.place);
    std::vector<uint32_t> order;
    std::vector<PlaceTree::Part> parts;
    tree_ = PlaceTree(places, kCellSights, order, parts);
    cells_.assign(parts.size(), {});
    std::vector<Moments> of_cell(parts.size());
    parallel_for(int64_t(parts.size()), [&](int64_t i) {
        const auto k = static_cast<size_t>(i);
        cells_[k].set_weights(block_weights(sights, parts[k]));
        of_cell[k] = moments(sights, parts[k]);
    });
    // Choose each cell's share, by what all cells tell where its own sights are few
    Moments all;
    for (const Moments& m : of_cell) all.add(m);
    for (size_t k = 0; k < cells_.size(); ++k) {
        if (all.count == 0) {
            cells_[k].share = kShares.back();
            continue;
        }
        Moments m = of_cell[k];
        const double own = m.count > 0 ? m.sum[0] / double(m.count) : 1.0;
        for (size_t i = 0; i < kShares.size(); ++i)
            m.sum[i] += kPriorSights * own * all.sum[i] / all.sum[0];
        cells_[k].share = kShares[m.best()];
    }
}

}  // namespace covtrace
