#include "integrator/guides/caustic_image.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace covtrace {

namespace {

constexpr int kFits = 3;  // rounds, each without the photons that the one before found to be off
constexpr size_t kFewestToBend = 24;
constexpr int kBendNumbers = 6;  // numbers that a bend fits to a photon's two, on a surface
/// Ridge of the linear function's fit as a share of the places' mean variance. Photons lie on a
/// surface: across it nothing is known, and the function is to stay level.
constexpr double kRidge = 1e-3;
/// Factor by which lobes are wider than the photons' spread, so that light at their border is not
/// found with a density that is far too small.
constexpr float kWidening = 1.5f;
constexpr float kNarrowest = 1e-3f, kWidest = 0.4f;  // standard deviation, radians
constexpr int kPowerSteps = 8, kMeansSteps = 4;      // enough to tell clusters that are well apart
constexpr int kMostDivisions = 2;                    // halvings of photons that came the same way
/// Two images in the place of one must leave this share of its solid angle. Halves of one normal
/// distribution leave 0.6 of it.
constexpr float kLeftByDivision = 0.3f;

/// A symmetric system of three equations.
struct Normal3 {
    double a[3][3] = {};

    void add(double weight, const double (&x)[3]) {
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) a[i][j] += weight * x[i] * x[j];
    }
    double minor(int i, int j) const {
        const int r0 = (i + 1) % 3, r1 = (i + 2) % 3, c0 = (j + 1) % 3, c1 = (j + 2) % 3;
        return a[r0][c0] * a[r1][c1] - a[r0][c1] * a[r1][c0];
    }
    double determinant() const {
        return a[0][0] * minor(0, 0) + a[0][1] * minor(0, 1) + a[0][2] * minor(0, 2);
    }
    double trace() const { return a[0][0] + a[1][1] + a[2][2]; }
    /// The x of a x = b; the determinant must not be 0.
    Vec3 solve(const double (&b)[3]) const {
        const double det = determinant();
        Vec3 x;
        for (int i = 0; i < 3; ++i)
            x[i] = float((minor(0, i) * b[0] + minor(1, i) * b[1] + minor(2, i) * b[2]) / det);
        return x;
    }
};

/// Divides photons in two by directions, given what an image leaves of them: by the principal axis
/// first, then each to the nearer mean (two-means).
std::array<std::vector<CausticPhoton>, 2> halves(std::span<const CausticPhoton> photons,
                                                 const std::vector<Vec3>& left) {
    Vec3 mean;
    for (Vec3 v : left) mean += v / float(left.size());
    Normal3 covariance;
    for (Vec3 v : left) covariance.add(1, {v.x - mean.x, v.y - mean.y, v.z - mean.z});
    Vec3 axis{1, 0.9f, 0.8f};  // no likely axis is perpendicular to it
    for (int i = 0; i < kPowerSteps; ++i) {
        Vec3 next;
        for (int r = 0; r < 3; ++r)
            for (int k = 0; k < 3; ++k) next[r] += float(covariance.a[r][k]) * axis[k];
        if (!(length_squared(next) > 0)) break;
        axis = normalize(next);
    }
    std::vector<bool> is_second;
    for (Vec3 v : left) is_second.push_back(dot(v - mean, axis) > 0);
    for (int step = 0; step < kMeansSteps; ++step) {
        Vec3 sum[2];
        float count[2] = {};
        for (size_t i = 0; i < left.size(); ++i) {
            sum[is_second[i]] += left[i];
            ++count[is_second[i]];
        }
        if (count[0] == 0 || count[1] == 0) break;
        const Vec3 a = sum[0] / count[0], b = sum[1] / count[1];
        for (size_t i = 0; i < left.size(); ++i)
            is_second[i] = length_squared(left[i] - b) < length_squared(left[i] - a);
    }
    std::array<std::vector<CausticPhoton>, 2> parts;
    for (size_t i = 0; i < left.size(); ++i) parts[is_second[i]].push_back(photons[i]);
    return parts;
}

/// Finds the point nearest to all rays, by weight; returns false where they are parallel.
bool nearest_to_rays(std::span<const CausticPhoton> photons, Vec3& point) {
    Normal3 normal;
    double b[3] = {}, weight = 0;
    for (const CausticPhoton& p : photons) {
        const double d[3] = {p.direction.x, p.direction.y, p.direction.z};
        const double along = double(dot(p.position, p.direction));
        weight += p.weight;
        normal.add(-p.weight, d);
        for (int i = 0; i < 3; ++i) b[i] += p.weight * (p.position[i] - along * d[i]);
    }
    for (int i = 0; i < 3; ++i) normal.a[i][i] += weight;
    if (!(normal.determinant() > 1e-9 * weight * weight * weight)) return false;
    point = normal.solve(b);
    return true;
}

