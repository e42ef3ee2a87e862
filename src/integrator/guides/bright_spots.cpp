#include "integrator/guides/bright_spots.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/frame.h"
#include "core/hash.h"

namespace covtrace {

namespace {

/// Hits of each half of the paths that spots are sought among, and those of them that may be a
/// spot's centre.
constexpr size_t kMostHits = 1024, kCentres = 24;
/// Radii that are tried, over the distance of the hit at the centre: from the first one on, each
/// the same share of the one before. Wider ones are what histograms of directions are for.
constexpr int kRadii = 10;
constexpr float kWidest = 0.12f, kNextRadius = 0.7f;
/// Probability with which a spot is taken to be sampled, and that left to the BSDF.
constexpr double kSampled = 0.2, kLeft = 0.5;
/// A spot is known by paths of either half that each bring more than this over the brightness
/// there, squared.
constexpr float kLonely = 4;
constexpr size_t kFewestPaths = 4;
/// Least share of all noise that a spot must take away, and of that of the bounces that end in it:
/// of a spot that paths often meet, or one that is large, a histogram of directions tells as well.
constexpr double kWorthwhile = 0.02, kMostOfItsOwn = 0.75;
/// Least gain by the hits of the paths that a spot was not found by, over that by the others.
constexpr double kFoundAgain = 0.5;
/// Found spots are a little larger than the hits that they were found by.
constexpr float kRoom = 1.1f;
/// Least sine of a cone's half angle: single precision tells directions apart well within it.
constexpr float kNarrowest = 0.01f;
/// Least cosine that a spot near the horizon is taken to have.
constexpr float kLeastCosine = 0.1f;

/// 1 less the cosine of the half angle that a ball of radius r covers at the distance d > r.
float cone_height(float r, float d) {
    const float square = std::max(sqr(kNarrowest), sqr(r / d));
    return square / (1 + safe_sqrt(1 - square));
}

bool lies_in(Vec3 p, Vec3 centre, float radius) {
    return length_squared(p - centre) <= sqr(radius);
}

/// The noise of the hits in a ball, what of it a spot would take away, and whether enough paths
/// tell of it.
struct Gain {
    double noise = 0, taken = 0;
    bool is_known = false;
};

Gain gain_of(std::span<const SpotHit> hits, Vec3 centre, float radius) {
    Gain gain;
    std::array<uint32_t, kFewestPaths> paths;
    size_t known = 0;
    for (const SpotHit& hit : hits) {
        if (!lies_in(hit.to, centre, radius)) continue;
        gain.noise += double(hit.moment);
        const auto end = paths.begin() + int(known);
        if (known < kFewestPaths && hit.moment > kLonely &&
            std::find(paths.begin(), end, hit.path) == end)
            paths[known++] = hit.path;
        const float d = distance(hit.from, centre);
        if (!(d > radius)) continue;
        const double by_spot = kSampled / (2 * double(kPi) * double(cone_height(radius, d)));
        const double pdf = kLeft * double(hit.bsdf_pdf) + by_spot;
        gain.taken += double(hit.moment) * (1 - double(hit.bsdf_pdf) / pdf);
    }
    gain.is_known = known == kFewestPaths;
    return gain;
}

/// A ball, and the noise that it would take away.
struct Found {
    Vec3 centre;
    float radius = 0;
    double gain = 0;
};

/// The ball that takes the most noise away, of those around the hits that bring the most; `hits`
/// are those of either half of the paths, sorted by what they bring.
std::optional<Found> best_of(const std::array<std::vector<SpotHit>, 2>& hits) {
    std::optional<Found> best;
    for (size_t half = 0; half < 2; ++half) {
        const std::span<const SpotHit> own(hits[half]);
        for (const SpotHit& centre : own.first(std::min(kCentres, own.size()))) {
            float radius = kWidest * distance(centre.from, centre.to);
            for (int k = 0; k < kRadii; ++k, radius *= kNextRadius) {
                const Gain found = gain_of(own, centre.to, radius);
                // A ball of which this half tells less than the other is found by that one
                if (!found.is_known || found.taken < kMostOfItsOwn * found.noise ||
                    (best && found.taken <= best->gain / 2))
                    continue;
                const Gain again = gain_of(hits[1 - half], centre.to, radius);
                const double sum = found.taken + again.taken;
                if (again.is_known && again.taken > kFoundAgain * found.taken &&
                    (!best || sum > best->gain))
                    best = Found{centre.to, radius, sum};
            }
        }
    }
    return best;
}

}  // namespace

BrightSpots::BrightSpots(std::span<const SpotHit> hits, double noise, size_t bounces) {
    std::array<std::vector<SpotHit>, 2> left;
    for (const SpotHit& hit : hits) left[hit.path % 2].push_back(hit);
    for (auto& half : left) {
        std::ranges::stable_sort(half, std::ranges::greater{}, &SpotHit::moment);
        half.resize(std::min(half.size(), kMostHits));
    }
    while (spots_.size() < kMost) {
        const std::optional<Found> found = best_of(left);
        if (!found || !(found->gain > kWorthwhile * noise)) return;
        Spot spot{found->centre, kRoom * found->radius, 0};
        const auto is_in = [&spot](const SpotHit& hit) {
            return lies_in(hit.to, spot.centre, spot.radius);
        };
        double sum = 0;
        for (const SpotHit& hit : hits)
            if (is_in(hit))
                sum += double(hit.light) * double(length_squared(hit.to - hit.from)) /
                       double(hit.path_pdf);
        spot.intensity = float(sum / double(bounces));
        for (auto& half : left) std::erase_if(half, is_in);
        if (std::isfinite(spot.intensity) && spot.intensity > 0) spots_.push_back(spot);
    }
}

BrightSpots::View BrightSpots::seen_from(Vec3 p, Vec3 n) const {
    View view;
    float sum = 0;
    for (const Spot& spot : spots_) {
        const Vec3 to_centre = spot.centre - p;
        const float d = length(to_centre), height = dot(n, to_centre);
        if (!(d > spot.radius) || height < -spot.radius) continue;
        View::Cone& cone = view.cones_[view.count_++];
        cone.axis = to_centre / d;
        cone.height = cone_height(spot.radius, d);
        cone.probability = spot.intensity / sqr(d) * std::max(kLeastCosine, height / d);
        sum += cone.probability;
    }
    if (!(sum > 0) || !std::isfinite(sum)) return {};
    for (size_t k = 0; k < view.count_; ++k) view.cones_[k].probability /= sum;
    return view;
}

bool BrightSpots::holds(Vec3 p) const {
    return std::ranges::any_of(
        spots_, [p](const Spot& spot) { return lies_in(p, spot.centre, spot.radius); });
}

Vec3 BrightSpots::View::sample(Vec2 u) const {
    size_t k = 0;
    while (k + 1 < count_ && u.x >= cones_[k].probability) u.x -= cones_[k++].probability;
    const Cone& cone = cones_[k];
    const float along = std::min(u.x / cone.probability, kLargestBelowOne) * cone.height;
    const float across = safe_sqrt(along * (2 - along)), phi = 2 * kPi * u.y;
    const Frame frame = Frame::from_z(cone.axis);
    return normalize(frame.to_world({across * std::cos(phi), across * std::sin(phi), 1 - along}));
}

float BrightSpots::View::pdf(Vec3 w) const {
    float sum = 0;
    for (size_t k = 0; k < count_; ++k) {
        const Cone& cone = cones_[k];
        // The distance between unit vectors keeps digits of small angles that the cosine has not
        if (0.5f * length_squared(w - cone.axis) <= cone.height)
            sum += cone.probability / (2 * kPi * cone.height);
    }
    return sum;
}

}  // namespace covtrace
