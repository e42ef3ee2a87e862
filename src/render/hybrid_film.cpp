#include "render/hybrid_film.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "core/hash.h"
#include "core/parallel.h"

namespace covtrace {

uint64_t hybrid_seed(uint64_t seed) {
    return hash_combine(seed, 0x68616c66, 0);
}

uint32_t place_in_sequence(uint32_t half, uint32_t index) {
    // Blocks have kFirstBlock samples at first, then as many as came before.
    const bool first = index < kFirstBlock;
    const uint32_t size = std::max(kFirstBlock, std::bit_floor(index));
    const uint32_t within = first ? index : index - size, begin = first ? 0 : 2 * size;
    return half == 0 ? begin + within : begin + 2 * size - 1 - within;
}

Film merged(std::span<const Film> half) {
    Film film(half[0].bounds);
    if (!half[0].features.empty()) film.features.resize(film.pixels.size());
    if (!half[0].surfaces.empty()) film.surfaces.resize(film.pixels.size());
    if (!half[0].opacity.empty()) film.opacity.resize(film.pixels.size());
    for (size_t i = 0; i < film.pixels.size(); ++i) {
        const FilmPixel &a = half[0].pixels[i], &b = half[1].pixels[i];
        FilmPixel& p = film.pixels[i];
        if (a.count == 0 || b.count == 0) {
            p = a.count == 0 ? b : a;
            const Film& whole = half[a.count == 0 ? 1 : 0];
            if (!film.features.empty()) film.features[i] = whole.features[i];
            if (!film.surfaces.empty()) film.surfaces[i] = whole.surfaces[i];
            if (!film.opacity.empty()) film.opacity[i] = whole.opacity[i];
            continue;
        }
        p.count = a.count + b.count;
        p.mean = 0.5f * (a.mean + b.mean);
        const float n = float(p.count);
        // The squares are those that give the variance of a mean with weights 1/2 each.
        p.squares = 0.25f * (a.variance_of_mean() + b.variance_of_mean()) * (n * (n - 1));
        p.albedo = 0.5f * (a.albedo + b.albedo);
        p.normal = 0.5f * (a.normal + b.normal);
        p.coverage = 0.5f * (a.coverage + b.coverage);
        if (!film.opacity.empty())
            film.opacity[i] = 0.5f * (half[0].opacity[i] + half[1].opacity[i]);
        const float hit = a.coverage + b.coverage;
        const auto of_hits = [&](auto of_a, auto of_b) {
            return hit > 0 ? (a.coverage * of_a + b.coverage * of_b) / hit : decltype(of_a){};
        };
        p.depth = of_hits(a.depth, b.depth);
        if (!film.surfaces.empty()) {
            film.surfaces[i] = half[0].surfaces[i];
            film.surfaces[i].approach(half[1].surfaces[i], hit > 0 ? b.coverage / hit : 0.0f);
        }
        if (film.features.empty()) continue;
        const PathFeatures &fa = half[0].features[i], &fb = half[1].features[i];
        film.features[i] = {0.5f * (fa.albedo + fb.albedo), 0.5f * (fa.normal + fb.normal),
                            of_hits(fa.depth, fb.depth)};
    }
    return film;
}

namespace {

/// Variances of the mean from sums of squared deviations. A pixel with a single sample knows
/// nothing of its own spread: the spread of the 7 x 7 pixels around it stands in, and counts in
/// every pixel as one more sample.
class PooledVariance {
  public:
    explicit PooledVariance(const Film& film)
        : film_(film), freedom_(film.bounds.width(), film.bounds.height()) {
        for (size_t i = 0; i < freedom_.size(); ++i)
            freedom_[i] = film.pixels[i].count > 1 ? float(film.pixels[i].count - 1) : 0.0f;
        around_ = box_blur(freedom_, kReach);
    }
    /// The variances, from squares(i), the sum of squared deviations of pixel i.
    template <typename Squares>
    Plane operator()(const Squares& squares) const {
        Plane sum(freedom_.width, freedom_.height);
        for (size_t i = 0; i < sum.size(); ++i) sum[i] = squares(i);
        const Plane pooled = box_blur(sum, kReach);
        for (size_t i = 0; i < sum.size(); ++i) {
            const float spread = around_[i] > 0 ? pooled[i] / around_[i] : 0.0f;
            const float count = float(film_.pixels[i].count);
            sum[i] = count > 0 ? (sum[i] + spread) / ((freedom_[i] + 1) * count) : spread;
        }
        return sum;
    }

