// Sweeps the constants of the reconstruction filter over finished renders, without rendering again:
//
//     filter_sweep IMAGE.exr REFERENCE.exr [IMAGE.exr REFERENCE.exr ...]
//
// IMAGE holds the layers all,inview,inviewfilter,scatteredcov,scatteredcovweight of `render
// --method covariance`. Prints trimmed relMSE per image and the geometric mean over the images, for
// the width factor c, the narrowest deviation s_min and the slope by which a filter may widen away
// from a narrower one (docs/decisions/0004); and for widths that follow the pixel's own count and
// N_int (docs/decisions/archive/0059).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "image/compare.h"
#include "reconstruction/gather.h"
#include "support/predicted_image.h"

using namespace covtrace;

namespace {

struct Case {
    PredictedImage rendered;
    Image reference;
};

/// Exponents by which a pixel's c follows the pixel, beside the settings: (its samples over the
/// average)^own_count, its N_int^interior.
struct OwnWidth {
    float own_count = 0, interior = 0;
};

/// The samples per pixel that would give a filtered pixel its variance, from the counts under the
/// filter.
std::vector<float> effective_counts(const PredictedImage& r, FilterField field) {
    std::vector<Rgb> inverse(r.count.size());
    for (size_t i = 0; i < inverse.size(); ++i)
        inverse[i] = Rgb(1 / float(std::max(1u, r.count[i])));
    for (auto& s : field.covariance) s = 0.5f * s;  // of the squared weights
    const std::vector<float> no_variance(inverse.size(), 0.0f);
    const std::vector<uint32_t> one(inverse.size(), 1);
    const FilteredImage means = gather(inverse, no_variance, one, field);
    std::vector<float> counts(inverse.size());
    for (size_t i = 0; i < counts.size(); ++i) counts[i] = 1 / means.color[i].r;
    return counts;
}

void narrow(FilterField& field, const PredictedImage& r, const FilterSettings& settings,
            const OwnWidth& own) {
    if (own.own_count == 0 && own.interior == 0) return;
    const std::vector<float> counts = effective_counts(r, field);
    double average = 0;
    for (const uint32_t n : r.count) average += n / double(r.count.size());
    for (size_t i = 0; i < counts.size(); ++i) {
        const float c = std::pow(counts[i] / float(average), own.own_count) *
                        std::pow(r.prediction.interior_count[i], own.interior);
        // The floor narrows with the filters, as it does with the count.
        field.covariance[i] = covariance::clamp_eigenvalues(1 / (c * c) * field.covariance[i],
                                                            sqr(0.1f), sqr(settings.limits.s_max));
    }
}

/// `in_view`: factor on the deviations of the filters of emitters in view.
double error(const Case& c, const FilterSettings& settings, float in_view, const OwnWidth& own) {
    const PredictedImage& r = c.rendered;
    FilterField field = filter_field(r.prediction.spectrum, r.prediction.width, r.prediction.height,
                                     FilterRule::verified, settings);
    std::vector<float> beside(r.count.size(), kInfinity);
    for (size_t i = 0; i < beside.size(); ++i)
        if (r.shows_emitter[i])
            beside[i] = std::max(settings.limits.s_min,
                                 covariance::filter_size(r.in_view_filters.covariance[i]));
    limit_by_neighbours(field, settings, beside);
    narrow(field, r, settings, own);
    FilterField emitters = r.in_view_filters;
    for (auto& s : emitters.covariance)
        s = covariance::clamp_eigenvalues(in_view * in_view * s,
                                          sqr(covariance::filter_settings_in_view(16).limits.s_min),
                                          sqr(15.0f));
    const std::vector<float> no_variance(r.count.size(), 0.0f);
    const auto scattered = gather(r.scattered, no_variance, r.count, field).color;
    const auto seen = gather(r.in_view, no_variance, r.count, emitters).color;
    Image result;
    result.data = c.rendered.image.data;
    result.display = c.rendered.image.display;
    for (int k = 0; k < 3; ++k) {
        Channel& out = result.add_channel(std::string(1, "RGB"[k]));
        for (size_t i = 0; i < scattered.size(); ++i) out.values[i] = scattered[i][k] + seen[i][k];
    }
    return compare(result, c.reference).relmse_trimmed;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3 || argc % 2 == 0) {
        fmt::print(stderr, "usage: filter_sweep IMAGE REFERENCE [IMAGE REFERENCE ...]\n");
        return 2;
    }
    try {
        std::vector<Case> cases;
        for (int i = 1; i < argc; i += 2)
            cases.push_back({read_predicted_image(argv[i]), read_image(argv[i + 1])});
        const auto print = [&](const FilterSettings& settings, float in_view,
                               const OwnWidth& own = {}) {
            double log_sum = 0;
            std::string each;
            for (const Case& k : cases) {
                const double e = error(k, settings, in_view, own);
                log_sum += std::log(e);
                each += fmt::format(" {:8.1f}", 1e5 * e);
            }
            fmt::print("{:5.2f} {:6.2f} {:6.2f} {:8.2f} {:6.2f} {:6.2f} {:15.6f} {}\n", settings.c,
                       settings.limits.s_min, settings.slope, in_view, own.own_count, own.interior,
                       std::exp(log_sum / double(cases.size())), each);
        };
        fmt::print(
            "    c  s_min  slope  in view  count  N_int  geometric mean   relMSE x 1e5 per "
            "image\n");
        double samples = 0;  // of all images the same, or the last table means nothing
        for (const uint32_t n : cases[0].rendered.count)
            samples += n / double(cases[0].rendered.count.size());
        for (float factor : {0.9f, 1.0f, 1.1f, 1.2f})
            for (const OwnWidth& own : {OwnWidth{0, 0}, OwnWidth{1.0f / 12, 0},
                                        OwnWidth{1.0f / 6, 0}, OwnWidth{0, -1.0f / 12},
                                        OwnWidth{1.0f / 6, -1.0f / 12}, OwnWidth{0, -1.0f / 6}}) {
                const FilterSettings rule = covariance::filter_settings(samples);
                const float c = factor * rule.c;
                print({c, {1 / c, rule.limits.s_max}, covariance::edge_beta<float> / c}, 1, own);
            }
        for (float c : {1.5f, 2.0f, 2.5f, 3.0f})
            for (float s_min : {0.32f, 0.4f, 0.5f, 0.6f})
                for (float slope : {0.05f, 0.1f, 0.2f, 0.4f, 0.8f})
                    print({c, {s_min, 15}, slope}, 1);
        for (float in_view : {2.0f, 1.4f, 1.0f, 0.71f, 0.5f, 0.35f, 0.25f, 0.0f})
            print(FilterSettings{}, in_view);
    } catch (const std::exception& e) {
        fmt::print(stderr, "filter_sweep: {}\n", e.what());
        return 1;
    }
}
