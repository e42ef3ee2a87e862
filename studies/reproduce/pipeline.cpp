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
                "take the frequencies away that they average (2); the density follows (3), the "
                "samples are taken (4), and each pixel gathers those that its filter reaches (5, "
                "at two deviations) into the image (6).",
                timed.result.statistics.samples_per_pixel),
            sheet.drawing,
            {timed.command}};
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
        "filter, A exp(-pi p' S p).";
    LoadedScene& scene = shared_scene(workshop, kSnookerScene);
    const Reference& reference = shared_reference(workshop, kSnookerScene);
    RenderOptions options;
    options.method = Method::covariance;
    options.seed = workshop.settings.seeds.front();
    // The count is so low that much of the image gets less than one sample a pixel.
    options.spp = 2;
    options.cov_spp = 1;
    const Timed sparse = workshop.render(scene, options);
    options.density = DensityRule::thesis;
    const Timed sparse_thesis = workshop.render(scene, options);
    options.density = DensityRule::tempered;
    options.spp = workshop.settings.spp;
    options.cov_spp.reset();
    const Timed verified = workshop.render(scene, options);
    options.filter = FilterRule::matched;
    const Timed matched = workshop.render(scene, options);
    options.filter = FilterRule::thesis;
    const Timed letter = workshop.render(scene, options);

    const auto size = scene.resolution;
    s.resolution = size;
    const Image &image = verified.result.image, &few = sparse.result.image;
    s.figures.push_back(whole_way(verified));
    Sheet buffer(size, 540.0f / float(size[0]), 2, 3, {true, true, true});
    const auto add = [&](int column, int row, const std::string& title,
                         const std::vector<float>& values, const std::string& unit) {
        buffer.map(column, row, title, values, map_for(values, unit));
    };
    add(0, 0, "covariance buffer: image", bandwidth(image, "cov.00", "cov.11"),
        "bandwidth over the image, cycles per pixel");
    add(1, 0, "covariance buffer: lens", bandwidth(image, "cov.22", "cov.33"),
        "bandwidth over the lens, cycles per radius");
    add(0, 1, "covariance buffer: shutter", bandwidth(image, "cov.44", "cov.44"),
        "bandwidth over the shutter, cycles (times √2)");
    const auto &asked = few.find("density.Y")->values,
               &asked_thesis = sparse_thesis.result.image.find("density.Y")->values;
    add(1, 1, "spectrum over the image after lens and shutter",
        bandwidth(image, "spectrum.xx", "spectrum.yy"), "bandwidth, cycles per pixel");
    add(0, 2, "our density at 2 samples a pixel", asked, "samples per pixel that are asked for");
    add(1, 2, "the thesis' density", asked_thesis, "samples per pixel that are asked for");
    const auto share_below_one = [](const std::vector<float>& counts) {
        const auto below =
            std::count_if(counts.begin(), counts.end(), [](float n) { return n < 1; });
        return double(below) / double(counts.size());
    };
    const double below = share_below_one(asked), below_thesis = share_below_one(asked_thesis);
    s.figures.push_back(
        {"pipeline-buffer",
         "The covariance buffer, as bandwidths over image, lens and shutter (square "
         "roots of its diagonal), and the density of samples that follows from it.",
         buffer.drawing,
         {verified.command, sparse.command, sparse_thesis.command}});

    Sheet filters(size, 540.0f / float(size[0]), 3, 2);
    const auto show = [&](int column, const std::string& title, const Image& i, Ink ink) {
        filters.picture(column, 0, "filters, " + title, display(i, 0.5f));
        filters.ellipses(column, 0, matrices(i, "filter."), 36, 1, ink);
        filters.picture(column, 1, "image, " + title, display(i));
    };
    show(0, "verified constant", image, kOrange);
    show(1, "matched, c = 1", matched.result.image, kCyan);
    show(2, "equation 5.7 to the letter", letter.result.image, kCyan);
    s.figures.push_back(
        {"pipeline-filters",
         fmt::format(
             "Filters at one standard deviation and the images that they make of {:g} samples "
             "a pixel: with the constant that keeps a signal of the predicted spectrum "
             "(c grows with the count, filters limited by their neighbours), with the signal's "
             "own covariance (c = 1), and with equation 5.7 to the letter.",
             workshop.settings.spp),
         filters.drawing,
         {verified.command, matched.command, letter.command}});

    const double error = reference.error(image),
                 matched_error = reference.error(matched.result.image),
                 letter_error = reference.error(letter.result.image);
    s.claims.push_back({"pipeline_below_one", "the density falls below one sample a pixel",
                        "shown in figure 5.1", "somewhere",
                        fmt::format("at 2 samples a pixel in {:.0f} % of the pixels, with the "
                                    "tempered density in {:.0f} %",
                                    100 * below_thesis, 100 * below),
                        below_thesis, below_thesis > 0, sparse_thesis.command});
    s.claims.push_back({"pipeline_equation_5_7",
                        "equation 5.7 to the letter, with a true covariance, smooths too much", "",
                        "a larger error than with the verified constant",
                        fmt::format("{:.5f} against {:.5f}, {:.1f} times; {:.5f} with c = 1",
                                    letter_error, error, letter_error / error, matched_error),
                        letter_error / error, letter_error > error, letter.command});
    s.notes.push_back(
        "A pixel is asked for less than one sample, but where the mean is above one it gets one "
        "all the "
        "same: each has a covariance path, which is a sample, too. Below a mean of one (--spp 0.5) "
        "pixels "
        "without any sample are gathered from their neighbours.");
    s.notes.push_back(
        "Equation 5.7 prints exp(-pi p'Sp). With S the covariance of the spectrum in cycles per "
        "pixel "
        "that is a filter whose spectrum is narrower than the signal's by a factor of 2.5: it "
        "keeps 4 "
        "% of a sine wave at the edge of the spectrum (covariance/README.md has the constants). It "
        "would be consistent with an S that stands for 2 pi times the covariance. The text asks "
        "for "
        "the Gaussian with the signal's own covariance, exp(-2 pi² p'Sp), and the author's library "
        "filters with it (CovarianceTracing, second tutorial): --filter matched.");
    s.data = {{"below_one_sample", below_thesis},
              {"below_one_sample_tempered", below},
              {"error", error},
              {"error_matched", matched_error},
              {"error_equation_5_7", letter_error}};
    return s;
}

}  // namespace covtrace::reproduce
