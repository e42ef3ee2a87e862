#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "covariance/preintegrate.hpp"
#include "image/color_encoding.h"
#include "reproduce/curves.h"
#include "reproduce/experiment.h"
#include "reproduce/space_time.h"
#include "reproduce/spectrum_panels.h"
#include "reproduce/test_scenes.h"

namespace covtrace::reproduce {

namespace {

constexpr int kRows = 9;  // rows of the image whose light fields are measured
/// Deviation of the window in which spectra are measured, as share of a slice's width and height.
constexpr double kWindow = 0.18;
constexpr double kEverywhere = std::numeric_limits<double>::infinity();

/// Rows spread over the middle half of an image.
std::vector<int> rows_of(int height) {
    std::vector<int> rows;
    for (int k = 0; k < kRows; ++k) rows.push_back(height / 4 + height * k / (2 * (kRows - 1)));
    return rows;
}

/// Mean of the predicted covariances of some rows, weighted by radiance.
SpaceTimeCovariance predicted_covariance(const Image& image, const std::vector<int>& rows) {
    SpaceTimeCovariance p;
    const auto layer = [&](const char* name) { return image.find(name)->values.data(); };
    const float *xx = layer("cov.00"), *xt = layer("cov.04"), *tt = layer("cov.44"),
                *weight = layer("covweight.Y"), *behind = layer("spectrum.xx");
    double sum = 0;
    for (const int row : rows)
        for (int x = 0; x < image.width(); ++x) {
            const size_t i = size_t(row) * size_t(image.width()) + size_t(x);
            const double w = double(weight[i]);
            sum += w;
            p.xx += w * double(xx[i]);
            p.xt += w * double(xt[i]);
            p.tt += w * double(tt[i]);
            p.behind += w * double(behind[i]);
        }
    for (double* value : {&p.xx, &p.xt, &p.tt, &p.behind}) *value /= std::max(sum, 1e-30);
    return p;
}

struct Study {
    std::vector<int> rows;
    std::vector<Grid> fields;   ///< light fields of the rows
    std::vector<Grid> details;  ///< the same without their mean
    std::array<double, 2> window{};
    SpaceTimeCovariance predicted, measured;
    double way = 0;         ///< of the board, pixels in one shutter interval
    double difference = 0;  ///< of the spectra of image and slice, relative
    Timed prediction, image;

