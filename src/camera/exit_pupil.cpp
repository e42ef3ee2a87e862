#include "camera/exit_pupil.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace covtrace {

namespace {

constexpr int kRanges = 64;         // of film radii
constexpr int kGrid = 64;           // rays along a box' side that is looked through
constexpr float kWidest = 1.5f;     // pupils reach this far in rear radii, as in pbrt
constexpr float kOpenings = 0.25f;  // ratio of a stop's radius to the one looked through before

}  // namespace

ExitPupils::ExitPupils(const LensSystem& lens, float film_radius)
    : pupils_(kRanges), film_radius_(film_radius) {
    parallel_for(kRanges, [&](int64_t i) {
        const auto at = [&](float place) { return (float(i) + place) / kRanges * film_radius_; };
        pupils_[size_t(i)] = find(lens, {at(0), at(0.5f), at(1)});
    });
}

/// The part of a box that light gets through with a stop of this radius; empty (x0 > x1) where none
/// does. Pupils are symmetric about the x axis, so that half of the box tells.
ExitPupils::Box ExitPupils::shrunk(const LensSystem& lens, const Radii& film, const Box& box,
                                   float stop) {
    const float step_x = (box.x1 - box.x0) / kGrid, step_y = box.y / (kGrid / 2);
    Box found{kInfinity, -kInfinity, 0};
    for (int j = 0; j < kGrid / 2; ++j)
        for (int i = 0; i < kGrid; ++i) {
            const Vec2 rear{box.x0 + (float(i) + 0.5f) * step_x, (float(j) + 0.5f) * step_y};
            if (rear.x > found.x0 && rear.x < found.x1 && rear.y < found.y) continue;
            const auto passes = [&](float radius) { return lens.passes({radius, 0}, rear, stop); };
            if (std::none_of(film.begin(), film.end(), passes)) continue;
            found.x0 = std::min(found.x0, rear.x - step_x);
            found.x1 = std::max(found.x1, rear.x + step_x);
            found.y = std::max(found.y, rear.y + step_y);
        }
    return found;
}

ExitPupils::Pupil ExitPupils::find(const LensSystem& lens, const Radii& film) {
    // Close the stop step by step, so that small pupils are not missed
    const float widest = kWidest * lens.rear_radius();
    Box box{-widest, widest, widest};
    float stop = lens.has_stop() ? std::max(lens.stop_reach(), widest) : 0;
    do {
        stop = std::max(stop * kOpenings, lens.stop_reach());
        box = shrunk(lens, film, box, stop);
        if (box.x0 > box.x1) return {};
    } while (stop > lens.stop_reach());

    // Bound the pupil along lines on both sides and in the middle of each row
    constexpr int kLines = kRows + 1;  // of half the box, two to a row
    const float step_x = (box.x1 - box.x0) / kGrid;
    std::array<Box, kLines> lines;
    for (int j = 0; j < kLines; ++j) {
        const float y = box.y * float(j) / kRows;
        const auto passes = [&](float x) {
            return std::any_of(film.begin(), film.end(), [&](float radius) {
                return lens.passes({radius, 0}, {x, y}, lens.stop_reach());
            });
        };
        /// The place nearest to `in`, which light passes, towards `out` that it doesn't pass.
        const auto end = [&](float in, float out) {
            for (int i = 0; i < 5; ++i) {
                const float middle = (in + out) / 2;
                (passes(middle) ? in : out) = middle;
            }
            return out;
        };
        const auto column = [&](int i) { return box.x0 + (float(i) + 0.5f) * step_x; };
        int first = 0, last = kGrid - 1;
        while (first < kGrid && !passes(column(first))) ++first;
        if (first == kGrid) {
            lines[size_t(j)] = {kInfinity, -kInfinity, 0};
            continue;
        }
        while (!passes(column(last))) --last;
        lines[size_t(j)] = {end(column(first), column(first) - step_x),
                            end(column(last), column(last) + step_x), 0};
    }
    Pupil pupil;
    pupil.y0 = -box.y;
    pupil.row_height = 2 * box.y / kRows;
    for (int row = 0; row < kRows; ++row) {
        const int above = 2 * row - kRows;  // the row's first line, counted from the axis
        float x0 = kInfinity, x1 = -kInfinity;
        for (const int line : {above, above + 1, above + 2}) {
            const Box& b = lines[size_t(std::abs(line))];
            x0 = std::min(x0, b.x0);
            x1 = std::max(x1, b.x1);
        }
        pupil.x0[size_t(row)] = x0 < x1 ? x0 : 0;
        pupil.width[size_t(row)] = std::max(0.0f, x1 - x0);
        pupil.total_width += pupil.width[size_t(row)];
    }
    return pupil;
}

ExitPupils::Sample ExitPupils::sample(Vec2 film, Vec2 u) const {
    const float radius = length(film);
    const int range = std::min(int(radius / film_radius_ * kRanges), kRanges - 1);
    const Pupil& pupil = pupils_[size_t(range)];
    if (!(pupil.total_width > 0)) return {};
    // Choose a row by its width, and a place in it
    float left = u.y * pupil.total_width;
    size_t row = 0;
    while (row + 1 < kRows && left >= pupil.width[row]) left -= pupil.width[row++];
    const float share = pupil.width[row] > 0 ? std::min(left / pupil.width[row], 1.0f) : 0;
    const Vec2 place{pupil.x0[row] + u.x * pupil.width[row],
                     pupil.y0 + (float(row) + share) * pupil.row_height};
    const Vec2 axis = radius > 0 ? film * (1 / radius) : Vec2{1, 0};
    return {{axis.x * place.x - axis.y * place.y, axis.y * place.x + axis.x * place.y},
            pupil.total_width * pupil.row_height};
}

}  // namespace covtrace
