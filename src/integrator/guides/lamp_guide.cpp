#include "integrator/guides/lamp_guide.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "integrator/lit_scene.h"

namespace covtrace {

namespace {

/// Paths of a trial: as many as an eighth of the pixels, within a limit.
constexpr int64_t kTrialPixels = 8, kMostTrialPaths = 2048;
/// Paths of the lesson, which follows where the trial tells that it pays.
constexpr int64_t kLessonPixels = 4, kMostLessonPaths = 65536;
constexpr int kLooks = 4;  // lamps that are tried at a place
/// The guide pays where it takes the second moment of the lamps' light that BSDFs and lights find
/// together below this share.
constexpr double kWorthwhile = 0.92;

constexpr size_t kFewestTrials = 64;  // in all: a guide is not made of less
/// Trials of a cell: so many for each factor, but not fewer than for few lamps, nor more than for
/// many.
constexpr size_t kTrialsPerFactor = 4, kFewestCellTrials = 64, kMostCellTrials = 2048;
constexpr size_t kRegionCells = 16;  // cells of a region
/// Trials that count in a child's factor as if they had found what its region tells, and for a
/// region what its node's children find in the mean: so many that a lamp by chance not seen is not
/// given up, so few that those behind walls are.
constexpr double kRegionTrials = 4, kPriorTrials = 0.5;
/// How far the factors of a cell are trusted: 0 leaves all to importance.
constexpr std::array<float, 5> kTrusts{0, 0.5f, 0.8f, 0.95f, 1};
constexpr double kSharedTrials = 32;  // trials of all cells that count in a cell's trust

/// Learns the factors of a cell from those of a larger one around it, which may be all 1, and from
/// its own trials. Samples are best spread by the root of the mean square of what each child brings
/// (Rath et al. 2020, "Variance-aware path guiding"); importance foretells it but for a factor,
/// whose mean square is learnt. The larger cell's counts as so many trials as `prior`.
void learn_factors(std::span<const LampTrial> trials, PlaceTree::Part part, double prior,
                   std::span<const float> around, std::span<float> factors) {
    std::vector<double> squares(factors.size()), counts(factors.size());
    for (uint32_t i : part)
        for (const LampTrial::Step& step : trials[i].steps) {
            if (step.child >= factors.size()) continue;
            squares[step.child] += double(step.square);
            ++counts[step.child];
        }
    constexpr size_t n = LightTree::kWidth;
    for (size_t first = 0; first < factors.size(); first += n) {
        // The mean over the node's children is what their factors are relative to
        double sum = 0, count = 0;
        for (size_t i = first; i < first + n; ++i) {
            sum += squares[i];
            count += counts[i];
        }
        const double mean = sum > 0 ? sum / count : 1;
        for (size_t i = first; i < first + n; ++i)
            factors[i] = sum > 0 ? static_cast<float>(std::sqrt(
                                       (squares[i] / mean + prior * double(sqr(around[i]))) /
                                       (counts[i] + prior)))
                                 : around[i];
    }
}

/// Second moment of the light of a trial, as BSDFs and lights find it together, by the choice with
/// the factors.
double moment(const Lights& lights, const LampTrial& t, LightTree::Factors factors) {
    if (!(t.light_found > 0)) return 0;
    const float chosen =
        lights.selection_probability(t.place.position, t.place.normal, t.light, factors);
    return double(t.light_found) * double(t.light_found) /
           (double(t.tried_pdf) * double(chosen * t.place_pdf + t.bsdf_pdf));
}

/// Second moments by how far the factors of a cell are trusted.
struct Moments {
    std::array<double, kTrusts.size()> sum{};
    size_t count = 0;