    size_t middle() const { return rows.size() / 2; }
};

/// Root mean square of the difference of amplitudes between the rendered rows and the light fields
/// behind the shutter at frequency 0 of time, over that of the former.
double difference_to_image(const Study& s) {
    double square = 0, all = 0;
    const Image& image = s.image.result.image;
    for (size_t k = 0; k < s.rows.size(); ++k) {
        Grid row(image.width(), 1);
        for (int x = 0; x < row.width; ++x) {
            const size_t i = size_t(s.rows[k]) * size_t(row.width) + size_t(x);
            row.at(x, 0) = double(luminance(image.rgb(i)));
        }
        const std::array<double, 2> window{s.window[0], kEverywhere};
        const GridSpectrum of_image(windowed(without_mean(row, window), window));
        const GridSpectrum of_slice(windowed(while_open(s.details[k]), window));
        for (int i = 0; i < row.width; ++i) {
            const double amplitude = std::abs(of_image.at(i, 0));
            const double behind = std::abs(of_slice.at(i, of_slice.height() / 2)) / kSlots;
            square += (amplitude - behind) * (amplitude - behind);
            all += amplitude * amplitude;
        }
    }
    return std::sqrt(square / all);
}

Study studied(Workshop& workshop) {
    Study s;
    const auto size = workshop.settings.board;
    const fs::path file = workshop.scenes.written(
        "slice", MovingPattern::text(size), {{MovingPattern::kFile, MovingPattern::pattern()}});
    RenderOptions options;
    options.seed = workshop.settings.seeds.front();
    LoadedScene scene = workshop.load("slice", file, size);
    options.method = Method::covariance;
    options.spp = workshop.settings.board_spp;
    s.prediction = workshop.render(scene, options);
    options.method = Method::uniform;
    options.spp = workshop.settings.reference_spp;
    s.image = workshop.render(scene, options);

    const auto around = float(MovingPattern::kAround);
    const LoadedScene open = workshop.load("slice", file, size, std::array{-around, 1 + around});
    s.rows = rows_of(size[1]);
    s.window = {kWindow * size[0], kWindow * kSlots * kIntervals};
    for (const int row : s.rows) {
        s.fields.push_back(light_field(*open.scene, size, row, options.seed));
        s.details.push_back(without_mean(s.fields.back(), s.window));
    }
    s.way = MovingPattern::kWay * size[1];
    s.predicted = predicted_covariance(s.prediction.result.image, s.rows);
    s.measured = measured_covariance(s.details, s.window);
    s.difference = difference_to_image(s);
    return s;
}

Picture grey(const Grid& grid) {
    Picture p(grid.width, grid.height);
    for (size_t i = 0; i < grid.values.size(); ++i)
        std::fill_n(&p.rgb[3 * i], 3, srgb_encode_8bit(float(grid.values[i])));
    return p;
}

std::vector<Vec2> profile(const Grid& row) {
    std::vector<Vec2> points;
    for (int x = 0; x < row.width; ++x) points.push_back({float(x) + 0.5f, float(row.at(x, 0))});
    return points;
}

/// Amplitudes of rows' spectra, root mean squares, up to a frequency.
std::vector<Vec2> amplitudes_of(const std::vector<Grid>& rows, double window, double up_to) {
    std::vector<double> energy(size_t(rows[0].width), 0);
    std::vector<Vec2> points;
    for (const Grid& row : rows) {
        const GridSpectrum spectrum(windowed(row, {window, kEverywhere}));
        for (int i = 0; i < row.width; ++i) energy[size_t(i)] += std::norm(spectrum.at(i, 0));
        if (&row != &rows.back()) continue;
        for (int i = 0; i < row.width; ++i)
            if (std::abs(spectrum.frequency_x(i)) <= up_to)
                points.push_back(
                    {float(spectrum.frequency_x(i)), float(std::sqrt(energy[size_t(i)]))});
    }
    return points;
}

std::vector<Vec2> gaussian(double variance, double up_to) {
    constexpr int kPoints = 100;
    std::vector<Vec2> points;
    for (int i = 0; i <= kPoints; ++i) {
        const double f = up_to * (2.0 * i / kPoints - 1);
        points.push_back({float(f), float(std::exp(-0.5 * f * f / variance))});
    }
    return points;
}

/// The lowest row of the figure: luminance and its spectrum, in the middle of the shutter and
/// behind it.
void draw_integral(Sheet& sheet, const Study& s, double up_to) {
    const Grid& field = s.fields[s.middle()];
    draw_curves(sheet, 0, 2, "what the sensor gets", "pixels", {0, 0}, {float(field.width), 1.0f},
                {{"in the middle of the shutter", kCyan, profile(moment(field, field.height / 2))},
                 {"all that comes through it", kRed, profile(integrated(field))}});
    std::vector<Grid> before, behind;
    for (const Grid& detail : s.details) {
        before.push_back(moment(detail, detail.height / 2));
        behind.push_back(integrated(detail));
    }
    std::vector<Vec2> a = amplitudes_of(before, s.window[0], up_to),
                      b = amplitudes_of(behind, s.window[0], up_to);
    float most = 1e-30f;
    for (const Vec2 p : a) most = std::max(most, p.y);
    for (std::vector<Vec2>* points : {&a, &b})
        for (Vec2& p : *points) p.y /= most;
    constexpr Ink kGrey{130, 130, 130};
    draw_curves(sheet, 1, 2, "spectra of nine rows of the image, the largest amplitude 1",
                "cycles per pixel", {-float(up_to), 0}, {float(up_to), 1.05f},
                {{"predicted before", kGrey, gaussian(s.predicted.xx, up_to)},
                 {"predicted behind", kOrange, gaussian(s.predicted.behind, up_to)},
                 {"in the middle of the shutter", kCyan, a},
                 {"behind it", kRed, b}});
}

/// The figure: above the light field, then what is left of it while the shutter is open, below what
/// the sensor gets; on the right the spectra.
Drawing drawn(const Study& s) {
    const Grid &field = s.fields[s.middle()], &detail = s.details[s.middle()];
    const int width = field.width, height = field.height;
    const SpaceTimeCovariance& p = s.predicted;
    const double xx = p.xx + window_variance(s.window[0]);
    Sheet sheet({width, height}, 560.0f / float(width), 2, 3, {false, false, true});
    const double up_to =
        3.2 * MovingPattern::bandwidth(int(std::lround(s.way / MovingPattern::kWay)));
    const Frequency range{up_to, up_to * s.way}, units{1, double(kSlots)};
    const auto show_spectrum = [&](int row, const std::string& title, const Grid& in_window) {
        const GridSpectrum spectrum(padded(in_window, 2 * width, 4 * height));
        SpectrumPanel panel(sheet, 1, row, range);
        panel.amplitudes(title, spectrum, units, largest_amplitude(spectrum));
        return panel;
    };
    sheet.picture(0, 0, "light field: pixels right, time down", grey(field));
    sheet.mark(0, 0, {0, kSlots, width, 2 * kSlots}, kOrange);
    show_spectrum(0,
                  fmt::format("its spectrum: f_x to {:.3f} per pixel, f_t to {:.1f} per shutter",
                              range[0], range[1]),
                  windowed(detail, s.window))
        .ellipse({0, 0}, {xx, p.xt, p.tt + window_variance(s.window[1] / kSlots)}, kOrange);
    sheet.picture(0, 1, "while the shutter is open", grey(while_open(field)));
    show_spectrum(1, "its spectrum, the same frequencies",
                  windowed(while_open(detail), {s.window[0], kEverywhere}))
        .ellipse({0, 0}, {xx, p.xt, p.tt + covariance::box_shutter_window<double>}, kOrange);
    draw_integral(sheet, s, up_to);
    return sheet.drawing;
}

void add_claims(Section& s, const Study& study, const std::string& command) {
    const SpaceTimeCovariance &p = study.predicted, &m = study.measured;
    const double way = study.way;
    s.claims.push_back(
        {"slice_shear", "the spectrum of what moves lies along f_t = -way f_x", "drawn",
         "predicted and measured way within 3 % of the board's",
         fmt::format("board {:.2f} pixels in a shutter interval, predicted {:.2f}, measured {:.2f}",
                     way, p.way(), m.way()),
         m.way() / way, std::abs(m.way() / way - 1) < 0.03 && std::abs(p.way() / way - 1) < 0.03,
         command});
    const auto add_bandwidth = [&](const std::string& name, const std::string& where,
                                   double predicted, double measured) {
        const double ratio = std::sqrt(predicted / measured);
        s.claims.push_back({name,
                            "bandwidth along the image " + where + ", predicted over measured",
                            "drawn", "within 25 %",
                            fmt::format("{:.2f} ({:.4f} and {:.4f} cycles per pixel)", ratio,
                                        std::sqrt(predicted), std::sqrt(measured)),
                            ratio, ratio > 1 / 1.25 && ratio < 1.25, command});
    };
    add_bandwidth("slice_before", "before the shutter", p.xx, m.xx);
    add_bandwidth("slice_behind", "behind the shutter", p.behind, m.behind);
    s.claims.push_back(
        {"slice_image",
         "the image has the spectrum of the light field behind the shutter at frequency 0 of time",
         "drawn", "amplitudes of rendered rows within 3 %, root mean square",
         fmt::format("{:.2f} %", 100 * study.difference), study.difference, study.difference < 0.03,
         study.image.command});
    const auto covariance = [](const SpaceTimeCovariance& c) {
        return nlohmann::json{{"xx", c.xx}, {"xt", c.xt}, {"tt", c.tt}, {"behind", c.behind}};
    };
    s.data = {{"way", way},
              {"predicted", covariance(p)},
              {"measured", covariance(m)},
              {"pattern", MovingPattern::bandwidth(s.resolution[1])},
              {"image_difference", study.difference}};
}

}  // namespace

Section slice(Workshop& workshop) {
    Section s;
    s.name = "slice";
    s.title = "slice: space and time before and behind the shutter (figures before 5.6)";
    s.thesis =
        "The thesis draws a slice of the local light field in space and time: motion shears its "
        "spectrum, the shutter's window widens it along the frequencies of time, and the integral "
        "over time takes the line at frequency 0 of time, which is the image's spectrum.";
    const Study study = studied(workshop);
    s.resolution = workshop.settings.board;
    s.counts = fmt::format("prediction of {:g} samples a pixel, image of {:g}, seed {}",
                           workshop.settings.board_spp, workshop.settings.reference_spp,
                           workshop.settings.seeds.front());
    const std::string command = reproduce_command(workshop, s.name);
    s.figures.push_back(
        {"slice",
         fmt::format(
             "The light field of a row of pixels, by real paths: a smooth pattern moves {:.1f} "
             "pixels to the right in a shutter interval; the slice shows three intervals, the "
             "middle one is the shutter's. Right: amplitudes of the deviations from the mean in a "
             "Gaussian window, a hundredth of the largest at black, frequencies of the image "
             "right, of time down, 0 in the middle (grey is logarithmic, two decades); two "
             "deviations of the predicted covariance, the mean over the rows, with the windows'. "
             "Below: the row's luminance at the middle instant (cyan) and as the shutter "
             "integrates it (red), and the root mean square amplitudes of nine rows of both, with "
             "the Gaussians of the predicted variances before the shutter (grey) and behind it "
             "(orange). The mean is taken out, hence the dip at 0. Motion makes a line of the "
             "spectrum, the shutter smears it along time, and the image gets what is on the line "
             "at frequency 0 of time.",
             study.way),
         drawn(study),
         {study.prediction.command, study.image.command, command}});
    add_claims(s, study, command);
    s.notes.push_back(
        "The measured covariance is that of Gaussian amplitudes with the energies of nine rows' "
        "spectra, less the window's own. The shutter is a box, whose spectrum has side lobes: "
        "they let more of the image's high frequencies through than the Gaussian of the same "
        "variance that the prediction takes for it. Both predictions are too low, which makes "
        "filters too wide: behind the shutter the side lobes are a reason; for the one before it "
        "none was found.");
    return s;
}

}  // namespace covtrace::reproduce
