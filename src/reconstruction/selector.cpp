#include "reconstruction/selector.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/vec.h"
#include "reconstruction/coarse_to_fine.h"
#include "reconstruction/luminance.h"

namespace covtrace {

namespace {

constexpr size_t kMost = 12;        // most candidates
constexpr size_t kMostAlso = 2;     // most other planes that are summed
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

/// Mixes the candidates with shares from G: `gram(x, y, sums)` gives its entries for a pixel and,
/// after them, the sums of `also` other planes. Pixels that are `alike` to those around them have
/// the mean of their shares and sums.
template <typename Gram, typename Alike>
Selection mixed(std::span<const Candidate> candidates, size_t also, int w, int h, bool mix,
                const Gram& gram, const Alike& alike) {
    const size_t n = candidates.size(), entries = n * (n + 1) / 2;
    Selection s;
    s.share.assign(n, Plane(w, h));
    s.around.assign(also, Plane(w, h));
    const auto judge = [&](int x, int y) {
        float sums[kMost * (kMost + 1) / 2 + kMostAlso], errors[kMost][kMost], share[kMost];
        gram(x, y, sums);
        for (size_t d = 0; d < n; ++d)
            for (size_t c = 0; c <= d; ++c) errors[c][d] = errors[d][c] = sums[entry(c, d)];
        minimise(errors, n, mix ? kSteps : 0, share);
        for (size_t c = 0; c < n; ++c) s.share[c](x, y) = share[c];
        for (size_t k = 0; k < also; ++k) s.around[k](x, y) = sums[entries + k];
    };
    coarse_to_fine(w, h, judge, alike, [&](int x, int y, int left, int top, int right, int bottom) {
        for (std::vector<Plane>* planes : {&s.share, &s.around})
            for (Plane& p : *planes)
                p(x, y) =
                    0.25f * ((p(left, top) + p(right, top)) + (p(left, bottom) + p(right, bottom)));
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
    return mixed(candidates, 0, w, h, mix, sums, [mix](int, int, int, int) { return mix; });
}

Selection select(const Halves& halves, std::span<const Candidate> candidates, const ColorPlanes& g,
                 const Likeness& likeness, bool mix, std::span<const Plane> also) {
    const int w = g[0].width, h = g[0].height;
    const size_t n = candidates.size();
    std::vector<MarginPlane> gram(n * (n + 1) / 2, MarginPlane(w, h));
    for_pairs(n, [&](size_t c, size_t d, size_t e) {
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x)
                gram[e](x, y) = product_of_errors(halves, candidates[c], candidates[d], g,
                                                  size_t(y) * size_t(w) + size_t(x));
    });
    for (const Plane& plane : also) gram.emplace_back(plane);
    const auto sums = [&](int x, int y, float* entries) {
        Likeness::Window weights;
        likeness.weigh(x, y, weights);
        weighted_sums(gram, weights, x, y, entries);
    };
    // Means are for mixtures alone: the best single candidates of pixels have none.
    const auto alike = [&](int x, int y, int u, int v) {
        return mix && likeness.are_alike(x, y, u, v);
    };
    return mixed(candidates, also.size(), w, h, mix, sums, alike);
}

}  // namespace covtrace
