#include "reconstruction/selector.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/vec.h"

namespace covtrace {

namespace {

constexpr size_t kMost = 12;  // candidates
constexpr int kSteps = 24;    // of the minimisation; more change nothing

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

Plane normaliser(const Halves& halves, const Plane& brightness) {
    Plane g(brightness.width, brightness.height);
    for (size_t i = 0; i < g.size(); ++i)
        if (halves[0].count[i] > 0 && halves[1].count[i] > 0)
            g[i] = 1 / (brightness[i] * brightness[i] + kDarkSquared);
    return g;
}

/// G_cd of every pixel.
Plane products_of_errors(const Halves& halves, const Candidate& c, const Candidate& d,
                         const Plane& g, float sigma) {
    Plane sum(g.width, g.height);
    for (size_t k = 0; k < 3; ++k) {
        const Plane &a = halves[0].color[k], &b = halves[1].color[k];
        const Plane &ac = c[0][k], &bc = c[1][k], &ad = d[0][k], &bd = d[1][k];
        for (size_t i = 0; i < sum.size(); ++i)
            sum[i] += 0.5f * ((ac[i] - b[i]) * (ad[i] - b[i]) + (bc[i] - a[i]) * (bd[i] - a[i]));
    }
    for (size_t i = 0; i < sum.size(); ++i) sum[i] *= g[i];
    return gaussian_blur(sum, sigma);
}

/// The error of the mean of both halves; see the header.
Plane error_of_mean(const Halves& halves, const std::array<ColorPlanes, 2>& mixture,
                    const Plane& g) {
    Plane all(g.width, g.height), noise(g.width, g.height);
    for (size_t k = 0; k < 3; ++k) {
        const Plane &a = halves[0].color[k], &b = halves[1].color[k];
        const Plane &ma = mixture[0][k], &mb = mixture[1][k];
        for (size_t i = 0; i < all.size(); ++i) {
            const float scale = g[i] / 3, own = sqr(ma[i] - mb[i]) / 4;
            all[i] +=
                scale * (0.5f * (sqr(ma[i] - b[i]) + sqr(mb[i] - a[i]) - sqr(a[i] - b[i])) - own);
            noise[i] += scale * own;
        }
    }
    // Wider than the choice: this is a difference of large numbers.
    constexpr float kSigma = 6;
    all = gaussian_blur(all, kSigma);
    noise = gaussian_blur(noise, kSigma / 2);
    for (size_t i = 0; i < all.size(); ++i) all[i] = std::max(all[i], noise[i]);
    return all;
}

}  // namespace

Selection select(const Halves& halves, std::span<const Candidate> candidates,
                 const Plane& brightness, float sigma, bool mix) {
    const int w = brightness.width, h = brightness.height;
    const size_t n = candidates.size();
    const Plane g = normaliser(halves, brightness);
    std::vector<Plane> gram(n * (n + 1) / 2);
    parallel_for(int64_t(n * n), [&](int64_t pair) {
        const size_t c = size_t(pair) % n, d = size_t(pair) / n;
        if (c <= d)
            gram[entry(c, d)] = products_of_errors(halves, candidates[c], candidates[d], g, sigma);
    });

    Selection s;
    s.share.assign(n, Plane(w, h));
    parallel_for(h, [&](int64_t row) {
        for (size_t i = size_t(row) * size_t(w), end = i + size_t(w); i < end; ++i) {
            float errors[kMost][kMost], share[kMost];
            for (size_t d = 0; d < n; ++d)
                for (size_t c = 0; c <= d; ++c) errors[c][d] = errors[d][c] = gram[entry(c, d)][i];
            minimise(errors, n, mix ? kSteps : 0, share);
            for (size_t c = 0; c < n; ++c) s.share[c][i] = share[c];
        }
    });
    // Weights that jump from pixel to pixel would show as noise.
    for (Plane& p : s.share) p = gaussian_blur(p, 1);
    for (size_t k = 0; k < 2; ++k) {
        s.half[k].fill(Plane(w, h));
        for (size_t c = 0; c < n; ++c)
            for (size_t channel = 0; channel < 3; ++channel)
                for (size_t i = 0; i < g.size(); ++i)
                    s.half[k][channel][i] += s.share[c][i] * candidates[c][k][channel][i];
    }
    s.error = error_of_mean(halves, s.half, g);
    return s;
}

}  // namespace covtrace
