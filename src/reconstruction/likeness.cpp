#include "reconstruction/likeness.h"

#include <algorithm>
#include <cmath>

#include "core/vec.h"

namespace covtrace {

static_assert(Likeness::kColumns > 2 * Likeness::kReach &&
              MarginPlane::kMargin >= Likeness::kReach);

MarginPlane::MarginPlane(const Plane& plane) : MarginPlane(plane.width, plane.height) {
    for (int y = 0; y < plane.height; ++y)
        for (int x = 0; x < plane.width; ++x) (*this)(x, y) = plane(x, y);
}

Likeness::Likeness(const LikenessSettings& settings) : any_(settings.any) {
    for (int dy = -kReach; dy <= kReach; ++dy)
        for (int dx = -kReach; dx <= kReach; ++dx) {
            float& weight = gaussian_[size_t(dy + kReach) * kColumns + size_t(dx + kReach)];
            weight = std::exp(-0.5f * (sqr(float(dx)) + sqr(float(dy))) / sqr(settings.sigma));
            most_ += weight;
        }
}

float Likeness::most(int x, int y, int w, int h) const {
    if (x >= kReach && y >= kReach && x + kReach < w && y + kReach < h) return most_;
    float sum = 0;
    for (int qy = std::max(0, y - kReach); qy <= std::min(h - 1, y + kReach); ++qy)
        for (int qx = std::max(0, x - kReach); qx <= std::min(w - 1, x + kReach); ++qx)
            sum += gaussian_[size_t(qy - y + kReach) * kColumns + size_t(qx - x + kReach)];
    return sum;
}

void Likeness::weigh(int x, int y, Window& weights) const {
    for (size_t row = 0; row < kRows; ++row)
        for (size_t column = 0; column < kColumns; column += kLanes) {
            Float8 squared{};
            for (const MarginPlane& guide : guides_) {
                const Float8 difference =
                    load8(guide.at(x - kReach + int(column), y - kReach + int(row))) -
                    *guide.at(x, y);
                squared = multiply_add(difference, difference, squared);
            }
            const size_t i = row * kColumns + column;
            store8(load8(&gaussian_[i]) * (any_ + (1 - any_) * exp_of_negative(-0.5f * squared)),
                   &weights[i]);
        }
}

bool Likeness::are_alike(int px, int py, int qx, int qy) const {
    constexpr float kAlike = 0.5f;  // sum of squared differences of the guides
    float sum = 0;
    for (const MarginPlane& guide : guides_) sum += sqr(*guide.at(px, py) - *guide.at(qx, qy));
    return sum < kAlike;
}

void weighted_sums(std::span<const MarginPlane> planes, const Likeness::Window& weights, int x,
                   int y, float* sums) {
    constexpr int kReach = Likeness::kReach;
    constexpr size_t kAtOnce = 4;  // planes at once, which share the weights that were read
    for (size_t first = 0; first < planes.size(); first += kAtOnce) {
        const size_t n = std::min(kAtOnce, planes.size() - first);
        Float8 sum[kAtOnce] = {};
        for (size_t row = 0; row < Likeness::kRows; ++row) {
            const float* from[kAtOnce];
            for (size_t k = 0; k < kAtOnce; ++k)
                from[k] = planes[first + std::min(k, n - 1)].at(x - kReach, y - kReach + int(row));
            for (size_t column = 0; column < Likeness::kColumns; column += kLanes) {
                const Float8 weight = load8(&weights[row * Likeness::kColumns + column]);
                for (size_t k = 0; k < kAtOnce; ++k)
                    sum[k] = multiply_add(weight, load8(from[k] + column), sum[k]);
            }
        }
        for (size_t k = 0; k < n; ++k) *sums++ = sum8(sum[k]);
    }
}

}  // namespace covtrace
