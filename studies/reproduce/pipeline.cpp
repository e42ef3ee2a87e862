#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reproduce/experiment.h"
#include "reproduce/panels.h"
#include "reproduce/reference.h"

namespace covtrace::reproduce {

namespace {

/// The square root of the sum of two layers: a bandwidth.
std::vector<float> bandwidth(const Image& image, const std::string& a, const std::string& b) {
    const auto &u = image.find(a)->values, &v = image.find(b)->values;
    std::vector<float> sum(u.size());
    for (size_t i = 0; i < sum.size(); ++i) sum[i] = std::sqrt(std::max(0.0f, u[i] + v[i]));
    return sum;
}

/// The whole way in one figure: 1 to 3 what the paths of the analysis say, 4 to 6 what follows from
/// it.
Figure whole_way(const Timed& timed) {
    const Image& image = timed.result.image;
    Sheet sheet({image.width(), image.height()}, 360.0f / float(image.width()), 3, 2, {true});
    const auto add = [&](int column, int row, const std::string& title,
                         const std::vector<float>& values, const std::string& unit) {
        sheet.map(column, row, title, values, map_for(values, unit));
    };
    add(0, 0, "1 covariance buffer", bandwidth(image, "cov.00", "cov.11"),
        "bandwidth, cycles per pixel");
    add(1, 0, "2 after lens and shutter", bandwidth(image, "spectrum.xx", "spectrum.yy"),
        "bandwidth, cycles per pixel");
    add(2, 0, "3 density of samples", image.find("samples.Y")->values, "samples per pixel");
    Image raw;
    raw.data = image.data;
    raw.display = image.display;
    for (const char* c : {"R", "G", "B"})
        raw.add_channel(c).values = image.find(std::string("raw.") + c)->values;
    sheet.picture(0, 1, "4 samples", display(raw));
    sheet.picture(1, 1, "5 filters", display(image, 0.5f));
    sheet.ellipses(1, 1, matrices(image, "filter."), 24, 2, kOrange);
    sheet.picture(2, 1, "6 image", display(image));
    return {"pipeline",
            fmt::format(
                "From the covariance to the image, {:.3g} samples a pixel: a few paths bring the "
                "covariance of the light field over pixel, lens and shutter (1); lens and shutter "
                "take the frequencies away that they average (2); our tempered density follows "
                "(3), the samples are taken (4), and each pixel gathers those that its filter "
                "reaches (5, at two deviations) into the image (6).",
                timed.result.statistics.samples_per_pixel),
            sheet.drawing,
            {timed.command}};
}

/// The renders of the experiment: with few samples by both densities, and by the three filters.
struct Renders {
    Timed sparse, sparse_thesis;
    Timed verified, matched, letter;
};

Renders render_all(Workshop& workshop, LoadedScene& scene) {
    RenderOptions options;
    options.method = Method::covariance;
    options.seed = workshop.settings.seeds.front();
    // The count is so low that much of the image gets less than one sample a pixel.
    options.spp = 2;
    options.cov_spp = 1;
    Renders r;
    r.sparse = workshop.render(scene, options);
    options.density = DensityRule::thesis;
    r.sparse_thesis = workshop.render(scene, options);
    options.density = DensityRule::tempered;
    options.spp = workshop.settings.spp;
    options.cov_spp.reset();
    r.verified = workshop.render(scene, options);
    options.filter = FilterRule::matched;
    r.matched = workshop.render(scene, options);
    options.filter = FilterRule::thesis;
    r.letter = workshop.render(scene, options);
    return r;
}

/// The densities that were asked for.
const std::vector<float>& density_of(const Timed& timed) {
    return timed.result.image.find("density.Y")->values;
}

double share_below_one(const std::vector<float>& counts) {
    const auto below = std::count_if(counts.begin(), counts.end(), [](float n) { return n < 1; });
    return double(below) / double(counts.size());
}

Figure buffer_figure(const Renders& r, std::array<int, 2> size) {
    const Image& image = r.verified.result.image;
    Sheet sheet(size, 540.0f / float(size[0]), 2, 3, {true, true, true});
    const auto add = [&](int column, int row, const std::string& title,
                         const std::vector<float>& values, const std::string& unit) {
        sheet.map(column, row, title, values, map_for(values, unit));
    };
    add(0, 0, "covariance buffer: image", bandwidth(image, "cov.00", "cov.11"),
        "bandwidth over the image, cycles per pixel");
    add(1, 0, "covariance buffer: lens", bandwidth(image, "cov.22", "cov.33"),
        "bandwidth over the lens, cycles per radius");
    add(0, 1, "covariance buffer: shutter", bandwidth(image, "cov.44", "cov.44"),
        "bandwidth over the shutter, cycles (times √2)");
    add(1, 1, "spectrum over the image after lens and shutter",
        bandwidth(image, "spectrum.xx", "spectrum.yy"), "bandwidth, cycles per pixel");
    add(0, 2, "our density at 2 samples a pixel", density_of(r.sparse),
        "samples per pixel that are asked for");
    add(1, 2, "the thesis' density", density_of(r.sparse_thesis),
        "samples per pixel that are asked for");
    return {"pipeline-buffer",
            "The covariance buffer, as bandwidths over image, lens and shutter (square roots of "
            "its diagonal), and the density of samples that follows from it.",
            sheet.drawing,
            {r.verified.command, r.sparse.command, r.sparse_thesis.command}};
}

Figure filters_figure(const Renders& r, std::array<int, 2> size, double spp) {
    Sheet sheet(size, 540.0f / float(size[0]), 3, 2);
    const auto show = [&](int column, const std::string& title, const Timed& timed, Ink ink) {
        const Image& image = timed.result.image;
        sheet.picture(column, 0, "filters, " + title, display(image, 0.5f));
        sheet.ellipses(column, 0, matrices(image, "filter."), 36, 1, ink);
        sheet.picture(column, 1, "image, " + title, display(image));
    };
    show(0, "verified constant", r.verified, kOrange);
    show(1, "matched, c = 1", r.matched, kCyan);
    show(2, "equation 5.7 to the letter", r.letter, kCyan);
    return {"pipeline-filters",
            fmt::format(
                "Predicted filters at one standard deviation and the images of {:g} samples a "
                "pixel: with the constant that keeps a signal of the predicted spectrum (c grows "
                "with the count; filters are limited by their neighbours, and wider along a "
                "surface where the samples say so), with the signal's own covariance (c = 1), and "
                "with equation 5.7 to the letter.",
                spp),
            sheet.drawing,
            {r.verified.command, r.matched.command, r.letter.command}};
}

void add_claims(Section& s, const Renders& r, const Reference& reference) {
    const double below = share_below_one(density_of(r.sparse)),
                 below_thesis = share_below_one(density_of(r.sparse_thesis));
    const double error = reference.error(r.verified.result.image),
                 matched_error = reference.error(r.matched.result.image),
                 letter_error = reference.error(r.letter.result.image);
    s.claims.push_back({"pipeline_below_one", "the density falls below one sample a pixel",
                        "shown in figure 5.1", "somewhere",
                        fmt::format("at 2 samples a pixel in {:.0f} % of the pixels, with the "
                                    "tempered density in {:.0f} %",
                                    100 * below_thesis, 100 * below),
                        below_thesis, below_thesis > 0, r.sparse_thesis.command});
    s.claims.push_back({"pipeline_equation_5_7",
                        "equation 5.7 to the letter, with a true covariance, smooths too much", "",
                        "a larger error than with the verified constant",
                        fmt::format("{:.5f} against {:.5f}, {:.1f} times; {:.5f} with c = 1",
                                    letter_error, error, letter_error / error, matched_error),
                        letter_error / error, letter_error > error, r.letter.command});
    s.data = {{"below_one_sample", below_thesis},
              {"below_one_sample_tempered", below},
              {"error", error},
              {"error_matched", matched_error},
              {"error_equation_5_7", letter_error}};
}

void add_notes(Section& s) {
    s.notes.push_back(
        "A pixel is asked for less than one sample, but where the mean is above one it gets one "
        "all the "
        "same: each has a covariance path, which is a sample, too. Below a mean of one (--spp 0.5) "
        "pixels "
        "without any sample are gathered from their neighbours.");
    s.notes.push_back(
        "Equation 5.7 prints exp(-π pᵀSp). With S the covariance of the spectrum in cycles per "
        "pixel "
        "that is a filter whose spectrum is narrower than the signal's by a factor of 2.5: it "
        "keeps 4 "
        "% of a sine wave at the edge of the spectrum (covariance/README.md has the constants). It "
        "would be consistent with an S that stands for 2 pi times the covariance. The text asks "
        "for "
        "the Gaussian with the signal's own covariance, exp(-2π² pᵀSp), and the author's later "
        "library filters with it (CovarianceTracing, second tutorial): --filter matched.");
}

}  // namespace

Section pipeline(Workshop& workshop) {
    Section s;
    s.name = "pipeline";
    s.title = "pipeline: from the covariance to the image (figure 5.1)";
    s.thesis =
        "Figure 5.1 of the thesis: covariance tracing fills a buffer, from which follow a density "
        "of "
        "samples, below one sample a pixel where little varies, and the filters; equation 5.7 is "
        "the "
        "filter, A exp(-π pᵀ S p).";
    LoadedScene& scene = shared_scene(workshop, kSnookerScene);
    const Reference& reference = shared_reference(workshop, kSnookerScene);
    const Renders renders = render_all(workshop, scene);
    s.resolution = scene.resolution;
    s.counts = fmt::format(
        "counts at 2 samples a pixel, all else at {:g}, seed {}; reference of 2 x {:g}",
        workshop.settings.spp, workshop.settings.seeds.front(), workshop.settings.reference_spp);
    s.figures.push_back(whole_way(renders.verified));
    s.figures.push_back(buffer_figure(renders, scene.resolution));
    s.figures.push_back(filters_figure(renders, scene.resolution, workshop.settings.spp));
    add_claims(s, renders, reference);
    add_notes(s);
    return s;
}

}  // namespace covtrace::reproduce
