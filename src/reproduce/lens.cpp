#include <fmt/format.h>

#include <cmath>

#include "reproduce/experiment.h"
#include "reproduce/panels.h"
#include "reproduce/statistics.h"
#include "reproduce/test_scenes.h"

namespace covtrace::reproduce {

namespace {

constexpr float kSharpness = 2;  // c: of the filters that the closed form is about

struct View {
    std::string name, label;
    LensBoard board;
};
const std::array<View, 3> kViews{{{"lens-closed", "pinhole", {0}},
                                  {"lens-small", "small lens", {0.02}},
                                  {"lens-large", "large lens", {0.1}}}};

Timed render_board(Workshop& workshop, const View& view, TextureBandwidth bandwidth) {
    const auto resolution = workshop.settings.board;
    LoadedScene scene = workshop.load(
        view.name, workshop.scenes.written(view.name, view.board.text(resolution)), resolution);
    RenderOptions options;
    options.method = Method::covariance;
    options.spp = workshop.settings.board_spp;
    options.texture_bandwidth = bandwidth;
    options.seed = workshop.settings.seeds.front();
    return workshop.render(scene, options);
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
    Sheet sheet(size, 2, 2, 3);
    Figure figure{"lens", "", Drawing(1, 1), {}};
    std::vector<std::vector<covariance::Sym2<float>>> forced;
    for (size_t i = 0; i < kViews.size(); ++i) {
        const Timed highest = render_board(workshop, kViews[i], TextureBandwidth::highest);
        forced.push_back(filters_of_spectrum(highest.result.image, kSharpness));
        if (i == 0) continue;
        const int column = int(i) - 1;
        const Timed own = render_board(workshop, kViews[i], TextureBandwidth::own);
        const Picture dimmed = display(own.result.image, 0.5f);
        sheet.picture(column, 0, kViews[i].label, display(own.result.image));
        sheet.picture(column, 1, "its filters, 2 deviations", dimmed);
        sheet.ellipses(column, 1, matrices(own.result.image, "filter."), 24, 2, kOrange);
        sheet.picture(column, 2, "texture at the image's highest frequency", dimmed);
        sheet.ellipses(column, 2, matrices(highest.result.image, "filter."), 24, 2, kCyan);
        figure.commands.push_back(own.command);
        figure.commands.push_back(highest.command);
    }
    figure.drawing = sheet.drawing;
    figure.caption = fmt::format(
        "A checkerboard that recedes from the camera, focused on the middle row. Top: the "
        "delivered "
        "image, {:g} samples a pixel. Middle: the filters with the texture as it is, narrow beside "
        "the squares' edges. Bottom: with the texture forced to the image's highest frequency, as "
        "in "
        "the thesis. The ellipses are where the applied 2x2 reaches two standard deviations, true "
        "to "
        "scale.",
        workshop.settings.board_spp);
    s.figures.push_back(std::move(figure));

    // A lens adds r²/(4 c²) to the filter's covariance, r the radius of the circle of confusion:
    // the spectrum S seen through it is (S^-1 + pi² r² I)^-1, SPEC section 4 with the disc's
    // window.
    Table table{
        "Deviation of the forced filters over the closed form, by row of pixels that is out "
        "of focus by a pixel or more",
        {"lens", "pixels", "median ratio", "5 %", "95 %", "median circle of confusion",
         "roundness (short over long axis)"},
        {},
        s.figures[0].commands};
    std::vector<double> width_at_top;
    std::vector<double> all_ratios;
    for (size_t i = 1; i < kViews.size(); ++i) {
        std::vector<double> ratio, blur, roundness, widths;
        for (int y = 0; y < size[1]; ++y) {
            const double r = kViews[i].board.blur(y, size[1]);
            for (int x = 0; x < size[0]; ++x) {
                const size_t at = size_t(y) * size_t(size[0]) + size_t(x);
                const auto& f = forced[i][at];
                const auto& closed = forced[0][at];
                const double extra = r * r / (4 * kSharpness * kSharpness);
                if (y < size[1] / 8) widths.push_back(std::sqrt(double(f.xx)));
                if (r < 0.5 * size[1] / 135) continue;
                ratio.push_back(std::sqrt(double(f.xx) / (double(closed.xx) + extra)));
                ratio.push_back(std::sqrt(double(f.yy) / (double(closed.yy) + extra)));
                blur.push_back(r);
                const auto e = covariance::eigen(f);
                roundness.push_back(std::sqrt(double(e.low / e.high)));
            }
        }
        width_at_top.push_back(median(widths));
        table.rows.push_back(
            {kViews[i].label, std::to_string(blur.size()), fmt::format("{:.3f}", median(ratio)),
             fmt::format("{:.3f}", quantile(ratio, 0.05)),
             fmt::format("{:.3f}", quantile(ratio, 0.95)), fmt::format("{:.2f} px", median(blur)),
             fmt::format("{:.2f}", median(roundness))});
        s.data[kViews[i].name] = {{"closed_form_ratio_median", median(ratio)},
                                  {"closed_form_ratio_5", quantile(ratio, 0.05)},
                                  {"closed_form_ratio_95", quantile(ratio, 0.95)},
                                  {"width_at_top", width_at_top.back()},
                                  {"blur_median", median(blur)}};
        all_ratios.insert(all_ratios.end(), ratio.begin(), ratio.end());
    }
    s.tables.push_back(std::move(table));
    const double middle = median(all_ratios), low = quantile(all_ratios, 0.05),
                 high = quantile(all_ratios, 0.95);
    s.claims.push_back(
        {"lens_closed_form",
         "filters are as wide as pinhole² + r²/(4c²) says, r the circle of confusion", "",
         "median and 90 % of all pixels within 10 %",
         fmt::format("{:.3f}, 90 % in [{:.3f}, {:.3f}]", middle, low, high), middle,
         std::abs(middle - 1) < 0.1 && low > 0.9 && high < 1.1, s.figures[0].commands.back()});
    s.claims.push_back({"lens_grows",
                        "a lens five times as large makes filters wider in the same place",
                        "shown, without figures", "wider",
                        fmt::format("{:.2f} times", width_at_top[1] / width_at_top[0]),
                        width_at_top[1] / width_at_top[0], width_at_top[1] > width_at_top[0],
                        s.figures[0].commands.back()});
    return s;
}

}  // namespace covtrace::reproduce
