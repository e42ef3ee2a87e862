/// Values of pixels that need sums over large windows: found for some pixels, and for others that
/// are like those as their mean.
#pragma once

#include "core/parallel.h"

namespace covtrace {

/// Step between pixels whose values are always found (docs/decisions/0094).
constexpr int kCoarsestStep = 4;

/// Calls `set(x, y)` for every kCoarsestStep-th pixel in x and in y, then halves the step until all
/// pixels are done: `between(x, y, left, top, right, bottom)` for pixels that are `alike(x, y, u,
/// v)` to all of the nearest done ones, `set` for the others. Runs on all threads.
template <typename Set, typename Alike, typename Between>
void coarse_to_fine(int w, int h, const Set& set, const Alike& alike, const Between& between) {
    parallel_for_rows(w / kCoarsestStep, (h + kCoarsestStep - 1) / kCoarsestStep, [&](int row) {
        for (int x = 0; x < w; x += kCoarsestStep) set(x, row * kCoarsestStep);
    });
    for (int step = kCoarsestStep; step > 1; step /= 2) {
        const int half = step / 2;
        parallel_for_rows(w / half, (h + half - 1) / half, [&](int row) {
            const int y = row * half;
            const bool some_done = y % step == 0;
            for (int x = some_done ? half : 0; x < w; x += some_done ? step : half) {
                const int left = x - x % step, top = y - y % step,
                          right = x == left ? left : left + step,
                          bottom = y == top ? top : top + step;
                const bool inside = right < w && bottom < h;
                if (inside && alike(x, y, left, top) && alike(x, y, right, top) &&
                    alike(x, y, left, bottom) && alike(x, y, right, bottom))
                    between(x, y, left, top, right, bottom);
                else
                    set(x, y);
            }
        });
    }
}

}  // namespace covtrace
