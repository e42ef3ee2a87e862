#include "reconstruction/selector.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/vec.h"

namespace covtrace {

namespace {

constexpr size_t kMost = 12;        // candidates
constexpr int kSteps = 24;          // of the minimisation; more change nothing
constexpr float kSmoothing = 0.5f;  // of the shares, pixels

/// Index of G_cd, c <= d, in the list of planes.
size_t entry(size_t c, size_t d) {
    return d * (d + 1) / 2 + c;
}

/// Minimises w^T G w over the simplex: the best single candidate, then steps that move weight from
/// the worst to the best one (pairwise Frank-Wolfe; Lacoste-Julien and Jaggi 2015). Stopping early
/// keeps it near that candidate.
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

/// What pixel i adds to G_cd.
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

/// Shares from G, which `gram(x, y, entries)` tells of every pixel.
template <typename Gram>
Selection mixed(std::span<const Candidate> candidates, int w, int h, bool mix, const Gram& gram) {
    const size_t n = candidates.size();
    Selection s;
    s.share.assign(n, Plane(w, h));
    parallel_for(h, [&](int64_t row) {
        for (int x = 0; x < w; ++x) {
            float entries[kMost * (kMost + 1) / 2], errors[kMost][kMost], share[kMost];
            gram(x, int(row), entries);
            for (size_t d = 0; d < n; ++d)
                for (size_t c = 0; c <= d; ++c) errors[c][d] = errors[d][c] = entries[entry(c, d)];
            minimise(errors, n, mix ? kSteps : 0, share);
            for (size_t c = 0; c < n; ++c) s.share[c](x, int(row)) = share[c];
        }
    });
    // Shares that jump from pixel to pixel would show as noise.
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
    for (size_t k = 0; k < 3; ++k)
        for (size_t i = 0; i < g[k].size(); ++i)
            if (halves[0].count[i] > 0 && halves[1].count[i] > 0)
                g[k][i] = 1 / (sqr(std::max(0.0f, brightness[k][i])) + kDarkSquared);
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
    return mixed(candidates, w, h, mix, [&](int x, int y, float* entries) {
        for (const Plane& plane : gram) *entries++ = plane(x, y);
    });
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
    return mixed(candidates, w, h, mix, [&](int x, int y, float* entries) {
        Likeness::Window weights;
        likeness.weigh(x, y, weights);
        weighted_sums(gram, weights, x, y, entries);
    });
}

}  // namespace covtrace
