#include "reconstruction/selector.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace covtrace {

namespace {

constexpr size_t kMost = 12;  // candidates

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
        if (g[c][c] < g[best][best]) best = c;
    std::fill(w, w + n, 0.0f);
    w[best] = 1;
    for (int step = 0; step < steps; ++step) {
        float slope[kMost];
        for (size_t c = 0; c < n; ++c) {
            slope[c] = 0;
            for (size_t d = 0; d < n; ++d) slope[c] += g[c][d] * w[d];
        }
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
    }
}

}  // namespace

Selection select(const Halves& halves, std::span<const Candidate> candidates,
                 const Plane& brightness, float sigma, bool mix) {
    const int w = brightness.width, h = brightness.height;
    const size_t n = candidates.size();
    constexpr float kDark = 0.01f;  // of relMSE: errors below a tenth count as they are
    std::vector<Plane> gram(n * (n + 1) / 2);
    parallel_for(int64_t(gram.size()), [&](int64_t e) {
        size_t d = 0;
        while (entry(0, d + 1) <= size_t(e)) ++d;
        const size_t c = size_t(e) - entry(0, d);
        Plane plane(w, h);
        for (size_t k = 0; k < 3; ++k) {
            const Plane &a = halves[0].color[k], &b = halves[1].color[k];
            const Plane &ac = candidates[c][0][k], &bc = candidates[c][1][k];
            const Plane &ad = candidates[d][0][k], &bd = candidates[d][1][k];
            for (size_t i = 0; i < plane.size(); ++i)
                plane[i] +=
                    0.5f * ((ac[i] - b[i]) * (ad[i] - b[i]) + (bc[i] - a[i]) * (bd[i] - a[i])) -
                    0.25f * (ac[i] - bc[i]) * (ad[i] - bd[i]);
        }
        for (size_t i = 0; i < plane.size(); ++i)
            plane[i] *= halves[0].count[i] > 0 && halves[1].count[i] > 0
                            ? 1 / (brightness[i] * brightness[i] + kDark)
                            : 0.0f;
        gram[size_t(e)] = gaussian_blur(plane, sigma);
    });

    Selection s;
    s.share.assign(n, Plane(w, h));
    s.error = Plane(w, h);
    s.color.fill(Plane(w, h));
    parallel_for(h, [&](int64_t row) {
        for (size_t i = size_t(row) * size_t(w), end = i + size_t(w); i < end; ++i) {
            float g[kMost][kMost], share[kMost];
            for (size_t d = 0; d < n; ++d)
                for (size_t c = 0; c <= d; ++c) g[c][d] = g[d][c] = gram[entry(c, d)][i];
            minimise(g, n, mix ? 24 : 0, share);
            for (size_t c = 0; c < n; ++c) {
                s.share[c][i] = share[c];
                for (size_t d = 0; d < n; ++d) s.error[i] += share[c] * share[d] * g[c][d];
            }
        }
    });
    // Weights that jump from pixel to pixel would show as noise.
    for (Plane& p : s.share) p = gaussian_blur(p, 1);
    for (size_t c = 0; c < n; ++c)
        for (size_t k = 0; k < 3; ++k)
            for (size_t i = 0; i < s.error.size(); ++i)
                s.color[k][i] +=
                    s.share[c][i] * 0.5f * (candidates[c][0][k][i] + candidates[c][1][k][i]);
    return s;
}

}  // namespace covtrace
