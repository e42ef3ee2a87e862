#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "image/color_encoding.h"
#include "reproduce/comb.h"
#include "reproduce/experiment.h"
#include "reproduce/panels.h"
#include "reproduce/reference.h"
#include "reproduce/spectrum_panels.h"
#include "reproduce/statistics.h"

namespace covtrace::reproduce {

namespace {

/// Samples per deviation of the predicted spectrum, along each axis: too few, hardly enough,
/// enough.
constexpr std::array<double, 3> kRates{2, 3, 4};

/// The light of a part of the image in a Gaussian window, and its spectrum as predicted and
/// measured.
struct Patch {
    PixelBounds bounds;
    covariance::Sym2<double> predicted;  ///< of the amplitudes, the window's included
    std::array<double, 2> measured{};    ///< variances along x and y of the same
    std::array<double, 3> beyond{};      ///< share of the energy beyond half of each rate
    /// How much of the predicted bandwidth the measured one needs: 1 where they are equal.
    double tightness() const {
        return std::max(measured[0] / predicted.xx, measured[1] / predicted.yy);
    }
};

/// Deviation of the window that looks at a patch, pixels.
double window_of(const PixelBounds& b) {
    return b.width() / 6.0;
}

Grid channel_of(const Image& image, const PixelBounds& b, size_t channel) {
    Grid grid(b.width(), b.height());
    for (int y = 0; y < b.height(); ++y)
        for (int x = 0; x < b.width(); ++x) {
            const Rgb c = image.rgb(size_t(b.y0 + y) * size_t(image.width()) + size_t(b.x0 + x));
            grid.at(x, y) = channel < 3 ? double(c[int(channel)]) : double(luminance(c));
        }
    return windowed(grid, {window_of(b), window_of(b)});
}
constexpr size_t kLuminance = 3;

/// The mean of the predicted spectra in the window, weighted by the light there, and the window's
/// own spectrum: products of signals add covariances.
covariance::Sym2<double> predicted_in(const Image& prediction, const Image& light,
                                      const PixelBounds& b) {
    const Grid weight = channel_of(light, b, kLuminance);
    const auto spectra = matrices(prediction, "spectrum.");
    covariance::Sym2<double> mean{};
    double sum = 1e-30;
    for (int y = 0; y < b.height(); ++y)
        for (int x = 0; x < b.width(); ++x) {
            const auto& s = spectra[size_t(b.y0 + y) * size_t(light.width()) + size_t(b.x0 + x)];
            const double w = std::max(0.0, weight.at(x, y));
            sum += w;
            mean.xx += w * double(s.xx);
            mean.xy += w * double(s.xy);
            mean.yy += w * double(s.yy);
        }
    const double window = window_variance(window_of(b));
    return {mean.xx / sum + window, mean.xy / sum, mean.yy / sum + window};
}

/// Measures a patch. Energies are products of the spectra of the reference's two halves, so that
/// the noise of neither counts.
Patch measured_patch(const Reference& reference, const Image& prediction, const PixelBounds& b) {
    Patch patch;
    patch.bounds = b;
    patch.predicted = predicted_in(prediction, reference.mean(), b);
    const GridSpectrum one(channel_of(reference.half(0), b, kLuminance)),
        other(channel_of(reference.half(1), b, kLuminance));
    const double sx = std::sqrt(patch.predicted.xx), sy = std::sqrt(patch.predicted.yy);
    double total = 1e-30;
    for (int j = 0; j < one.height(); ++j)
        for (int i = 0; i < one.width(); ++i) {
            const double energy = std::real(one.at(i, j) * std::conj(other.at(i, j)));
            const double fx = one.frequency_x(i), fy = one.frequency_y(j);
            total += energy;
            // Amplitudes of a Gaussian vary twice as widely as their squares.
            patch.measured[0] += 2 * energy * fx * fx;
            patch.measured[1] += 2 * energy * fy * fy;
            for (size_t k = 0; k < kRates.size(); ++k)
                if (std::abs(fx) > 0.5 * kRates[k] * sx || std::abs(fy) > 0.5 * kRates[k] * sy)
                    patch.beyond[k] += energy;
        }
    for (double& value : patch.measured) value /= total;
    for (double& value : patch.beyond) value /= total;
    return patch;
}

std::vector<Patch> patches_of(const Reference& reference, const Image& prediction) {
    const int width = prediction.width(), height = prediction.height();
    const int side = std::min(height, std::max(16, width / 5)), step = side / 2;
    std::vector<Patch> patches;
    for (int y = 0; y + side <= height; y += step)
        for (int x = 0; x + side <= width; x += step)
            patches.push_back(measured_patch(reference, prediction, {x, y, x + side, y + side}));
    return patches;
}

/// The energy that a spectrum of Gaussian amplitudes has beyond half the rate, at most: both axes
/// counted.
double predicted_beyond(double rate) {
    return std::min(1.0, 2 * std::erfc(0.5 * rate));
}

using Colours = std::array<Grid, 3>;

Colours colours_of(const Image& image, const PixelBounds& b) {
    return {channel_of(image, b, 0), channel_of(image, b, 1), channel_of(image, b, 2)};
}

Colours through(const Colours& colours, const auto& change) {
    return {change(colours[0]), change(colours[1]), change(colours[2])};
}

Picture picture_of(const Colours& colours) {
    Picture p(colours[0].width, colours[0].height);
    for (size_t i = 0; i < colours[0].values.size(); ++i)
        for (size_t c = 0; c < 3; ++c)
            p.rgb[3 * i + c] = srgb_encode_8bit(float(colours[c].values[i]));
    return p;
}

/// The signal, dimmed where no sample is.
Picture samples_in(const Colours& signal, const Comb& comb) {
    const Colours taken = through(signal, [&](const Grid& g) { return sampled(g, comb); });
    Picture p = picture_of(signal);
    for (size_t i = 0; i < taken[0].values.size(); ++i)
        if (taken[0].values[i] == 0 && taken[1].values[i] == 0 && taken[2].values[i] == 0)
            for (size_t c = 0; c < 3; ++c) p.rgb[3 * i + c] = uint8_t(p.rgb[3 * i + c] / 3);
    return p;
}

struct Alias {
    double rate;
    Comb comb;
    double measured, predicted;
};

/// The figure: a signal, its samples at three rates, their spectra, and what the filter makes of
/// them.
Drawing drawn(const Image& light, const Patch& patch, std::vector<Alias>& aliases) {
    const PixelBounds& b = patch.bounds;
    const covariance::Sym2<double>& s = patch.predicted;
    Sheet sheet({b.width(), b.height()}, 270.0f / float(b.width()), 4, 3);
    const Colours signal = colours_of(light, b);
    const Grid luminance = channel_of(light, b, kLuminance);
    const auto filter = [&s](const Grid& g) { return filtered(g, s); };
    const int finer = std::max(256, 2 * b.width());
    // The nearest replicas at the highest rate, and two deviations more.
    const double reach = std::min(0.5, (kRates.back() + 2.2) * std::sqrt(std::max(s.xx, s.yy)));
    const auto show_spectrum = [&](int column, const std::string& title, const Grid& grid) {
        const GridSpectrum spectrum(padded(grid, finer, finer));
        SpectrumPanel panel(sheet, column, 1, {reach, reach});
        panel.amplitudes(title, spectrum, {1, 1}, largest_amplitude(spectrum));
        return panel;
    };
    sheet.picture(0, 0, "the signal", picture_of(signal));
    show_spectrum(0, "its spectrum", luminance).ellipse({0, 0}, s, kOrange);
    sheet.picture(0, 2, "all pixels, filtered", picture_of(through(signal, filter)));
    for (size_t k = 0; k < kRates.size(); ++k) {
        const Comb comb = comb_for(s, kRates[k]);
        const auto take = [&](const Grid& g) { return sampled(g, comb); };
        const int column = int(k) + 1;
        sheet.picture(column, 0,
                      fmt::format("{:g} per deviation: {} x {} pixels", kRates[k], comb.spacing[0],
                                  comb.spacing[1]),
                      samples_in(signal, comb));
        SpectrumPanel panel = show_spectrum(column, "with replicas", take(luminance));
        for (const Frequency& f : replicas_of(comb)) panel.ellipse(f, s, kCyan);
        panel.ellipse({0, 0}, s, kOrange);
        panel.box({0.5 / comb.spacing[0], 0.5 / comb.spacing[1]}, kRed);
        const Alias alias{kRates[k], comb, measured_alias(luminance, comb, s),
                          predicted_alias(comb, s)};
        sheet.picture(column, 2, fmt::format("filtered: {:.2g} % alias", 100 * alias.measured),
                      picture_of(through(through(signal, take), filter)));
        aliases.push_back(alias);
    }
    return sheet.drawing;
}

/// The claim about all patches, and its table.
void add_beyond(Section& s, const std::vector<Patch>& patches, const std::string& command) {
    Table table{fmt::format("Energy of the spectrum beyond half the rate, {} patches of {} pixels",
                            patches.size(), patches.front().bounds.width()),
                {"samples per deviation", "predicted, at most", "median", "90 %", "most"},
                {},
                {command}};
    bool holds = true;
    std::string found;
    double last = 2;
    for (size_t k = 0; k < kRates.size(); ++k) {
        std::vector<double> shares;
        for (const Patch& p : patches) shares.push_back(p.beyond[k]);
        const double middle = median(shares), most = quantile(shares, 0.9),
                     bound = predicted_beyond(kRates[k]);
        holds = holds && most <= bound && middle < last;
        last = middle;
        const auto percent = [](double share) { return fmt::format("{:.3f} %", 100 * share); };
        table.rows.push_back({fmt::format("{:g}", kRates[k]), percent(bound), percent(middle),
                              percent(most), percent(quantile(shares, 1))});
        found += fmt::format("{}{:.3f} %", found.empty() ? "" : ", ", 100 * most);
        s.data["beyond"].push_back(shares);
    }
    s.tables.push_back(std::move(table));
    s.claims.push_back(
        {"sampling_beyond",
         "the predicted spectrum tells the rate: beyond half of 2, 3 and 4 samples per deviation "
         "lies no more energy than a Gaussian has there",
         "drawn, without figures",
         fmt::format(
             "falls with the rate; in 90 % of the patches at most {:.3g}, {:.2g} and {:.2g} %",
             100 * predicted_beyond(2), 100 * predicted_beyond(3), 100 * predicted_beyond(4)),
         found, last, holds, command});
}

void add_alias(Section& s, const std::vector<Alias>& aliases, const std::string& command) {
    bool holds = true;
    std::string found, asked;
    for (const Alias& a : aliases) {
        holds = holds && a.measured <= a.predicted;
        found += fmt::format("{}{:.2g} %", found.empty() ? "" : ", ", 100 * a.measured);
        asked += fmt::format("{}{:.2g} %", asked.empty() ? "" : ", ", 100 * a.predicted);
        s.data["alias"].push_back({{"rate", a.rate},
                                   {"spacing", a.comb.spacing},
                                   {"measured", a.measured},
                                   {"predicted", a.predicted}});
    }
    s.claims.push_back({"sampling_replicas",
                        "energy that replicas leave behind the filter with the signal's covariance",
                        "drawn, without figures",
                        "at most the sum of exp(-½ qᵀ S⁻¹ q) over the replicas q: " + asked, found,
                        aliases.back().measured, holds, command});
}

}  // namespace

Section sampling(Workshop& workshop) {
    Section s;
    s.name = "sampling";
    s.title = "sampling: a comb's replicas at three rates (section 5.1, before figure 5.6)";
    s.thesis =
        "The thesis draws why the covariance gives the density of samples: sampling repeats the "
        "spectrum at every tooth of the comb's own, and the replicas must not reach into the "
        "filter that reconstructs the signal.";
    LoadedScene& scene = shared_scene(workshop, kSnookerScene);
    const Reference& reference = shared_reference(workshop, kSnookerScene);
    s.resolution = scene.resolution;
    s.counts = fmt::format("prediction of {:g} samples a pixel, seed {}; light of 2 x {:g}",
                           workshop.settings.spp, workshop.settings.seeds.front(),
                           workshop.settings.reference_spp);
    RenderOptions options;
    options.method = Method::covariance;
    options.spp = workshop.settings.spp;
    options.seed = workshop.settings.seeds.front();
    const Timed prediction = workshop.render(scene, options);
    const std::vector<Patch> patches = patches_of(reference, prediction.result.image);
    const Patch& patch = *std::max_element(
        patches.begin(), patches.end(),
        [](const Patch& a, const Patch& b) { return a.tightness() < b.tightness(); });
    std::vector<Alias> aliases;
    Figure figure{"sampling",
                  "",
                  drawn(reference.mean(), patch, aliases),
                  {reference.command(0), reference.command(1), prediction.command}};
    figure.caption = fmt::format(
        "Pixels {},{} to {},{} of the snooker table (the mean of the reference's halves) in a "
        "Gaussian window: of {} patches the one whose spectrum comes nearest to the predicted, "
        "with "
        "{:.2f} of its variance. Above: the samples of a comb at 2, 3 and 4 per deviation "
        "of the predicted spectrum. Middle: amplitudes, a hundredth of the largest at black; "
        "two deviations of the predicted spectrum (orange) and of its replicas (cyan), and half "
        "the rate (red). Below: the samples through the Gaussian with the signal's covariance "
        "(c = 1), and the energy that differs from all pixels through it (mean over 16 places of "
        "the comb). At two deviations the replicas' ellipses overlap at rates 2 and 3 and touch at "
        "4.",
        patch.bounds.x0, patch.bounds.y0, patch.bounds.x1, patch.bounds.y1, patches.size(),
        patch.tightness());
    s.figures.push_back(std::move(figure));
    const std::string command = reproduce_command(workshop, s.name);
    add_beyond(s, patches, command);
    add_alias(s, aliases, command);
    s.notes.push_back(
        "A patch's predicted spectrum is the mean of its pixels' spectra after lens and shutter, "
        "weighted by the light, plus the window's. In one dimension the teeth of the comb are "
        "1/a apart for samples a pixels apart; at m samples per deviation they are m deviations "
        "apart. In five dimensions that makes N = m^5 √|S|, the thesis' count with k = m^5. Half "
        "the rate is m/2 deviations of the amplitudes, so that a Gaussian has the share "
        "erfc(m/2) of its energy beyond it on one axis, and at most twice that on both: the "
        "bounds of the first claim. In the bounds of the second q is the place of a replica in "
        "frequency and S the predicted spectrum.");
    return s;
}

}  // namespace covtrace::reproduce
