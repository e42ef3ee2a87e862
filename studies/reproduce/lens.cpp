#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "reproduce/experiment.h"
#include "reproduce/panels.h"
#include "reproduce/statistics.h"
#include "reproduce/test_scenes.h"

namespace covtrace::reproduce {

namespace {

constexpr float kSharpness = 2;  // constant c of the filters that the closed form is about

struct View {
    std::string name, label;
    LensBoard board;
};
const std::array<View, 3> kViews{{{"lens-closed", "pinhole", {0}},
                                  {"lens-small", "small lens", {0.02}},
                                  {"lens-large", "large lens", {0.1}}}};

/// Renders the board of a view. `paths`: covariance paths per pixel; none: the program's own
/// choice.
Timed render_board(Workshop& workshop, const View& view, TextureBandwidth bandwidth,
                   std::optional<int> paths = {}) {
    const auto resolution = workshop.settings.board;
    LoadedScene scene = workshop.load(
        view.name, workshop.scenes.written(view.name, view.board.text(resolution)), resolution);
    RenderOptions options;
    options.method = Method::covariance;
    options.spp = workshop.settings.board_spp;
    options.texture_bandwidth = bandwidth;
    options.cov_spp = paths;
    options.seed = workshop.settings.seeds.front();
    return workshop.render(scene, options);
}

using Forced = std::vector<covariance::Sym2<float>>;  // filters by pixel

struct Comparison {
    std::vector<double> ratio, blur, roundness, widths_at_top;
};

/// Compares filters under a lens with those without one, `closed`. A lens adds r²/(4 c²) to the
/// filter's covariance, r the radius of the circle of confusion: the spectrum S seen through it is
/// (S^-1 + pi² r² I)^-1, preintegrate.hpp with the disc's window.
Comparison compare(const LensBoard& board, std::array<int, 2> size, const Forced& closed,
                   const Forced& open) {
    Comparison c;
    for (int y = 0; y < size[1]; ++y) {
        const double r = board.blur(y, size[1]);
        for (int x = 0; x < size[0]; ++x) {
            const size_t at = size_t(y) * size_t(size[0]) + size_t(x);
            const auto& f = open[at];
            const double extra = r * r / (4 * kSharpness * kSharpness);
            if (y < size[1] / 8) c.widths_at_top.push_back(std::sqrt(double(f.xx)));
            // Pixels that are hardly blurred are left out: by less than half a pixel at 135 rows,
            // and as much of the image at other sizes.
            if (r < 0.5 * size[1] / 135) continue;
            c.ratio.push_back(std::sqrt(double(f.xx) / (double(closed[at].xx) + extra)));
            c.ratio.push_back(std::sqrt(double(f.yy) / (double(closed[at].yy) + extra)));
            c.blur.push_back(r);
            const auto e = covariance::eigen(f);
            c.roundness.push_back(std::sqrt(double(e.low / e.high)));
        }
    }
    return c;
}

/// The renders of all views.
struct Renders {
    std::vector<Forced> of_one_path, of_own_choice;
    std::vector<std::string> one_path_commands;
    Figure figure;
};

Renders render_all(Workshop& workshop) {
    const auto size = workshop.settings.board;
    Renders r{{}, {}, {}, {"lens", "", Drawing(1, 1), {}}};
    Sheet sheet(size, 540.0f / float(size[0]), 2, 3);
    for (size_t i = 0; i < kViews.size(); ++i) {
        const Timed one = render_board(workshop, kViews[i], TextureBandwidth::highest, 1);
        r.of_one_path.push_back(filters_of_spectrum(one.result.image, kSharpness));
        r.one_path_commands.push_back(one.command);
        const Timed highest = render_board(workshop, kViews[i], TextureBandwidth::highest);
        r.of_own_choice.push_back(filters_of_spectrum(highest.result.image, kSharpness));
        if (i == 0) continue;
        const int column = int(i) - 1;
        const Timed own = render_board(workshop, kViews[i], TextureBandwidth::own);
        const Picture dimmed = display(own.result.image, 0.5f);
        sheet.picture(column, 0, kViews[i].label, display(own.result.image));
        sheet.picture(column, 1, "its filters, 2 deviations", dimmed);
        sheet.ellipses(column, 1, matrices(own.result.image, "filter."), 24, 2, kOrange);
        sheet.picture(column, 2, "texture at the image's highest frequency", dimmed);
        sheet.ellipses(column, 2, matrices(highest.result.image, "filter."), 24, 2, kCyan);
        r.figure.commands.push_back(own.command);
        r.figure.commands.push_back(highest.command);
    }
    r.figure.drawing = sheet.drawing;
    r.figure.caption = fmt::format(
        "A checkerboard that recedes from the camera, focused on the middle row. Top: the "
        "delivered image, {:g} samples a pixel. Middle: the filters with the texture as it is, "
        "narrow beside the squares' edges. Bottom: with the texture forced to the image's highest "
        "frequency, as in the thesis. The ellipses are where the predicted 2x2 reaches two "
        "standard deviations, true to scale.",
        workshop.settings.board_spp);
    return r;
}

/// Numbers that claims are about: filters of single paths and of the default number of paths, both
/// lenses together.
struct Compared {
    std::vector<double> ratios, default_ratios, widths_at_top;
};

Compared add_table(Section& s, const Renders& r, std::array<int, 2> size) {
    Table table{
        "Deviation of the forced filters over the closed form, of pixels whose circle of confusion "
        "is a pixel or more across (at 135 rows; as much of the image at other sizes)",
        {"lens", "covariance paths", "pixels", "median ratio", "5 %", "95 %",
         "median radius of the circle of confusion", "roundness (short over long axis)"},
        {},
        r.one_path_commands};
    table.commands.insert(table.commands.end(), r.figure.commands.begin(), r.figure.commands.end());
    Compared compared;
    for (size_t i = 1; i < kViews.size(); ++i) {
        const Comparison one = compare(kViews[i].board, size, r.of_one_path[0], r.of_one_path[i]);
        const Comparison own =
            compare(kViews[i].board, size, r.of_own_choice[0], r.of_own_choice[i]);
        const auto add_row = [&](const char* paths, const Comparison& c) {
            table.rows.push_back({kViews[i].label, paths, std::to_string(c.blur.size()),
                                  fmt::format("{:.3f}", median(c.ratio)),
                                  fmt::format("{:.3f}", quantile(c.ratio, 0.05)),
                                  fmt::format("{:.3f}", quantile(c.ratio, 0.95)),
                                  fmt::format("{:.2f} px", median(c.blur)),
                                  fmt::format("{:.2f}", median(c.roundness))});
        };
        add_row("1", one);
        add_row("default", own);
        compared.widths_at_top.push_back(median(one.widths_at_top));
        s.data[kViews[i].name] = {{"closed_form_ratio_median", median(one.ratio)},
                                  {"closed_form_ratio_5", quantile(one.ratio, 0.05)},
                                  {"closed_form_ratio_95", quantile(one.ratio, 0.95)},
                                  {"own_choice_ratio_median", median(own.ratio)},
                                  {"own_choice_ratio_5", quantile(own.ratio, 0.05)},
                                  {"own_choice_ratio_95", quantile(own.ratio, 0.95)},
                                  {"width_at_top", compared.widths_at_top.back()},
                                  {"blur_median", median(one.blur)}};
        compared.ratios.insert(compared.ratios.end(), one.ratio.begin(), one.ratio.end());
        compared.default_ratios.insert(compared.default_ratios.end(), own.ratio.begin(),
                                       own.ratio.end());
    }
    s.tables.push_back(std::move(table));
    return compared;
}

void add_claims(Section& s, const Renders& r, const Compared& c) {
    const double middle = median(c.ratios), low = quantile(c.ratios, 0.05),
                 high = quantile(c.ratios, 0.95);
    s.claims.push_back(
        {"lens_closed_form",
         "filters of one covariance path, the texture at the image's highest frequency, are as "
         "wide as pinhole² + r²/(4c²) says, r the radius of the circle of confusion",
         "", "median and 90 % of all pixels within 10 %",
         fmt::format("{:.3f}, 90 % in [{:.3f}, {:.3f}]; with the default two paths {:.3f}, "
                     "[{:.3f}, {:.3f}]",
                     middle, low, high, median(c.default_ratios), quantile(c.default_ratios, 0.05),
                     quantile(c.default_ratios, 0.95)),
         middle, std::abs(middle - 1) < 0.1 && low > 0.9 && high < 1.1,
         r.one_path_commands.back()});
    s.claims.push_back({"lens_grows",
                        "a lens five times as large makes filters wider in the same place",
                        "shown, without figures", "wider",
                        fmt::format("{:.2f} times", c.widths_at_top[1] / c.widths_at_top[0]),
                        c.widths_at_top[1] / c.widths_at_top[0],
                        c.widths_at_top[1] > c.widths_at_top[0], r.one_path_commands.back()});
}

}  // namespace

Section lens(Workshop& workshop) {
    Section s;
    s.name = "lens";
    s.title = "lens: defocus makes filters wide (figure 5.6)";
    s.thesis =
        "The thesis shows a diffuse checkerboard under a small and a large lens: the filters grow "
        "with the circle of confusion. It forces the texture to the image's highest frequency, so "
        "that a filter shows what the lens does and nothing else.";
    const auto size = workshop.settings.board;
    s.resolution = size;
    s.counts = fmt::format("{:g} samples a pixel, seed {}", workshop.settings.board_spp,
                           workshop.settings.seeds.front());
    Renders renders = render_all(workshop);
    const Compared compared = add_table(s, renders, size);
    add_claims(s, renders, compared);
    s.figures.push_back(std::move(renders.figure));
    s.notes.push_back(
        "The closed form is that of one point of the board. The paths of a pixel meet points at "
        "different depths, whose circles of confusion differ by some δr. Each path's covariance is "
        "right for its own point; their mean also has the spread of the shears, which integration "
        "over the lens takes for detail that the lens cannot blur. So filters of several paths "
        "grow to at most r/δr pinhole filters: nothing where the texture has its own bandwidth, "
        "but much less than the closed form where it is forced to the highest frequency and "
        "foreshortened. "
        "These filters are too narrow, which costs noise and adds no bias. The claim is about "
        "single paths; the table has both. The closed form is that of our own operators at one "
        "point: the claim checks that the program computes what its formulas say, not the formulas "
        "against light; covtrace measure and the slice experiment do that.");
    return s;
}

}  // namespace covtrace::reproduce
