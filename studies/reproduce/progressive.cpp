#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reproduce/experiment.h"
#include "reproduce/panels.h"
#include "reproduce/search.h"
#include "reproduce/statistics.h"

namespace covtrace::reproduce {

namespace {

/// The part of the image, a fifth of each side, where the limit of samples withholds most: the
/// largest mean of the share of the asked samples that a pixel did not get. Shares are compared,
/// not the samples themselves: a few pixels, where single paths found an enormous N_int, are asked
/// for more samples than all others together.
PixelBounds most_withheld(const Image& capped) {
    const int w = capped.width(), h = capped.height();
    const auto &asked = capped.find("density.Y")->values, &taken = capped.find("samples.Y")->values;
    // Sums over all pixels above and left.
    std::vector<double> sums(size_t(w + 1) * size_t(h + 1), 0);
    const auto sum = [&](int x, int y) -> double& {
        return sums[size_t(y) * size_t(w + 1) + size_t(x)];
    };
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            const size_t i = size_t(y) * size_t(w) + size_t(x);
            const double withheld =
                asked[i] > taken[i] ? 1 - double(taken[i]) / double(asked[i]) : 0.0;
            sum(x + 1, y + 1) = withheld + sum(x, y + 1) + sum(x + 1, y) - sum(x, y);
        }
    const int bw = std::max(1, w / 5), bh = std::max(1, h / 5);
    PixelBounds best{0, 0, bw, bh};
    double most = -1;
    for (int y = 0; y + bh <= h; ++y)
        for (int x = 0; x + bw <= w; ++x) {
            const double withheld =
                sum(x + bw, y + bh) - sum(x, y + bh) - sum(x + bw, y) + sum(x, y);
            if (withheld <= most) continue;
            most = withheld;
            best = {x, y, x + bw, y + bh};
        }
    return best;
}

/// Renders with all seeds; errors in the inset beside those of the image.
struct Run {
    std::vector<double> inset, image, cpu;
    Timed first;
};

Run run(Workshop& workshop, LoadedScene& scene, const Reference& reference, RenderOptions options,
        const PixelBounds& inset) {
    Run r;
    for (const uint64_t seed : workshop.settings.seeds) {
        options.seed = seed;
        Timed timed = workshop.render(scene, options);
        r.inset.push_back(reference.error(timed.result.image, inset));
        r.image.push_back(reference.error(timed.result.image));
        r.cpu.push_back(timed.cpu);
        if (seed == workshop.settings.seeds.front()) r.first = std::move(timed);
    }
    return r;
}

Table table_of(const Run& capped, const Run& demand) {
    Table t{"Means over the seeds",
            {"run", "CPU seconds", "error in the inset", "error of the image"},
            {},
            {capped.first.command, demand.first.command}};
    t.rows.push_back({"with the limit", fmt::format("{:.2f}", mean(capped.cpu)),
                      fmt::format("{:.5f}", mean(capped.inset)),
                      fmt::format("{:.5f}", mean(capped.image))});
    t.rows.push_back({"on demand", fmt::format("{:.2f}", mean(demand.cpu)),
                      fmt::format("{:.5f}", mean(demand.inset)),
                      fmt::format("{:.5f}", mean(demand.image))});
    return t;
}

}  // namespace

Section progressive(Workshop& workshop) {
    Section s;
    s.name = "progressive";
    s.title = "progressive: what the limit of samples leaves behind (section 5.1.3)";
    s.thesis =
        "The thesis limits the samples of a pixel, which leaves noise where the prediction asks "
        "for "
        "more, in its figure on a defocused glossy ball, and proposes a progressive method: sample "
        "again, on demand, the pixels that lack most.";
    LoadedScene& scene = shared_scene(workshop, kSnookerScene);
    const Reference& reference = shared_reference(workshop, kSnookerScene);
    RenderOptions options;
    options.method = Method::covariance;
    options.spp = workshop.settings.spp;
    options.density = DensityRule::thesis;
    options.max_spp = int(std::ceil(1.5 * workshop.settings.spp));
    workshop.tell("progressive: with the limit, and on demand");
    options.seed = workshop.settings.seeds.front();
    const PixelBounds inset = most_withheld(workshop.render(scene, options).result.image);
    const Run capped = run(workshop, scene, reference, options, inset);
    options.progressive = true;
    Run demand = run(workshop, scene, reference, options, inset);
    constexpr int kCorrections = 2;
    for (int k = 0; k < kCorrections && std::abs(mean(demand.cpu) / mean(capped.cpu) - 1) > 0.03;
         ++k) {
        options.spp = *options.spp * mean(capped.cpu) / mean(demand.cpu);
        demand = run(workshop, scene, reference, options, inset);
    }

    const auto size = scene.resolution;
    s.resolution = size;
    s.counts = fmt::format("{:g} samples a pixel with the limit, seeds {}; reference of 2 x {:g}",
                           workshop.settings.spp, text_of(workshop.settings.seeds),
                           workshop.settings.reference_spp);
    const Image &a = capped.first.result.image, &b = demand.first.result.image;
    Sheet sheet(size, 540.0f / float(size[0]), 2, 2, {false, true});
    const std::vector<std::string> commands{capped.first.command, demand.first.command};
    sheet.picture(0, 0, fmt::format("at most {} samples", *options.max_spp), display(a));
    sheet.picture(1, 0, "on demand, the same time", display(b));
    const auto &samples_a = a.find("samples.Y")->values, &samples_b = b.find("samples.Y")->values;
    const ColourMap map = map_for(samples_b, "samples per pixel");
    sheet.map(0, 1, "samples with the limit", samples_a, map);
    sheet.map(1, 1, "samples on demand", samples_b, map);
    for (int row = 0; row < 2; ++row)
        for (int column = 0; column < 2; ++column) sheet.mark(column, row, inset, kRed);
    s.figures.push_back(
        {"progressive",
         fmt::format(
             "The thesis' density with a limit of {} samples a pixel, and the same time spent "
             "in rounds that sample on demand. The frame is the part of the image, a fifth of each "
             "side, where the limit withholds the largest share of what the density asks for.",
             *options.max_spp),
         sheet.drawing, commands});
    s.figures.push_back(
        {"progressive-inset", "That part, magnified.",
         crops({{"with the limit", &a}, {"on demand", &b}, {"reference", &reference.mean()}},
               {{inset, kRed}}, 1120),
         commands});
    s.tables.push_back(table_of(capped, demand));
    const Spread r = ratios(demand.inset, capped.inset);
    s.claims.push_back(
        {"progressive_inset", "in the same time, the error of the inset falls by half or more",
         "proposed, not measured", "at most 0.5 of the run with the limit",
         r.text() + fmt::format(" of it; times equal within {:.1f} %",
                                100 * std::abs(mean(demand.cpu) / mean(capped.cpu) - 1)),
         r.mean, r.mean <= 0.5, commands[1]});
    s.data = {{"inset", {inset.x0, inset.y0, inset.x1, inset.y1}},
              {"capped", {{"inset", capped.inset}, {"image", capped.image}, {"cpu", capped.cpu}}},
              {"demand", {{"inset", demand.inset}, {"image", demand.image}, {"cpu", demand.cpu}}}};
    return s;
}

}  // namespace covtrace::reproduce