    void add(const Lights& lights, const LampTrial& trial, LightTree::Factors factors) {
        ++count;
        if (!(trial.light_found > 0)) return;
        std::vector<float> trusted(factors.size());
        for (size_t i = 0; i < kTrusts.size(); ++i) {
            for (size_t k = 0; k < factors.size(); ++k)
                trusted[k] = std::lerp(1.0f, factors[k], kTrusts[i]);
            sum[i] += moment(lights, trial, trusted);
        }
    }
    void add(const Moments& other) {
        count += other.count;
        for (size_t i = 0; i < kTrusts.size(); ++i) sum[i] += other.sum[i];
    }
    /// The best trust, by what all cells tell where a cell's own trials are few.
    float best(const Moments& all) const {
        const double own = sum[0] > 0 ? sum[0] / double(count) : 1;
        std::array<double, kTrusts.size()> m = sum;
        for (size_t i = 0; i < m.size(); ++i) m[i] += kSharedTrials * own * all.sum[i] / all.sum[0];
        return kTrusts[static_cast<size_t>(std::min_element(m.begin(), m.end()) - m.begin())];
    }
};

/// Takes the factors of each cell back as far as they do not hold in trials that they were not
/// learnt from. `cell_at` tells the cell of a trial, whose factors are `n` of all.
template <typename CellAt>
void trust_cells(const Lights& lights, std::span<const LampTrial> trials, const CellAt& cell_at,
                 size_t n, std::span<float> factors) {
    std::vector<std::vector<uint32_t>> parts(factors.size() / n);
    for (size_t i = 0; i < trials.size(); ++i)
        parts[cell_at(trials[i])].push_back(static_cast<uint32_t>(i));
    std::vector<Moments> of_cells(parts.size());
    parallel_for(int64_t(parts.size()), [&](int64_t i) {
        const auto k = static_cast<size_t>(i);
        for (uint32_t t : parts[k]) of_cells[k].add(lights, trials[t], factors.subspan(k * n, n));
    });
    Moments all;
    for (const Moments& m : of_cells) all.add(m);
    if (!(all.sum[0] > 0)) return;
    for (size_t k = 0; k < parts.size(); ++k) {
        const float trust = of_cells[k].best(all);
        for (float& f : factors.subspan(k * n, n)) f = std::lerp(1.0f, f, trust);
    }
}

}  // namespace

LampGuide::LampGuide(const LitScene& scene) {
    factor_count_ = scene.lights.factor_count();
    if (factor_count_ == 0) return;
    const FilmDescription& film = scene.description.film;
    const int64_t pixels = int64_t(film.width) * int64_t(film.height);
    const int64_t trial = std::clamp(pixels / kTrialPixels, int64_t(1), kMostTrialPaths);
    std::vector<LampTrial> trials = try_lamps(scene, 0, trial, kLooks);
    if (trials.size() < kFewestTrials) return;
    // Places that were not learnt from tell how far the cells around them are to be trusted
    const auto trust = [&](std::span<const LampTrial> others) {
        const auto cell_at = [&](const LampTrial& t) {
            return size_t(at(t.place.position, t.place.normal).data() - factors_.data()) /
                   factor_count_;
        };
        trust_cells(scene.lights, others, cell_at, factor_count_, factors_);
    };
    // Learn from a few paths, and measure on a few others whether it pays
    learn(trials);
    std::vector<LampTrial> more = try_lamps(scene, trial, trial, kLooks);
    const size_t half = more.size() / 2;
    trust(std::span(more).first(half));
    outcome_.second_moment = second_moment(scene, std::span(more).subspan(half));
    if (!(outcome_.second_moment < kWorthwhile)) {
        tree_ = {};
        factors_ = {};
        outcome_.state = GuideState::gave_up;
        return;
    }
    // Learn in earnest
    trials.insert(trials.end(), more.begin(), more.end());
    const int64_t lesson = std::clamp(pixels / kLessonPixels, int64_t(1), kMostLessonPaths);
    more = try_lamps(scene, 2 * trial, lesson, kLooks);
    const size_t learnt = more.size() - more.size() / 4;
    trials.insert(trials.end(), more.begin(), more.begin() + std::ptrdiff_t(learnt));
    learn(trials);
    trust(std::span(more).subspan(learnt));
    outcome_.state = GuideState::guides;
    outcome_.bytes = tree_.memory() + factors_.capacity() * sizeof(float);
}

void LampGuide::learn(std::span<const LampTrial> trials) {
    std::vector<PlaceTree::Place> places;
    places.reserve(trials.size());
    for (const LampTrial& trial : trials) places.push_back(trial.place);
    const auto most = [this](size_t per_factor) {
        return std::clamp(per_factor * factor_count_, kFewestCellTrials, kMostCellTrials);
    };
    // Regions that hold many cells first: what is too rarely tried in a cell is known from there
    std::vector<uint32_t> order;
    std::vector<PlaceTree::Part> parts;
    const PlaceTree regions(places, kRegionCells * most(kTrialsPerFactor), order, parts);
    const std::vector<float> even(factor_count_, 1.0f);
    std::vector<float> of_regions(parts.size() * factor_count_);
    const auto cell = [this](std::vector<float>& factors, size_t i) {
        return std::span(factors).subspan(i * factor_count_, factor_count_);
    };
    parallel_for(int64_t(parts.size()), [&](int64_t i) {
        const auto k = static_cast<size_t>(i);
        learn_factors(trials, parts[k], kPriorTrials, even, cell(of_regions, k));
    });
    tree_ = PlaceTree(places, most(kTrialsPerFactor), order, parts);
    factors_.assign(parts.size() * factor_count_, 1.0f);
    parallel_for(int64_t(parts.size()), [&](int64_t i) {
        const auto k = static_cast<size_t>(i);
        const auto& [position, normal] = places[parts[k].front()];
        learn_factors(trials, parts[k], kRegionTrials,
                      cell(of_regions, regions.leaf(position, normal)), cell(factors_, k));
    });
}

double LampGuide::second_moment(const LitScene& scene, std::span<const LampTrial> trials) const {
    double with = 0, without = 0;
    for (const LampTrial& t : trials) {
        with += moment(scene.lights, t, at(t.place.position, t.place.normal));
        without += moment(scene.lights, t, {});
    }
    return without > 0 ? with / without : 1;
}

}  // namespace covtrace
