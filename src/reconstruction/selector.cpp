#include "reconstruction/selector.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/vec.h"
#include "reconstruction/luminance.h"

namespace covtrace {

namespace {

constexpr size_t kMost = 12;  // most candidates
/// Step between pixels whose shares are always judged; between them, pixels are judged that differ
/// from those around them by kAlike, as sum of squared differences of the guides
/// (docs/decisions/0094).
constexpr int kCoarsest = 4;
constexpr float kAlike = 0.5f;
constexpr int kSteps = 24;          // steps of the minimisation; more change nothing
constexpr float kSmoothing = 0.5f;  // smoothing of the shares, pixels

/// Index of G_cd, c <= d, in the list of planes.
size_t entry(size_t c, size_t d) {
    return d * (d + 1) / 2 + c;
}

/// Minimises w^T G w over the simplex: begins with the best single candidate, then moves weight
/// from the worst candidate to the best one step by step (pairwise Frank-Wolfe; Lacoste-Julien and
/// Jaggi 2015). Stopping early keeps the minimum near that candidate.
void minimise(const float (&g)[kMost][kMost], size_t n, int steps, float (&w)[kMost]) {
    size_t best = 0;
    for (size_t c = 1; c < n; ++c)
        if (g[c][c] <= g[best][best]) best = c;
    std::fill(w, w + n, 0.0f);
    w[best] = 1;
    float slope[kMost];  // G w
    std::copy_n(g[best], n, slope);
    for (int step = 0; step < steps; ++step) {
        size_t to = 0, from = best;
        for (size_t c = 1; c < n; ++c)
            if (slope[c] < slope[to]) to = c;
        for (size_t c = 0; c < n; ++c)
            if (w[c] > 0 && (w[from] <= 0 || slope[c] > slope[from])) from = c;
        const float curvature = g[to][to] - 2 * g[to][from] + g[from][from];
        if (to == from || !(curvature > 0)) break;
        const float move = std::clamp((slope[from] - slope[to]) / curvature, 0.0f, w[from]);
        if (!(move > 1e-4f)) break;
        w[to] += move;
        w[from] -= move;
        for (size_t c = 0; c < n; ++c) slope[c] += move * (g[to][c] - g[from][c]);
    }
}

/// The product of errors that pixel i adds to G_cd.
float product_of_errors(const Halves& halves, const Candidate& c, const Candidate& d,
                        const ColorPlanes& g, size_t i) {
    float sum = 0;
    for (size_t k = 0; k < 3; ++k) {
        const float a = halves[0].color[k][i], b = halves[1].color[k][i];
        sum += 0.5f * g[k][i] *
               ((c[0][k][i] - b) * (d[0][k][i] - b) + (c[1][k][i] - a) * (d[1][k][i] - a));
    }
    return sum;
}

/// Calls `of_pair(c, d, entry)` for all pairs c <= d of candidates, on all threads.
template <typename OfPair>
void for_pairs(size_t n, const OfPair& of_pair) {
    parallel_for(int64_t(n * n), [&](int64_t pair) {
        const size_t c = size_t(pair) % n, d = size_t(pair) / n;
        if (c <= d) of_pair(c, d, entry(c, d));
    });
}

/// Calls `set(x, y)` for every kCoarsest-th pixel in x and in y, then halves the step until all
/// pixels are done: `between(x, y, left, top, right, bottom)` for pixels that are `alike(x, y, u,
/// v)` to all of the nearest done ones, `set` for the others. Runs on all threads.
template <typename Set, typename Alike, typename Between>
void coarse_to_fine(int w, int h, const Set& set, const Alike& alike, const Between& between) {
    parallel_for_rows(w / kCoarsest, (h + kCoarsest - 1) / kCoarsest, [&](int row) {
        for (int x = 0; x < w; x += kCoarsest) set(x, row * kCoarsest);
    });
    for (int step = kCoarsest; step > 1; step /= 2) {
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

/// Mixes the candidates with shares from G, whose entries `gram(x, y, entries)` gives for a pixel.
/// Pixels that are `alike` to those around them have the mean of their shares.
template <typename Gram, typename Alike>
Selection mixed(std::span<const Candidate> candidates, int w, int h, bool mix, const Gram& gram,
                const Alike& alike) {
    const size_t n = candidates.size();
    Selection s;
    s.share.assign(n, Plane(w, h));
    const auto judge = [&](int x, int y) {
        float entries[kMost * (kMost + 1) / 2], errors[kMost][kMost], share[kMost];
        gram(x, y, entries);
        for (size_t d = 0; d < n; ++d)
            for (size_t c = 0; c <= d; ++c) errors[c][d] = errors[d][c] = entries[entry(c, d)];
        minimise(errors, n, mix ? kSteps : 0, share);
        for (size_t c = 0; c < n; ++c) s.share[c](x, y) = share[c];
    };
    coarse_to_fine(w, h, judge, alike, [&](int x, int y, int left, int top, int right, int bottom) {
        for (Plane& share : s.share)
            share(x, y) = 0.25f * ((share(left, top) + share(right, top)) +
                                   (share(left, bottom) + share(right, bottom)));
    });
    // Smooth the shares: jumps from pixel to pixel would show as noise
    for (Plane& p : s.share) p = gaussian_blur(p, kSmoothing);
    for (size_t k = 0; k < 2; ++k) {
        s.half[k].fill(Plane(w, h));
        for (size_t c = 0; c < n; ++c)
            for (size_t channel = 0; channel < 3; ++channel)
                for (size_t i = 0; i < s.share[c].size(); ++i)
                    s.half[k][channel][i] += s.share[c][i] * candidates[c][k][channel][i];
    }
    return s;
}

}  // namespace

ColorPlanes error_weights(const Halves& halves, const ColorPlanes& brightness) {
    ColorPlanes g;
    g.fill(Plane(brightness[0].width, brightness[0].height));
    if (is_empty(halves[0]) || is_empty(halves[1])) return g;
    for (size_t k = 0; k < 3; ++k)
        for (size_t i = 0; i < g[k].size(); ++i)
            if (halves[0].count[i] > 0 || halves[1].count[i] > 0)
                g[k][i] = 1 / (sqr(brightness[k][i]) + kDarkSquared);
    return g;
}

Selection select(const Halves& halves, std::span<const Candidate> candidates, const ColorPlanes& g,
                 float sigma, bool mix) {
    const int w = g[0].width, h = g[0].height;
    const size_t n = candidates.size();
    std::vector<Plane> gram(n * (n + 1) / 2);
    for_pairs(n, [&](size_t c, size_t d, size_t e) {
        Plane local(w, h);
        for (size_t i = 0; i < local.size(); ++i)
            local[i] = product_of_errors(halves, candidates[c], candidates[d], g, i);
        gram[e] = gaussian_blur(local, sigma);
    });
    const auto sums = [&](int x, int y, float* entries) {
        for (const Plane& plane : gram) *entries++ = plane(x, y);
    };
    // All pixels between are taken for alike: sums over a Gaussian hardly change from pixel to
    // pixel.
    return mixed(candidates, w, h, mix, sums, [mix](int, int, int, int) { return mix; });
}

Selection select(const Halves& halves, std::span<const Candidate> candidates, const ColorPlanes& g,
                 const Likeness& likeness, bool mix) {
    const int w = g[0].width, h = g[0].height;
    const size_t n = candidates.size();
    std::vector<MarginPlane> gram(n * (n + 1) / 2, MarginPlane(w, h));
    for_pairs(n, [&](size_t c, size_t d, size_t e) {
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x)
                gram[e](x, y) = product_of_errors(halves, candidates[c], candidates[d], g,
                                                  size_t(y) * size_t(w) + size_t(x));
    });
    const auto sums = [&](int x, int y, float* entries) {
        Likeness::Window weights;
        likeness.weigh(x, y, weights);
        weighted_sums(gram, weights, x, y, entries);
    };
    // Means are for mixtures alone: the best single candidates of pixels have none.
    const auto alike = [&](int x, int y, int u, int v) {
        return mix && likeness.difference(x, y, u, v) < kAlike;
    };
    return mixed(candidates, w, h, mix, sums, alike);
}

}  // namespace covtrace