  private:
    static constexpr int kReach = 3;
    const Film& film_;
    Plane freedom_, around_;
};

void fill(HalfBuffer& out, const Film& film) {
    const PooledVariance variance(film);
    const auto& pixels = film.pixels;
    const std::vector<PathFeatures>& features = film.features;
    const std::vector<FeatureSquares>& squares = film.feature_squares;
    for (size_t i = 0; i < pixels.size(); ++i) {
        const FilmPixel& p = pixels[i];
        const PathFeatures& f = features[i];
        out.count[i] = float(p.count);
        for (int c = 0; c < 3; ++c) {
            out.color[size_t(c)][i] = p.mean[c];
            out.feature[size_t(c)][i] = f.albedo[c];
        }
        out.feature[3][i] = f.normal.x;
        out.feature[4][i] = f.normal.y;
        out.feature[5][i] = f.normal.z;
        out.feature[6][i] = f.depth > 0 ? std::log(f.depth) : 0.0f;
    }
    for (int c = 0; c < 3; ++c) {
        out.color_variance[size_t(c)] = variance([&](size_t i) { return pixels[i].squares[c]; });
        out.feature_variance[size_t(c)] = variance([&](size_t i) { return squares[i].albedo[c]; });
    }
    out.feature_variance[3] = variance([&](size_t i) { return squares[i].normal / 3; });
    out.feature_variance[4] = out.feature_variance[5] = out.feature_variance[3];
    out.feature_variance[6] = variance([&](size_t i) {
        const float z = features[i].depth;
        return z > 0 ? squares[i].depth / (z * z) : 0.0f;  // variance of the logarithm
    });
}

/// Whether some pixel of a half has more than `count` samples.
bool has_more_than(uint32_t count, const Film& half) {
    return std::any_of(half.pixels.begin(), half.pixels.end(),
                       [count](const FilmPixel& p) { return p.count > count; });
}

/// Gives pixel i of one half, with its samples, to the other one, which has none there.
void move_pixel(size_t i, HalfBuffer& from, HalfBuffer& to) {
    to.count[i] = std::exchange(from.count[i], 0.0f);
    for (size_t c = 0; c < 3; ++c) {
        to.color[c][i] = from.color[c][i];
        to.color_variance[c][i] = from.color_variance[c][i];
    }
    for (size_t f = 0; f < kFeatures; ++f) {
        to.feature[f][i] = from.feature[f][i];
        to.feature_variance[f][i] = from.feature_variance[f][i];
    }
}

/// Gives the second half every second one of the pixels that the first one alone has, along rows
/// and from row to row: like a checkerboard where those are all pixels, and some of them where they
/// are a checkerboard themselves.
void deal(Halves& halves) {
    size_t rows = 0;  // rows with such pixels so far
    for (int y = 0; y < halves[0].count.height; ++y) {
        size_t turn = rows;
        for (int x = 0; x < halves[0].count.width; ++x) {
            if (halves[0].count(x, y) == 0 || halves[1].count(x, y) > 0) continue;
            if (turn++ % 2 == 1)
                move_pixel(size_t(y) * size_t(halves[0].count.width) + size_t(x), halves[0],
                           halves[1]);
        }
        rows += turn > rows ? 1 : 0;
    }
}

}  // namespace

Halves halves_of(std::span<const Film> film) {
    const int w = film[0].bounds.width(), h = film[0].bounds.height();
    Halves halves{HalfBuffer(w, h), HalfBuffer(w, h)};
    parallel_for(2, [&](int64_t k) { fill(halves[size_t(k)], film[size_t(k)]); });
    const bool first_alone = !has_more_than(0, film[1]);
    deal(halves);
    if (!has_more_than(1, film[0]) || !(first_alone || has_more_than(1, film[1]))) {
        // A black hole would count as a difference, and so would an empty half
        for (HalfBuffer& half : halves) fill_holes(half);
        replace_empty_half(halves);
        set_variance_from_difference(halves);
    }
    return halves;
}

}  // namespace covtrace
