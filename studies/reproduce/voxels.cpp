#include <fmt/format.h>

#include <cmath>

#include "reproduce/experiment.h"
#include "reproduce/panels.h"
#include "reproduce/search.h"

namespace covtrace::reproduce {

namespace {

constexpr std::array<int, 5> kWidths{25, 50, 100, 200, 400};

/// Mean size of the filters of all pixels, in the logarithm.
double mean_size(const std::vector<float>& sizes) {
    double sum = 0;
    for (const float s : sizes) sum += std::log(double(s));
    return std::exp(sum / double(sizes.size()));
}

/// CPU seconds that learning of occluders and the covariance paths took: phases are measured by
/// the clock, their shares of the render's CPU time are taken alike.
double occluder_seconds(const Timed& timed) {
    const auto& seconds = timed.result.statistics.seconds;
    double sum = 0;
    for (const Phase phase : {Phase::grid, Phase::outlines, Phase::covariance})
        if (const auto found = seconds.find(phase); found != seconds.end()) sum += found->second;
    return sum * timed.cpu / timed.wall;
}

struct Kind {
    std::string label;
    RenderOptions options;
};

/// The ways to find occluders: every voxel of the grid as in Belcour 2012, our use of the grid, and
/// the query, in this order.
std::vector<Kind> kinds(const Workshop& workshop) {
    std::vector<Kind> list;
    RenderOptions o;
    o.method = Method::covariance;
    o.spp = workshop.settings.spp;
    for (const Occlusion occlusion : {Occlusion::voxels, Occlusion::grid})
        for (const int width : kWidths) {
            o.occlusion = occlusion;
            o.voxels = width;
            list.push_back(
                {fmt::format("{}, {} wide", occlusion == Occlusion::voxels ? "every voxel" : "grid",
                             width),
                 o});
        }
    o = {};
    o.method = Method::covariance;
    o.spp = workshop.settings.spp;
    list.push_back({"direct query", o});
    return list;
}

/// Renders and filters of every kind.
struct Measured {
    std::vector<Kind> kinds;
    std::vector<Sampled> sampled;
    std::vector<std::vector<float>> sizes;  ///< of the filters, by pixel
};

Measured measure(Workshop& workshop, LoadedScene& scene, const Reference& reference) {
    Measured m{kinds(workshop), {}, {}};
    for (const Kind& kind : m.kinds) {
        workshop.tell("voxels: " + kind.label);
        m.sampled.push_back(sample(workshop, scene, reference, kind.options));
        m.sizes.push_back(sizes_of(matrices(m.sampled.back().first.result.image, "filter.")));
    }
    return m;
}

double occluder_bytes(const RenderStatistics& statistics) {
    const auto memory = statistics.memory.find("occluders");
    return memory == statistics.memory.end() ? 0 : double(memory->second);
}

void add_table(Section& s, const Measured& m, const Reference& reference) {
    Table table{fmt::format("Means over the seeds. The reference's own error is {:.5f}.",
                            reference.own_error()),
                {"occlusion", "mean deviation of the filters", "error", "CPU seconds",
                 "of the first seed's, grid or outlines and the covariance paths", "memory"},
                {},
                {}};
    for (size_t i = 0; i < m.kinds.size(); ++i) {
        const Sampled& r = m.sampled[i];
        const RenderStatistics& statistics = r.first.result.statistics;
        const double bytes = occluder_bytes(statistics), size = mean_size(m.sizes[i]);
        table.rows.push_back({m.kinds[i].label, fmt::format("{:.2f} px", size),
                              fmt::format("{:.5f}", r.mean_error()),
                              fmt::format("{:.2f}", r.mean_cpu()),
                              fmt::format("{:.2f}", occluder_seconds(r.first)),
                              fmt::format("{:.1f} MB", bytes / 1e6)});
        table.commands.push_back(r.first.command);
        s.data["occlusion"].push_back({{"label", m.kinds[i].label},
                                       {"filter_size", size},
                                       {"error", r.error},
                                       {"cpu", r.cpu},
                                       {"occluder_seconds", occluder_seconds(r.first)},
                                       {"bytes", bytes}});
    }
    s.tables.push_back(std::move(table));
}

Figure figure_of(const Measured& m, const Image& reference, double spp) {
    const std::array<int, 2> size{reference.width(), reference.height()};
    Sheet sheet(size, 360.0f / float(size[0]), 3, 5, {false, true, true, true, true});
    const ColourMap map = map_for(m.sizes.back(), "geometric mean deviation of the filter, pixels");
    sheet.picture(0, 0, "reference", display(reference));
    const auto show_filters = [&](int column, size_t kind) {
        const Image& image = m.sampled[kind].first.result.image;
        sheet.picture(column, 0, "filters, " + m.kinds[kind].label, display(image, 0.5f));
        sheet.ellipses(column, 0, matrices(image, "filter."), 26, 2, kOrange);
    };
    show_filters(1, 0);
    show_filters(2, m.kinds.size() - 1);
    std::vector<std::string> commands;
    for (size_t i = 0; i < m.kinds.size(); ++i) {
        sheet.map(int(i % 3), 1 + int(i / 3), m.kinds[i].label, m.sizes[i], map);
        commands.push_back(m.sampled[i].first.command);
    }
    return {"voxels",
            fmt::format(
                "The soft shadow of 700 leaves and a fence, {:g} samples a pixel. Top: the image, "
                "filters at two standard deviations where every voxel of the coarsest grid "
                "occludes and with the query of the geometry. Below: the sizes of the predicted "
                "filters.",
                spp),
            sheet.drawing, commands};
}

void add_claims(Section& s, const Measured& m) {
    const size_t widths = kWidths.size();
    const Sampled &finest = m.sampled[2 * widths - 1], &query = m.sampled.back();
    const Spread r = ratios(query.error, finest.error);
    s.claims.push_back({"voxels_query",
                        "the direct query's error is not larger than that of the 400-wide grid", "",
                        "mean ratio at most 1",
                        fmt::format("{} times; {:.2f} against {:.2f} CPU seconds in all", r.text(),
                                    query.mean_cpu(), finest.mean_cpu()),
                        r.mean, r.mean <= 1, s.tables[0].commands.back()});
    const double coarse = mean_size(m.sizes.front()), fine = mean_size(m.sizes[widths - 1]);
    s.claims.push_back(
        {"voxels_coarse_is_small",
         "where every occupied voxel occludes, a coarse grid makes filters smaller "
         "than a fine one",
         "shown", "25 wide against 400 wide: smaller",
         fmt::format("{:.2f} px against {:.2f} px; with our use of the grid {:.2f} "
                     "against {:.2f}",
                     coarse, fine, mean_size(m.sizes[widths]), mean_size(m.sizes[2 * widths - 1])),
         coarse / fine, coarse < fine, s.tables[0].commands.front()});
}

}  // namespace

Section voxels(Workshop& workshop) {
    Section s;
    s.name = "voxels";
    s.title = "voxels: the width of the occlusion grid (figure 5.12)";
    s.thesis =
        "The thesis compares filters in the shadow of a complex occluder for several widths of its "
        "voxel grid: a coarse grid sees more occlusion than there is, makes filters small, and "
        "costs "
        "samples.";
    const auto size = workshop.settings.shadows;
    s.resolution = size;
    s.counts = fmt::format(
        "{:g} samples a pixel; errors and seconds with the seeds {}, filters and the parts of "
        "seconds with the first; reference of 2 x {:g}",
        workshop.settings.spp, text_of(workshop.settings.seeds), workshop.settings.reference_spp);
    LoadedScene scene = workshop.load("foliage", workshop.scenes.generated("foliage"), size);
    const Reference reference(workshop, scene);
    const Measured measured = measure(workshop, scene, reference);
    s.figures.push_back(figure_of(measured, reference.mean(), workshop.settings.spp));
    add_table(s, measured, reference);
    add_claims(s, measured);
    s.notes.push_back(
        "Two ways to ask the same grid. \"Every voxel\" (--occlusion voxels) is how the thesis "
        "describes it: light that crosses an occupied voxel crosses an edge, wherever in the voxel "
        "the surface lies, so that a coarser grid occludes more. Taken literally, with an edge in "
        "each voxel, its width changes nothing or the finest grid has the smallest filters ("
        "docs/decisions/0092); that a voxel counts as so many edges as it holds slices of 1/200 of "
        "the "
        "scene, and that the voxels of the surfaces themselves are left out, are ours. From 25 to "
        "400 wide the filters do not grow at every step. \"Grid\" (--occlusion grid) is "
        "ours. An edge has no second moment, so that its distance from the ray counts "
        "(docs/results/laboratory.md has measurements): a voxel tells of an edge at its centroid, "
        "at least half a voxel away; of three voxels on the way one counts; and the one and a half "
        "beside "
        "either end, where the surfaces themselves are, are left out. Each of the three grows with "
        "the voxel, so that a coarse grid knows of fewer and farther edges: its filters are wide. "
        "Errors are those of --method covariance, whose counts follow the noise that is left and "
        "whose filters the samples judge, not of the predicted filters alone.");
    return s;
}

}  // namespace covtrace::reproduce