void divide(std::span<const CausticPhoton> photons, const CausticImage& whole, int divisions,
            std::vector<CausticImage>& images) {
    if (divisions > 0 && photons.size() >= 2 * CausticImage::kFewestPhotons) {
        std::vector<Vec3> left;
        for (const CausticPhoton& p : photons)
            left.push_back(p.direction - whole.direction(p.position));
        const auto parts = halves(photons, left);
        if (std::min(parts[0].size(), parts[1].size()) >= CausticImage::kFewestPhotons) {
            const CausticImage a(parts[0]), b(parts[1]);
            const auto n = float(photons.size());
            const float angle =
                float(parts[0].size()) / n / a.kappa() + float(parts[1].size()) / n / b.kappa();
            if (a.kappa() > 0 && b.kappa() > 0 &&
                (whole.kappa() == 0 || angle < kLeftByDivision / whole.kappa())) {
                divide(parts[0], a, divisions - 1, images);
                divide(parts[1], b, divisions - 1, images);
                return;
            }
        }
    }
    images.push_back(whole);
}

}  // namespace

std::vector<CausticImage> CausticImage::seen_by(std::span<const CausticPhoton> photons) {
    std::vector<CausticImage> images;
    divide(photons, CausticImage(photons), kMostDivisions, images);
    return images;
}

Vec3 CausticImage::direction(Vec3 place) const {
    const Vec3 from_centre = place - centre_;
    return normalize(normalize(point_ - place) + offset_ +
                     Vec3{dot(gradient_[0], from_centre), dot(gradient_[1], from_centre),
                          dot(gradient_[2], from_centre)});
}

float CausticImage::miss(const CausticPhoton& photon) const {
    return length_squared(direction(photon.position) - photon.direction);
}

float CausticImage::median_miss(std::span<const CausticPhoton> photons) const {
    std::vector<float> all;
    for (const CausticPhoton& p : photons) all.push_back(miss(p));
    const auto middle = all.begin() + std::ptrdiff_t(all.size() / 2);
    std::nth_element(all.begin(), middle, all.end());
    return *middle;
}

void CausticImage::place_point(std::span<const CausticPhoton> photons) {
    Vec3 position, direction;
    float weight = 0, distance = 0;
    for (const CausticPhoton& p : photons) {
        position += p.position * p.weight;
        direction += p.direction * p.weight;
        distance += std::min(p.distance, 1e6f) * p.weight;
        weight += p.weight;
    }
    // Unfolded, the light lies as far along the mean direction as the paths are long; where rays
    // meet in a nearer point (a curved mirror's focus), that point tells better where it is.
    point_ = position / weight + normalize(direction) * (distance / weight);
    CausticImage focused;
    if (nearest_to_rays(photons, focused.point_) &&
        focused.median_miss(photons) < median_miss(photons))
        point_ = focused.point_;
}

void CausticImage::bend(std::span<const CausticPhoton> photons) {
    double weight = 0, mean[3] = {}, mean_left[3] = {};
    const auto left = [this](const CausticPhoton& p) {
        return p.direction - normalize(point_ - p.position);
    };
    for (const CausticPhoton& p : photons) {
        weight += p.weight;
        for (int i = 0; i < 3; ++i) {
            mean[i] += p.weight * p.position[i];
            mean_left[i] += p.weight * left(p)[i];
        }
    }
    for (int i = 0; i < 3; ++i) {
        mean[i] /= weight;
        mean_left[i] /= weight;
    }
    Normal3 normal;
    double b[3][3] = {};
    for (const CausticPhoton& p : photons) {
        const double x[3] = {p.position.x - mean[0], p.position.y - mean[1],
                             p.position.z - mean[2]};
        normal.add(p.weight, x);
        const Vec3 l = left(p);
        for (int k = 0; k < 3; ++k)
            for (int i = 0; i < 3; ++i) b[k][i] += p.weight * (l[k] - mean_left[k]) * x[i];
    }
    const double ridge = kRidge * normal.trace() / 3;
    if (!(ridge > 0)) return;
    for (int i = 0; i < 3; ++i) normal.a[i][i] += ridge;
    centre_ = {float(mean[0]), float(mean[1]), float(mean[2])};
    offset_ = {float(mean_left[0]), float(mean_left[1]), float(mean_left[2])};
    for (size_t k = 0; k < 3; ++k) gradient_[k] = normal.solve(b[k]);
}

CausticImage::CausticImage(std::span<const CausticPhoton> photons) {
    std::vector<CausticPhoton> core(photons.begin(), photons.end());
    float spread = 4;  // median of miss
    for (int i = 0; i < kFits; ++i) {
        *this = {};
        place_point(core);
        spread = median_miss(core);
        if (core.size() >= kFewestToBend) {
            CausticImage bent = *this;
            bent.bend(core);
            // Photons are nearer to what was fitted to them than others will be.
            const float n = float(core.size());
            const float s = bent.median_miss(core) * 2 * n / (2 * n - kBendNumbers);
            if (s < spread) {
                *this = bent;
                spread = s;
            }
        }
        std::erase_if(core, [&](const CausticPhoton& p) { return miss(p) > 9 * spread; });
    }
    // The median of the squared distance from the centre of a normal distribution in the plane is 2
    // ln 2 variances of one axis.
    const float deviation =
        std::max(kWidening * std::sqrt(spread / (2 * std::log(2.0f))), kNarrowest);
    kappa_ = deviation < kWidest ? 1 / (deviation * deviation) : 0;
}

}  // namespace covtrace
