#include "integrator/guides/path_guide.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/parallel.h"
#include "core/warp.h"
#include "integrator/guides/radiance_cache.h"
#include "integrator/lit_scene.h"

namespace covtrace {

namespace {

/// Paths of the trial: as many as an eighth of the pixels, within limits.
constexpr int64_t kTrialPixels = 8, kFewestTrialPaths = 4096, kMostTrialPaths = 16384;
/// Paths of the lesson, which follows where the trial tells that it pays: one for each pixel, up
/// to four for small images, within a limit that also bounds the memory to about 100 MB.
constexpr int64_t kLessonPerPixel = 4, kEnoughLessonPaths = 32768, kMostLessonPaths = 131072;
/// The guide pays where less than this share of the noise is left: a path that it leads takes a
/// fifth longer. A trial tells of less than the lesson will reach.
constexpr double kWorthTrying = 0.93, kWorthwhile = 0.85;
/// Least second moment of a path over the square of the brightness around its pixel: noise as large
/// as what it is of. Below, the even sequences that pixels sample with have most of what a guide
/// gains on single paths, at no cost.
constexpr double kLeastNoise = 2;

constexpr size_t kFewestBounces = 256;  // in all: a guide is not made of less
/// Most bounces of a cell: as many as the root of their number, within limits, so that more of them
/// make cells smaller and directions finer.
constexpr size_t kFewestCellBounces = 256, kMostCellBounces = 8192;
constexpr double kShareOfAll =
    0.2;  // weight of what all cells tell in the choice of a cell's share
constexpr double kMostRelative = 20;  // brightness over its block's that counts
/// Share of the noise without spots that may be left with them.
constexpr double kSpotsAreWorth = 0.9;
/// Bounces that the mean over all cells counts for in what a cell finds in spots.
constexpr double kSpotHitsOfAll = 4;

/// Shares of the samples that may follow the guide, and of these the shares that may go to spots.
struct Choice {
    float guided = 0, to_spots = 0;
};
constexpr std::array<float, 5> kShares{0, 0.3f, 0.5f, 0.7f, 0.85f};
constexpr std::array<float, 3> kSpotShares{0.25f, 0.5f, 0.75f};
/// Those without spots come first.
constexpr auto kChoices = [] {
    std::array<Choice, kShares.size() + (kShares.size() - 1) * kSpotShares.size()> choices;
    size_t n = 0;
    for (float share : kShares) choices[n++] = {share, 0};
    for (size_t i = 1; i < kShares.size(); ++i)
        for (float to_spots : kSpotShares) choices[n++] = {kShares[i], to_spots};
    return choices;
}();
/// Second moments of the light that bounces find, by choice.
using Moments = std::array<double, kChoices.size()>;

/// Inverse of square_to_disc.
Vec2 disc_to_square(Vec2 d) {
    const float r = std::sqrt(d.x * d.x + d.y * d.y);
    if (!(r > 0)) return {0.5f, 0.5f};
    const bool wide = std::abs(d.x) > std::abs(d.y);
    const float a = std::copysign(r, wide ? d.x : d.y);
    const float b = a * arctangent(wide ? d.y / d.x : d.x / d.y, 1) * (4 / kPi);
    const auto side = [](float v) { return std::clamp((v + 1) / 2, 0.0f, kLargestBelowOne); };
    return wide ? Vec2{side(a), side(b)} : Vec2{side(b), side(a)};
}

/// Place in the unit square of a direction in a cell's frame; none below the horizon.
std::optional<Vec2> to_square(Vec3 local) {
    if (!(local.z > 0)) return std::nullopt;
    return disc_to_square({local.x, local.y});
}

/// The light that each bounce found. Means over the places around its end stand for what one path
/// found there; they are of light sampled there and of means one bounce further on, which have less
/// noise than what single paths found in the end.
std::vector<float> light_of_bounces(const PathLesson& lesson) {
    RadianceCache cache(lesson.places);
    const auto found = [&](const GuideBounce& b) {
        return b.to >= 0 ? b.found + b.passed * cache.at(lesson.places[size_t(b.to)]) : b.found;
    };
    cache.learn(lesson.light);
    std::vector<float> light = lesson.direct;
    for (const GuideBounce& b : lesson.bounces) light[b.from] += b.reflected * found(b);
    cache.learn(light);
    std::vector<float> result;
    result.reserve(lesson.bounces.size());
    for (const GuideBounce& b : lesson.bounces) result.push_back(found(b));
    return result;
}

/// The spots that the bounces of a lesson, of which `numbers` may be guided, tell of.
BrightSpots find_spots(const PathLesson& lesson, std::span<const uint32_t> numbers,
                       std::span<const float> light) {
    // The moment is that of the BSDF alone, whatever led the path
    const auto moment_of = [&](uint32_t i) {
        const GuideBounce& b = lesson.bounces[i];
        const float moment = sqr(b.carried * b.value * light[i]) / (b.bsdf_pdf * b.path_pdf);
        return std::isfinite(moment) ? moment : 0.0f;
    };
    double noise = 0;
    for (uint32_t i : numbers) noise += double(moment_of(i));
    // Bounces that bring less than the mean are no sign of a spot, and most of all
    const double mean = noise / double(numbers.size());
    std::vector<SpotHit> hits;
    for (uint32_t i : numbers) {
        const GuideBounce& b = lesson.bounces[i];
        const float moment = moment_of(i);
        if (b.to >= 0 && double(moment) > mean)
            hits.push_back({lesson.places[b.from].position, lesson.places[size_t(b.to)].position,
                            light[i], moment, b.path_pdf, b.bsdf_pdf, b.path});
    }
    return BrightSpots(hits, noise, numbers.size());
}

/// A bounce as its cell sees it.
struct CellBounce {
    const GuideBounce& bounce;
    float light;          ///< luminance of the light that it found
    float cosine;         ///< to the cell's normal
    Vec2 square{};        ///< place of its direction, where the cosine is above 0
    float by_spots = -1;  ///< density of its direction among those to spots; -1: it sees none
    bool ends_in_spot = false;
};

/// The directions of a cell, and how much they help.
struct Learnt {
    DirectionHistogram directions;
    Moments moments{};             ///< each bounce counts the same
    Moments of_spots{};            ///< the same, of the bounces that end in spots
    Moments noise{};               ///< by what the bounces are for the image
    double bounces = 0, hits = 0;  ///< in all, and those that end in spots
};

/// Learns the directions of a cell. The moments are of densities that half of the paths made,
/// measured by the other half.
Learnt learn_directions(const std::vector<CellBounce>& bounces, size_t choices) {
    std::array<std::vector<SquarePoint>, 2> points;
    std::vector<SquarePoint> all;
    for (const CellBounce& c : bounces) {
        if (!(c.cosine > 0)) continue;
        all.push_back({c.square, c.light * c.light * c.cosine / c.bounce.path_pdf});
        points[c.bounce.path % 2].push_back(all.back());
    }
    Learnt learnt;
    learnt.directions = DirectionHistogram(all);
    learnt.bounces = double(bounces.size());
    const std::array<DirectionHistogram, 2> halves{DirectionHistogram(points[0]),
                                                   DirectionHistogram(points[1])};
    for (const CellBounce& c : bounces) {
        const GuideBounce& b = c.bounce;
        const float by_cell = c.cosine > 0 ? cosine_hemisphere_pdf(c.cosine) *
                                                 halves[1 - b.path % 2].density(c.square)
                                           : 0;
        const double found = double(b.value) * double(c.light);
        // Few bright paths would hide what the others tell: they count for less
        const double relative = double(b.carried) * found / double(b.path_pdf);
        const double counts = double(b.carried) * std::min(1.0, kMostRelative / relative);
        learnt.hits += c.ends_in_spot ? 1 : 0;
        for (size_t i = 0; i < choices; ++i) {
            const Choice& choice = kChoices[i];
            const float to_spots = c.by_spots >= 0 ? choice.to_spots : 0;
            const float by_guide =
                to_spots > 0 ? std::lerp(by_cell, c.by_spots, to_spots) : by_cell;
            const double pdf = double(std::lerp(b.bsdf_pdf, by_guide, choice.guided));
            const double moment = found * found / (pdf * double(b.path_pdf));
            if (!std::isfinite(moment) || !(found > 0)) continue;
            (c.ends_in_spot ? learnt.of_spots : learnt.moments)[i] += moment;
            learnt.noise[i] += moment * counts * counts;
        }
    }
    return learnt;
}

/// Chooses the share of a cell, by what all cells tell, too, as its own bounces are few.
size_t best_choice(const Learnt& cell, const Learnt& all, size_t choices) {
    // A cell that has few bounces to spots has them in the measure of all cells, one that has none
    // of many sees no spot
    const double expected = cell.bounces * all.hits / all.bounces;
    const double own = cell.hits + expected, shared = kSpotHitsOfAll / (own + kSpotHitsOfAll);
    const double alike = all.moments[0] > 0 ? cell.moments[0] / all.moments[0] : 0;
    Moments m{};
    for (size_t i = 0; i < choices; ++i)
        m[i] = cell.moments[i] + std::lerp(cell.of_spots[i], alike * all.of_spots[i], shared);
    const double own_moment = m[0];
    for (size_t i = 0; i < choices; ++i)
        m[i] += kShareOfAll * own_moment * all.noise[i] / all.noise[0];
    return static_cast<size_t>(std::min_element(m.begin(), m.begin() + int(choices)) - m.begin());
}

}  // namespace

PathGuide::PathGuide(const LitScene& scene, const CausticGuide& caustics, const SkyGuide& sky,
                     const LampGuide& lamps) {
    const FilmDescription& film = scene.description.film;
    const int64_t pixels = int64_t(film.width) * int64_t(film.height);
    // Learn from a few paths whether it pays
    const int64_t trial =
        std::clamp(pixels / kTrialPixels, std::min(kFewestTrialPaths, pixels), kMostTrialPaths);
    PathLesson lesson = trace_lesson(scene, caustics, sky, lamps, *this, 0, trial);
    outcome_.second_moment = learn(lesson);
    const bool is_noisy = lesson.second_moment > kLeastNoise * double(lesson.paths);
    bool pays = is_noisy && outcome_.second_moment < kWorthTrying;
    if (pays) {
        // Learn in earnest, from directions that matter
        const int64_t paths =
            std::min(std::max(pixels, std::min(kLessonPerPixel * pixels, kEnoughLessonPaths)),
                     kMostLessonPaths);
        append(lesson, trace_lesson(scene, caustics, sky, lamps, *this, trial, paths));
        outcome_.second_moment = learn(lesson);
        pays = outcome_.second_moment < kWorthwhile;
    }
    if (!pays) {
        tree_ = PlaceTree();
        cells_.clear();
        spots_ = BrightSpots();
        outcome_.state = GuideState::gave_up;
        return;
    }
    outcome_.state = GuideState::guides;
    outcome_.bytes = tree_.memory() + cells_.capacity() * sizeof(PathGuideCell);
}

Vec3 PathGuideMixture::sample(float choice, Vec2 u) const {
    if (choice < spot_share_) return spots_.sample(u);
    const Vec2 place = cell_->directions.sample(u);
    return normalize(cell_->frame.to_world(square_to_cosine_hemisphere(place)));
}

float PathGuideMixture::pdf(Vec3 w) const {
    const float by_spots = spot_share_ > 0 ? spot_share_ * spots_.pdf(w) : 0;
    const Vec3 local = cell_->frame.to_local(w);
    const std::optional<Vec2> place = to_square(local);
    if (!place) return by_spots;
    return by_spots +
           (1 - spot_share_) * cosine_hemisphere_pdf(local.z) * cell_->directions.density(*place);
}

double PathGuide::learn(const PathLesson& lesson) {
    tree_ = PlaceTree();
    cells_.clear();
    spots_ = BrightSpots();
    // Sort the bounces that a guide may lead by place
    std::vector<PlaceTree::Place> places;
    std::vector<uint32_t> numbers, order;
    for (size_t i = 0; i < lesson.bounces.size(); ++i) {
        if (!lesson.bounces[i].is_guided) continue;
        places.push_back(lesson.places[lesson.bounces[i].from]);
        numbers.push_back(static_cast<uint32_t>(i));
    }
    if (places.size() < kFewestBounces) return 1;
    std::vector<PlaceTree::Part> parts;
    const auto root = static_cast<size_t>(std::sqrt(double(places.size())));
    tree_ = PlaceTree(places, std::clamp(root, kFewestCellBounces, kMostCellBounces), order, parts);
    // Learn the directions of each cell
    const std::vector<float> light = light_of_bounces(lesson);
    spots_ = find_spots(lesson, numbers, light);
    const size_t choices = spots_.is_empty() ? kShares.size() : kChoices.size();
    cells_.resize(parts.size());
    std::vector<Learnt> learnt(parts.size());
    parallel_for(int64_t(parts.size()), [&](int64_t k) {
        Vec3 normal;
        for (uint32_t i : parts[size_t(k)]) normal += places[i].normal;
        Frame& frame = cells_[size_t(k)].frame;
        frame = Frame::from_z(length_squared(normal) > 0 ? normalize(normal)
                                                         : places[parts[size_t(k)][0]].normal);
        std::vector<CellBounce> bounces;
        for (uint32_t i : parts[size_t(k)]) {
            const GuideBounce& b = lesson.bounces[numbers[i]];
            const Vec3 local = frame.to_local(b.direction);
            CellBounce c{b, light[numbers[i]], local.z, to_square(local).value_or(Vec2{})};
            if (!spots_.is_empty()) {
                const auto view = spots_.seen_from(places[i].position, places[i].normal);
                if (!view.is_empty()) c.by_spots = view.pdf(b.direction);
                c.ends_in_spot = b.to >= 0 && spots_.holds(lesson.places[size_t(b.to)].position);
            }
            bounces.push_back(c);
        }
        learnt[size_t(k)] = learn_directions(bounces, choices);
    });
    // Choose each cell's share
    Learnt all;
    for (const Learnt& l : learnt) {
        for (size_t i = 0; i < choices; ++i) {
            all.moments[i] += l.moments[i];
            all.of_spots[i] += l.of_spots[i];
            all.noise[i] += l.noise[i];
        }
        all.bounces += l.bounces;
        all.hits += l.hits;
    }
    if (!(all.noise[0] > 0)) return 1;
    double before = 0, after = 0;
    std::vector<Choice> chosen;
    // Spots that take next to nothing away are left out: what they are known by is the same noise
    for (const size_t most : {kShares.size(), choices}) {
        double left = 0;
        std::vector<Choice> best;
        before = 0;
        for (const Learnt& l : learnt) {
            const size_t i = best_choice(l, all, most);
            before += l.noise[0];
            left += l.noise[i];
            best.push_back(kChoices[i]);
        }
        if (!chosen.empty() && !(left < kSpotsAreWorth * after)) continue;
        after = left;
        chosen = std::move(best);
    }
    for (size_t k = 0; k < cells_.size(); ++k) {
        cells_[k].share = chosen[k].guided;
        cells_[k].spot_share = chosen[k].to_spots;
        cells_[k].directions = learnt[k].directions;
    }
    // Tell what is left of the second moment of paths, of which bounces make a part
    return 1 - std::min((before - after) / lesson.second_moment, 1 - after / before);
}

}  // namespace covtrace
