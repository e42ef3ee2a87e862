#include "light/portal.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/memory_limit.h"
#include "core/parallel.h"
#include "light/weight.h"

namespace covtrace {

namespace {

constexpr double kTurn = std::numbers::pi;  ///< of the angle, from one end of [0, 1] to the other

/// Solid angle by area of the numbers, around the unit local direction w.
double stretch(Vec3 w) {
    return w.z > 0 ? kTurn * kTurn * (1 - sqr(double(w.x))) * (1 - sqr(double(w.y))) / double(w.z)
                   : 0;
}

}  // namespace

Portal::Portal(const std::array<Vec3, 4>& corners, const Sky& sky, int resolution, int taps,
               const SourceLocation& where)
    : corner_(corners[0]),
      side_x_(corners[3] - corners[0]),
      side_y_(corners[1] - corners[0]),
      cells_(static_cast<size_t>(resolution)) {
    frame_.x = normalize(side_x_);
    frame_.z = normalize(cross(side_x_, side_y_));
    frame_.y = cross(frame_.z, frame_.x);
    const size_t corners_per_row = cells_ + 1;
    const MemoryReservation room(corners_per_row * corners_per_row * sizeof(double),
                                 "the portal's table of the sky", where);
    sums_.assign(corners_per_row * corners_per_row, 0);
    std::vector<std::array<double, 3>> rows(cells_);
    parallel_for(resolution, [&](int64_t row) {
        const auto j = static_cast<size_t>(row);
        double sum = 0;
        for (size_t i = 0; i < cells_; ++i) {
            Rgb of_cell;
            for (int b = 0; b < taps; ++b)
                for (int a = 0; a < taps; ++a) {
                    const auto at = [&](size_t cell, int tap) {
                        return (double(cell) + (tap + 0.5) / taps) / double(cells_);
                    };
                    const Vec3 w = direction({at(i, a), at(j, b)});
                    of_cell += static_cast<float>(stretch(w)) * sky(frame_.to_world(w));
                }
            const double share = 1 / (double(taps) * taps * double(cells_) * double(cells_));
            for (size_t c = 0; c < 3; ++c) rows[j][c] += share * of_cell[static_cast<int>(c)];
            sum += share * choice_weight(of_cell);
            sums_[(j + 1) * corners_per_row + i + 1] = sum;
        }
    });
    for (size_t j = 1; j <= cells_; ++j)
        for (size_t i = 1; i <= cells_; ++i)
            sums_[j * corners_per_row + i] += sums_[(j - 1) * corners_per_row + i];
    for (const auto& row : rows)
        fluence_ +=
            Rgb(static_cast<float>(row[0]), static_cast<float>(row[1]), static_cast<float>(row[2]));
}

Portal::Place Portal::place(Vec3 w) const {
    return {std::atan2(double(w.x), double(w.z)) / kTurn + 0.5,
            std::atan2(double(w.y), double(w.z)) / kTurn + 0.5};
}

Vec3 Portal::direction(Place at) const {
    // The tangents of both angles times their cosines, so that nothing is infinite
    const double a = (at.x - 0.5) * kTurn, b = (at.y - 0.5) * kTurn;
    const double x = std::sin(a) * std::cos(b), y = std::sin(b) * std::cos(a),
                 z = std::cos(a) * std::cos(b), l = std::sqrt(x * x + y * y + z * z);
    return {static_cast<float>(x / l), static_cast<float>(y / l), static_cast<float>(z / l)};
}

bool Portal::is_open(Vec3 p, Vec3 w) const {
    const Vec3 from = frame_.to_local(corner_ - p), d = frame_.to_local(w);
    if (!(from.z > 0 && d.z > 0)) return false;
    const float x = d.x * from.z / d.z - from.x, y = d.y * from.z / d.z - from.y;
    return x >= 0 && y >= 0 && x <= dot(side_x_, frame_.x) && y <= dot(side_y_, frame_.y);
}

std::optional<Portal::View> Portal::view(Vec3 p) const {
    const Vec3 from = frame_.to_local(corner_ - p);
    if (!(from.z > 0)) return std::nullopt;
    const Place first = place(from);
    const Place last = place(from + Vec3{dot(side_x_, frame_.x), dot(side_y_, frame_.y), 0});
    View v{first.x, last.x, first.y, last.y};
    v.light = sum(v.x1, v.y1) - sum(v.x0, v.y1) - sum(v.x1, v.y0) + sum(v.x0, v.y0);
    if (!(v.light > 0)) return std::nullopt;
    return v;
}

double Portal::row_sum(double x, size_t j) const {
    const double at = x * double(cells_);
    const auto i = std::min(static_cast<size_t>(at), cells_ - 1);
    const double before = corner(i, j + 1) - corner(i, j);
    const double within = corner(i + 1, j + 1) - corner(i + 1, j) - before;
    return before + (at - double(i)) * within;
}

double Portal::sum(double x, double y) const {
    const double at = x * double(cells_), up = y * double(cells_);
    const auto i = std::min(static_cast<size_t>(at), cells_ - 1),
               j = std::min(static_cast<size_t>(up), cells_ - 1);
    const double s = at - double(i), t = up - double(j);
    return (1 - t) * ((1 - s) * corner(i, j) + s * corner(i + 1, j)) +
           t * ((1 - s) * corner(i, j + 1) + s * corner(i + 1, j + 1));
}

namespace {

/// The place in [lo, hi] where `cumulated`, a function that grows in straight lines between the
/// multiples of 1 / cells, has the share u of its growth.
template <typename Cumulated>
double inverted(const Cumulated& cumulated, double lo, double hi, size_t cells, double u) {
    const double begin = cumulated(lo), wanted = begin + u * (cumulated(hi) - begin);
    const double n = static_cast<double>(cells);
    // Bisection over the multiples, of which [first, last] hold the place
    auto first = static_cast<int64_t>(std::floor(lo * n)),
         last = static_cast<int64_t>(std::ceil(hi * n));
    while (last - first > 1) {
        const int64_t middle = (first + last) / 2;
        (cumulated(double(middle) / n) <= wanted ? first : last) = middle;
    }
    const double a = std::max(lo, double(first) / n), b = std::min(hi, double(last) / n);
    const double below = cumulated(a), step = cumulated(b) - below;
    return step > 0 ? std::clamp(a + (b - a) * (wanted - below) / step, a, b) : (a + b) / 2;
}

}  // namespace

Vec3 Portal::sample(const View& v, Vec2 u) const {
    const double y = inverted([&](double t) { return sum(v.x1, t) - sum(v.x0, t); }, v.y0, v.y1,
                              cells_, double(u.y));
    const auto row = std::min(static_cast<size_t>(y * double(cells_)), cells_ - 1);
    const double x =
        inverted([&](double s) { return row_sum(s, row); }, v.x0, v.x1, cells_, double(u.x));
    return normalize(frame_.to_world(direction({x, y})));
}

float Portal::pdf(const View& v, Vec3 w) const {
    const Vec3 local = frame_.to_local(w);
    const double angle = stretch(local);
    if (!(angle > 0)) return 0;
    const Place at = place(local);
    if (!(at.x >= v.x0 && at.x <= v.x1 && at.y >= v.y0 && at.y <= v.y1)) return 0;
    const auto cell = [this](double t) {
        return std::min(static_cast<size_t>(t * double(cells_)), cells_ - 1);
    };
    const size_t i = cell(at.x), j = cell(at.y);
    const double weight = corner(i + 1, j + 1) - corner(i, j + 1) - corner(i + 1, j) + corner(i, j);
    return static_cast<float>(weight * double(cells_) * double(cells_) / (v.light * angle));
}

}  // namespace covtrace
