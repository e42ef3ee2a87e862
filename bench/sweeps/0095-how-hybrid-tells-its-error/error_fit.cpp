// The factors of the error estimate (ErrorFactors) that fit the true errors of a set of images
// best:
//
//     error_fit none|denoiser REFERENCE.exr REFERENCE2.exr FILM [REFERENCE REFERENCE2 FILM ...]
//
// The first argument says whether the images are made with the denoiser that the program finds.
//
// The films are those of `covtrace render --method hybrid --checkpoint FILM`; the references are
// two independent converged images of the same scene and size with other seeds. Minimises over the
// tiles of all films, every film counting alike, the squared differences of true and estimated
// error relative to the estimate and to the references' noise, with factors >= 0; relative errors
// of colours and of luminances and absolute errors of luminances together. Then prints for every
// film how the luminance's relative and absolute errors are told with the factors that the films of
// all *other* references give: mean true over mean estimated squared error, in how many of 20 bins
// of tiles, sorted by the estimate, it lies between 0.7 and 1.4, and in how many it may lie there
// for all that the references can tell (two deviations of their noise).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "image/image.h"
#include "reconstruction/luminance.h"
#include "reconstruction/outliers.h"
#include "support/error_bins.h"
#include "support/hybrid_samples.h"

using namespace covtrace;

