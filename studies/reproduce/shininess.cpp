#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reproduce/experiment.h"
#include "reproduce/panels.h"
#include "reproduce/test_scenes.h"

namespace covtrace::reproduce {

namespace {

// Constant c and the largest deviation of filters by default.
constexpr float kSharpness = 2, kWidest = 15;
constexpr std::array<const char*, 2> kRows{"metal", "coated"};

/// Mean area of the filters on a sphere's highlight (of the ellipse at one deviation, pixels²), in
/// the logarithm: over the pixels at least half as bright as its brightest.
double highlight_area(const std::vector<covariance::Sym2<float>>& filters, const Image& image,
                      const std::array<double, 3>& circle) {
    const auto over_sphere = [&](const auto& take) {
        for (int y = 0; y < image.height(); ++y)
            for (int x = 0; x < image.width(); ++x)
                // The outline is left out: its effect on filters is not the lobe's doing.
                if (std::hypot(x + 0.5 - circle[0], y + 0.5 - circle[1]) < 0.85 * circle[2])
                    take(size_t(y) * size_t(image.width()) + size_t(x));
    };
    double brightest = 0, sum = 0, pixels = 0;
    over_sphere(
        [&](size_t i) { brightest = std::max(brightest, double(luminance(image.rgb(i)))); });
    over_sphere([&](size_t i) {
        if (luminance(image.rgb(i)) < 0.5 * brightest) return;
        sum += 0.5 * std::log(std::max(1e-12, double(covariance::det(filters[i]))));
        ++pixels;
    });
    return pixels > 0 ? std::numbers::pi * std::exp(sum / pixels) : 0;
}

/// Mean areas of the filters on the highlights: by rule (local, global), by row, by exponent.
using Areas = std::array<std::array<std::vector<double>, 2>, 2>;

Timed render_spheres(Workshop& workshop, LoadedScene& scene, size_t rule) {
    RenderOptions options;
    options.method = Method::covariance;
    options.spp = workshop.settings.board_spp;
    options.seed = workshop.settings.seeds.front();
    options.brdf_covariance = rule == 0 ? BrdfCovariance::local : BrdfCovariance::global;
    return workshop.render(scene, options);
}

Areas areas_of(const SphereRows& rows, const std::array<Timed, 2>& timed, std::array<int, 2> size) {
    Areas area;
    for (size_t rule = 0; rule < 2; ++rule) {
        const Image& image = timed[rule].result.image;
        const auto filters = filters_of_spectrum(image, kSharpness, kWidest);
        for (int row = 0; row < 2; ++row)
            for (int i = 0; i < int(SphereRows::kExponents.size()); ++i)
                area[rule][size_t(row)].push_back(
                    highlight_area(filters, image, rows.circle(row, i, size)));
    }
    return area;
}

Figure figure_of(const SphereRows& rows, const std::array<Timed, 2>& timed, std::array<int, 2> size,
                 double spp) {
    Sheet sheet(size, 540.0f / float(size[0]), 2, 3, {false, false, true});
    const std::vector<float> sizes = sizes_of(matrices(timed[0].result.image, "filter."));
    const ColourMap map = map_for(sizes, "geometric mean deviation of the filter, pixels");
    for (int rule = 0; rule < 2; ++rule) {
        const Image& image = timed[size_t(rule)].result.image;
        const std::string label = rule == 0 ? "local BRDF covariance" : "global, as in the thesis";
        const auto filters = matrices(image, "filter.");
        sheet.picture(rule, 0, label, display(image));
        for (int row = 0; row < 2; ++row)
            for (int i = 0; i < int(SphereRows::kExponents.size()); ++i) {
                const auto [x, y, radius] = rows.circle(row, i, size);
                const float scale = sheet.width() / float(size[0]);
                const Vec2 at = sheet.corner(rule, 0);
                sheet.drawing.text(
                    at.x + scale * float(x), at.y + scale * float(y + radius) + 9, 7,
                    fmt::format("{} {:g}", kRows[size_t(row)], SphereRows::kExponents[size_t(i)]),
                    kBlack, Anchor::middle);
            }
        sheet.picture(rule, 1, "its filters, 2 deviations", display(image, 0.6f));
        sheet.ellipses(rule, 1, filters, 30, 2, rule == 0 ? kOrange : kCyan);
        sheet.map(rule, 2, "their sizes", sizes_of(filters), map);
    }
    return {
        "shininess",
        fmt::format(
            "Spheres of Phong exponents 16, 64, 256, 1024 and 4096 (as GGX roughness 1/√e), metal "
            "above, a coat over a diffuse base below, under one square light, {:g} samples a "
            "pixel. Top: the delivered image. Middle: filters at two standard deviations, at "
            "places of a lattice; where two would overlap the larger is left out, and so is one "
            "that would leave the panel, so that broad areas look empty. Bottom: their sizes.",
            spp),
        sheet.drawing,
        {timed[0].command, timed[1].command}};
}

Table table_of(const Areas& area, const std::array<Timed, 2>& timed) {
    Table table{
        "Mean area of the filters on a sphere's highlight, pixels², before the least "
        "deviation of filters (0.5 pixels at 16 samples, an area of 0.79) and the limit by "
        "neighbours",
        {"exponent", "GGX roughness", "metal, local", "metal, global", "coated, local",
         "coated, global"},
        {},
        {timed[0].command, timed[1].command}};
    for (size_t i = 0; i < SphereRows::kExponents.size(); ++i) {
        const double e = SphereRows::kExponents[i];
        table.rows.push_back(
            {fmt::format("{:g}", e), fmt::format("{:.4f}", SphereRows::roughness(e)),
             fmt::format("{:.2f}", area[0][0][i]), fmt::format("{:.2f}", area[1][0][i]),
             fmt::format("{:.2f}", area[0][1][i]), fmt::format("{:.2f}", area[1][1][i])});
    }
    return table;
}

void add_claims(Section& s, const Areas& area) {
    for (size_t rule = 0; rule < 2; ++rule)
        for (size_t row = 0; row < 2; ++row) {
            const std::vector<double>& a = area[rule][row];
            bool falls = true;
            std::string found;
            for (size_t i = 0; i < a.size(); ++i) {
                falls = falls && (i == 0 || a[i] < a[i - 1]);
                found += fmt::format("{}{:.2f}", i == 0 ? "" : " > ", a[i]);
            }
            const std::string name =
                fmt::format("{}_{}", kRows[row], rule == 0 ? "local" : "global");
            s.data["area"][name] = a;
            s.claims.push_back(
                {"shininess_falls_" + name,
                 fmt::format(
                     "on the highlight the filters' area falls with the exponent: {}, {} BRDF "
                     "covariance",
                     kRows[row], rule == 0 ? "local" : "global"),
                 "shown, without figures", "falls at every step", found + " px²",
                 a.back() / a.front(), falls, s.tables[0].commands[rule]});
        }
}

}  // namespace

Section shininess(Workshop& workshop) {
    Section s;
    s.name = "shininess";
    s.title = "shininess: small filters where the lobe is sharp (figure 5.8)";
    s.thesis =
        "The thesis shows spheres with a diffuse and a glossy lobe of rising exponent: the filters "
        "on "
        "the highlight get smaller. It takes a BRDF's covariance at its peak for all directions "
        "(global), and names the small filters beside the highlight as a limitation.";
    const auto size = workshop.settings.spheres;
    s.resolution = size;
    s.counts = fmt::format("{:g} samples a pixel, seed {}", workshop.settings.board_spp,
                           workshop.settings.seeds.front());
    const SphereRows rows;
    LoadedScene scene = workshop.load(
        "shininess-rows", workshop.scenes.written("shininess-rows", rows.text(size)), size);
    const std::array<Timed, 2> timed{render_spheres(workshop, scene, 0),
                                     render_spheres(workshop, scene, 1)};
    const Areas area = areas_of(rows, timed, size);
    s.figures.push_back(figure_of(rows, timed, size, workshop.settings.board_spp));
    s.tables.push_back(table_of(area, timed));
    add_claims(s, area);
    s.notes.push_back(
        "A coat reflects a few per cent: its broadest highlights hardly stand out from the diffuse "
        "base, "
        "whose own wide filters are then among the pixels that count, so that the area on the "
        "coated "
        "spheres need not fall from 16 to 64.");
    return s;
}

}  // namespace covtrace::reproduce
