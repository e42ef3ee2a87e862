#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "reproduce/experiment.h"
#include "reproduce/panels.h"
#include "reproduce/statistics.h"
#include "reproduce/test_scenes.h"

namespace covtrace::reproduce {

namespace {

constexpr float kSharpness = 2;  // constant c of the filters that the closed form is about

struct Case {
    std::string name, label;
    MovingBoard board;
};
const std::array<Case, 5> kCases{{{"motion-still", "still", {{0, 0}}},
                                  {"motion-slow", "slow", {{0, 0.03}}},
                                  {"motion-medium", "medium", {{0, 0.06}}},
                                  {"motion-fast", "fast", {{0, 0.12}}},
                                  {"motion-slanted", "slanted", {{0.1, 0.06}}}}};

/// Angle between two axes, degrees in [0, 90].
double between_axes(double ax, double ay, double bx, double by) {
    const double cosine = std::abs(ax * bx + ay * by) / (std::hypot(ax, ay) * std::hypot(bx, by));
    return std::acos(std::min(1.0, cosine)) * 180 / std::numbers::pi;
}

Timed render_board(Workshop& workshop, const Case& c, TextureBandwidth bandwidth) {
    const auto resolution = workshop.settings.board;
    LoadedScene scene = workshop.load(
        c.name, workshop.scenes.written(c.name, c.board.text(resolution)), resolution);
    RenderOptions options;
    options.method = Method::covariance;
    options.spp = workshop.settings.board_spp;
    options.texture_bandwidth = bandwidth;
    options.seed = workshop.settings.seeds.front();
    return workshop.render(scene, options);
}

using Filters = std::vector<covariance::Sym2<float>>;

/// The way of a board while the shutter is open, pixels.
struct Way {
    double x, y;
    double length() const { return std::hypot(x, y); }
};

Way way_of(const Case& c, std::array<int, 2> size) {
    return {double(c.board.path[0]) * size[1], double(c.board.path[1]) * size[1]};
}

/// Filters of a moving board beside those of the board at rest, by pixel.
struct Stretched {
    std::vector<double> ratio, angle, along, stretch, at_rest;
};

Stretched compare(const Filters& still, const Filters& filters, const Way& way) {
    Stretched s;
    const double v = way.length(), dx = way.x / v, dy = way.y / v;
    const auto form = [&](const covariance::Sym2<float>& m) {
        return dx * dx * double(m.xx) + 2 * dx * dy * double(m.xy) + dy * dy * double(m.yy);
    };
    for (size_t p = 0; p < filters.size(); ++p) {
        const auto& f = filters[p];
        const double closed = form(still[p]) + v * v / (12 * kSharpness * kSharpness);
        s.ratio.push_back(std::sqrt(form(f) / closed));
        s.along.push_back(std::sqrt(form(f)));
        s.at_rest.push_back(form(still[p]));
        s.stretch.push_back(std::max(0.0, form(f) - form(still[p])));
        const auto e = covariance::eigen(f);
        s.angle.push_back(between_axes(double(e.x), double(e.y), dx, dy));
    }
    return s;
}

/// Numbers that claims are about: all boards together.
struct Compared {
    std::vector<double> ratios, angles, stretches;
};

void add_board(Section& s, Table& table, const Case& c, double v, const Stretched& b) {
    const double moved = v / (std::sqrt(12.0) * kSharpness);
    table.rows.push_back(
        {c.label, fmt::format("{:.1f} px", v), fmt::format("{:.3f} px", median(b.along)),
         fmt::format("{:.3f} px", std::sqrt(moved * moved + median(b.at_rest))),
         fmt::format("{:.3f}", median(b.ratio)), fmt::format("{:.3f}", quantile(b.ratio, 0.05)),
         fmt::format("{:.3f}", quantile(b.ratio, 0.95)), fmt::format("{:.2f}°", median(b.angle)),
         fmt::format("{:.2f}°", quantile(b.angle, 0.95))});
    s.data[c.name] = {{"pixels", v},
                      {"width_median", median(b.along)},
                      {"stretch_median", std::sqrt(median(b.stretch))},
                      {"closed_form_ratio_median", median(b.ratio)},
                      {"closed_form_ratio_5", quantile(b.ratio, 0.05)},
                      {"closed_form_ratio_95", quantile(b.ratio, 0.95)},
                      {"angle_median", median(b.angle)},
                      {"angle_95", quantile(b.angle, 0.95)}};
}

/// Adds a board to the figure: its image, its filters, and those of the forced texture.
void show(Sheet& sheet, int column, const std::string& title, const Image& own,
          const Image& highest) {
    const Picture dimmed = display(own, 0.5f);
    sheet.picture(column, 0, title, display(own));
    sheet.picture(column, 1, "its filters, 2 deviations", dimmed);
    sheet.ellipses(column, 1, matrices(own, "filter."), 16, 2, kOrange);
    sheet.picture(column, 2, "texture at the highest frequency", dimmed);
    sheet.ellipses(column, 2, matrices(highest, "filter."), 16, 2, kCyan);
}

Compared add_boards(Section& s, Workshop& workshop) {
    const auto size = workshop.settings.board;
    Sheet sheet(size, 360.0f / float(size[0]), 4, 3);
    Figure figure{"motion", "", Drawing(1, 1), {}};
    Table table{
        "Forced filters against the closed form: still² + V²/(12 c²) along the way, V pixels "
        "while the shutter is open",
        {"board", "V", "median deviation along the way", "closed form", "median ratio", "5 %",
         "95 %", "median angle to the way", "95 %"},
        {},
        {}};
    Filters still;
    Compared all;
    for (size_t i = 0; i < kCases.size(); ++i) {
        const Case& c = kCases[i];
        const Timed highest = render_board(workshop, c, TextureBandwidth::highest);
        const auto filters = filters_of_spectrum(highest.result.image, kSharpness);
        table.commands.push_back(highest.command);
        if (i == 0) {
            still = filters;
            continue;
        }
        const Timed own = render_board(workshop, c, TextureBandwidth::own);
        const Way way = way_of(c, size);
        show(sheet, int(i) - 1, fmt::format("{}: {:.1f} pixels", c.label, way.length()),
             own.result.image, highest.result.image);
        figure.commands.push_back(own.command);
        figure.commands.push_back(highest.command);
        const Stretched stretched = compare(still, filters, way);
        add_board(s, table, c, way.length(), stretched);
        all.ratios.insert(all.ratios.end(), stretched.ratio.begin(), stretched.ratio.end());
        all.angles.insert(all.angles.end(), stretched.angle.begin(), stretched.angle.end());
        if (c.board.path[0] == 0) all.stretches.push_back(std::sqrt(median(stretched.stretch)));
    }
    figure.drawing = sheet.drawing;
    figure.caption = fmt::format(
        "A checkerboard parallel to the film that moves while the shutter is open: down the image "
        "at three speeds, and slantwise. Top: the delivered image, {:g} samples a pixel. Middle: "
        "filters with the texture as it is. Bottom: with the texture forced to the image's highest "
        "frequency, so that only the motion shows. Ellipses at two standard deviations, true to "
        "scale.",
        workshop.settings.board_spp);
    s.figures.push_back(std::move(figure));
    s.tables.push_back(std::move(table));
    return all;
}

void add_claims(Section& s, const Compared& all) {
    const std::string command = s.tables[0].commands.back();
    const double worst = quantile(all.angles, 0.95);
    s.claims.push_back(
        {"motion_direction", "filters stretch along the way that the board goes",
         "along y, as shown", "within 10°, 95 % of the pixels",
         fmt::format("median {:.2f}°, 95 % within {:.2f}°", median(all.angles), worst), worst,
         worst < 10, command});
    const double middle = median(all.ratios), low = quantile(all.ratios, 0.05),
                 high = quantile(all.ratios, 0.95);
    s.claims.push_back({"motion_closed_form", "their width along it is as still² + V²/(12c²) says",
                        "", "median and 90 % of all pixels within 10 %",
                        fmt::format("{:.3f}, 90 % in [{:.3f}, {:.3f}]", middle, low, high), middle,
                        std::abs(middle - 1) < 0.1 && low > 0.9 && high < 1.1, command});
    s.claims.push_back({"motion_proportional",
                        "what the motion adds (in quadrature) grows in proportion to the speed",
                        "shown at one speed", "slow : medium : fast = 1 : 2 : 4 within 15 %",
                        fmt::format("1 : {:.2f} : {:.2f}", all.stretches[1] / all.stretches[0],
                                    all.stretches[2] / all.stretches[0]),
                        all.stretches[2] / all.stretches[0],
                        std::abs(all.stretches[1] / all.stretches[0] - 2) < 0.3 &&
                            std::abs(all.stretches[2] / all.stretches[0] - 4) < 0.6,
                        command});
}

}  // namespace

Section motion(Workshop& workshop) {
    Section s;
    s.name = "motion";
    s.title = "motion: filters stretch along the way (figure 5.7)";
    s.thesis =
        "The thesis shows a diffuse checkerboard that moves along the image's y axis: its filters "
        "stretch along y.";
    s.resolution = workshop.settings.board;
    s.counts = fmt::format("{:g} samples a pixel, seed {}", workshop.settings.board_spp,
                           workshop.settings.seeds.front());
    add_claims(s, add_boards(s, workshop));
    s.notes.push_back(
        "The board is parallel to the film, so that one closed form holds for all of its pixels: "
        "ratios of 1.000 and angles of 0.00° say that the program computes what its own operators "
        "say, at real pixels, and nothing about light; the slice experiment measures that. The "
        "claims are about the texture at the image's highest frequency.");
    return s;
}

}  // namespace covtrace::reproduce