namespace {

constexpr size_t kFactors = 6;
constexpr std::array<const char*, kFactors> kNames{"noise",    "noise_of_few", "spread",
                                                   "returned", "cut",          "sights"};
using Factors = std::array<double, kFactors>;

/// One image as sums over tiles: the terms of the estimate, the truth and its variance.
struct Tiles {
    std::array<std::vector<double>, kFactors> term;
    std::vector<double> real, variance;
    double estimate(size_t tile, const Factors& f) const {
        double sum = 0;
        for (size_t k = 0; k < kFactors; ++k) sum += f[k] * term[k][tile];
        return sum;
    }
};

struct Case {
    std::string film, reference;
    Tiles color, luminance;  ///< relative
    Tiles absolute;          ///< of the luminance
    std::array<const Tiles*, 3> all() const { return {&color, &luminance, &absolute}; }
};

/// (v - a)(v - b), whose mean knows nothing of the references' noise, and half of (a - b)^2, that
/// noise.
struct Truth {
    Plane error, noise;
    void add(size_t i, float v, float a, float b, float scale) {
        error[i] += scale * (v - a) * (v - b);
        noise[i] += scale * sqr(a - b) / 2;
    }
};

/// The factor that makes squared errors relative: 1 / (I^2 + eps), I the mean of the references.
float error_scale(float a, float b) {
    return 1 / (sqr(0.5f * (a + b)) + kDarkSquared);
}

void set_truth(const Truth& truth, int side, Tiles& tiles) {
    tiles.real = tile_sums(truth.error, side);
    const std::vector<double> noise = tile_sums(truth.noise, side),
                              n = tile_sums(Plane(truth.error.width, truth.error.height, 1), side);
    for (size_t i = 0; i < noise.size(); ++i)
        tiles.variance.push_back(noise[i] * (noise[i] + 2 * std::max(0.0, tiles.real[i])) / n[i]);
}

Case load(const char* const* files, const Denoiser* denoiser) {
    Case c{files[2], files[0], {}, {}, {}};
    const std::array<Image, 2> reference{read_image(files[0]), read_image(files[1])};
    const HybridSamples samples = read_hybrid_samples(files[2]);
    const int w = samples.region.width(), h = samples.region.height(), side = tile_side(w, h);
    const size_t pixels = size_t(w) * size_t(h);
    for (const Image& r : reference)
        if (r.pixel_count() != pixels)
            throw Error(ErrorKind::usage, c.film + ": has other pixels than the references");
    float ErrorFactors::*const each[] = {&ErrorFactors::noise, &ErrorFactors::spread,
                                         &ErrorFactors::returned, &ErrorFactors::cut,
                                         &ErrorFactors::sights};
    constexpr size_t kTo[] = {0, 2, 3, 4, 5};
    Plane relative(w, h);  // relative errors of absolute ones
    for (size_t i = 0; i < pixels; ++i)
        relative[i] = error_scale(luminance(reference[0].rgb(i)), luminance(reference[1].rgb(i)));
    HybridImage image;
    for (size_t k = 0; k < 5; ++k) {
        HybridSettings settings;
        settings.denoiser = denoiser;
        settings.error = {0, 0, 0, 0, 0, 0};
        settings.error.*each[k] = 1;
        settings.error_denoised = settings.error;
        image = reconstruct(samples.halves, samples.spectrum, settings);
        c.color.term[kTo[k]] = tile_sums(image.relative_error, side);
        c.absolute.term[kTo[k]] = tile_sums(image.variance, side);
        for (size_t i = 0; i < pixels; ++i) image.variance[i] *= relative[i];
        c.luminance.term[kTo[k]] = tile_sums(image.variance, side);
    }
    for (Tiles* t : {&c.color, &c.luminance, &c.absolute})
        for (double v : t->term[0]) t->term[1].push_back(v / std::max(1.0, samples.mean_count));
    Truth color{Plane(w, h), Plane(w, h)}, bright = color, absolute = color;
    for (size_t i = 0; i < pixels; ++i) {
        const Rgb v(image.color[0][i], image.color[1][i], image.color[2][i]),
            a = reference[0].rgb(i), b = reference[1].rgb(i);
        for (int k = 0; k < 3; ++k) color.add(i, v[k], a[k], b[k], error_scale(a[k], b[k]) / 3);
        bright.add(i, luminance(v), luminance(a), luminance(b), relative[i]);
        absolute.add(i, luminance(v), luminance(a), luminance(b), 1);
    }
    set_truth(color, side, c.color);
    set_truth(bright, side, c.luminance);
    set_truth(absolute, side, c.absolute);
    return c;
}

/// Least squares with factors >= 0: those that would be negative are left out, the worst first.
Factors solve(const double (&a)[kFactors][kFactors], const Factors& b) {
    std::array<bool, kFactors> used;
    used.fill(true);
    for (;;) {
        double m[kFactors][kFactors + 1] = {};
        for (size_t i = 0; i < kFactors; ++i) {
            for (size_t j = 0; j < kFactors; ++j)
                m[i][j] = used[i] && used[j] ? a[i][j] : (i == j ? 1.0 : 0.0);
            m[i][kFactors] = used[i] ? b[i] : 0;
        }
        for (size_t i = 0; i < kFactors; ++i)
            for (size_t r = 0; r < kFactors; ++r) {
                if (r == i || m[i][i] == 0) continue;
                const double factor = m[r][i] / m[i][i];
                for (size_t j = i; j <= kFactors; ++j) m[r][j] -= factor * m[i][j];
            }
        Factors x{};
        for (size_t i = 0; i < kFactors; ++i) x[i] = m[i][i] != 0 ? m[i][kFactors] / m[i][i] : 0;
        const size_t worst = size_t(std::min_element(x.begin(), x.end()) - x.begin());
        if (!(x[worst] < 0)) return x;
        used[worst] = false;
    }
}

/// The factors that fit all cases but those of the reference `without`.
Factors fit(const std::vector<Case>& cases, const std::string& without) {
    Factors f{1, 10, 1, 0.5, 0.005, 1};
    // The weights follow the estimate, so it is done again until nothing changes.
    for (int step = 0; step < 30; ++step) {
        double a[kFactors][kFactors] = {};
        Factors b{};
        for (const Case& c : cases) {
            if (c.reference == without) continue;
            for (const Tiles* t : c.all())
                for (size_t i = 0; i < t->real.size(); ++i) {
                    // An error below this, relative or of light that is 1, is seen by nobody.
                    constexpr double kLeast = 1e-6 * 256;
                    const double weight =
                        1 / ((sqr(t->estimate(i, f)) + t->variance[i] + sqr(kLeast)) *
                             double(t->real.size()));
                    for (size_t j = 0; j < kFactors; ++j) {
                        for (size_t k = 0; k < kFactors; ++k)
                            a[j][k] += weight * t->term[j][i] * t->term[k][i];
                        b[j] += weight * t->term[j][i] * t->real[i];
                    }
                }
        }
        const Factors next = solve(a, b);
        for (size_t k = 0; k < kFactors; ++k) f[k] = 0.5 * (f[k] + next[k]);
    }
    return f;
}

/// The number of bins in which the ratio may be right, given the truth's own noise.
int may_be_good(const Tiles& tiles, const Factors& f) {
    std::vector<size_t> order(tiles.real.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(),
              [&](size_t a, size_t b) { return tiles.estimate(a, f) < tiles.estimate(b, f); });
    int good = 0;
    for (size_t bin = 0; bin < kErrorBins; ++bin) {
        double estimated = 0, real = 0, variance = 0;
        for (size_t k = bin * order.size() / kErrorBins; k < (bin + 1) * order.size() / kErrorBins;
             ++k) {
            estimated += tiles.estimate(order[k], f);
            real += tiles.real[order[k]];
            variance += tiles.variance[order[k]];
        }
        const double slack = 2 * std::sqrt(variance);
        if ((real + slack) / estimated >= 0.7 && (real - slack) / estimated <= 1.4) ++good;
    }
    return good;
}

ErrorBins bins(const Tiles& t, const Factors& f) {
    std::vector<ErrorTile> tiles;
    for (size_t i = 0; i < t.real.size(); ++i) tiles.push_back({t.estimate(i, f), t.real[i], 1});
    return error_bins(tiles);
}

void print(const Case& c, const Factors& f) {
    double color = 0, told = 0;
    for (size_t i = 0; i < c.color.real.size(); ++i) {
        color += c.color.real[i];
        told += c.color.estimate(i, f);
    }
    fmt::print("{:<40} {:5.2f}", c.film, color / told);
    for (const Tiles* t : {&c.luminance, &c.absolute}) {
        const ErrorBins b = bins(*t, f);
        fmt::print(" {:8.2f} {:3} {:3}", b.all.ratio(), b.good, may_be_good(*t, f));
    }
    fmt::print("\n");
}

}  // namespace

int main(int argc, char** argv) {
    const std::string with = argc > 1 ? argv[1] : "";
    if (argc < 5 || argc % 3 != 2 || (with != "none" && with != "denoiser")) {
        fmt::print(stderr, "usage: error_fit none|denoiser REFERENCE REFERENCE2 FILM [...]\n");
        return 2;
    }
    try {
        std::vector<Case> cases;
        const auto denoiser = with == "denoiser" ? required_denoiser() : nullptr;
        for (int i = 2; i < argc; i += 3) cases.push_back(load(argv + i, denoiser.get()));
        const Factors all = fit(cases, "");
        for (size_t k = 0; k < kFactors; ++k) fmt::print("{} {:.4f}\n", kNames[k], all[k]);
        fmt::print("{:<40} {:>5} {:>16} {:>16}\n", "told by the other scenes' fit", "RGB",
                   "Y relative of 20", "Y absolute of 20");
        for (const Case& c : cases) print(c, fit(cases, c.reference));
    } catch (const std::exception& e) {
        fmt::print(stderr, "error_fit: {}\n", e.what());
        return 1;
    }
}
