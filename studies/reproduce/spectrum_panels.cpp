#include "reproduce/spectrum_panels.h"

#include <algorithm>
#include <cmath>

namespace covtrace::reproduce {

namespace {

constexpr float kDeviations = 2;
constexpr double kDecades = 2;

}  // namespace

void SpectrumPanel::amplitudes(const std::string& title, const GridSpectrum& spectrum,
                               Frequency units, double most) {
    const std::array<int, 2> size = sheet_.panel();
    Picture picture(size[0], size[1]);
    // The bin nearest to a pixel of the panel; axes have as many frequencies per cell as bins.
    const auto bin = [&](int pixel, size_t axis, int bins) {
        const double f = range_[axis] * (2 * (pixel + 0.5) / size[axis] - 1);
        return std::clamp(int(std::lround(f / units[axis] * bins)) + bins / 2, 0, bins - 1);
    };
    for (int y = 0; y < size[1]; ++y)
        for (int x = 0; x < size[0]; ++x) {
            const double amplitude =
                std::abs(spectrum.at(bin(x, 0, spectrum.width()), bin(y, 1, spectrum.height())));
            const double share = 1 + std::log10(std::max(amplitude / most, 1e-30)) / kDecades;
            const auto grey = uint8_t(std::lround(255 * std::clamp(share, 0.0, 1.0)));
            std::fill_n(&picture.rgb[3 * (size_t(y) * size_t(size[0]) + size_t(x))], 3, grey);
        }
    sheet_.picture(column_, row_, title, std::move(picture));
}

Vec2 SpectrumPanel::at(Frequency f) const {
    const Vec2 corner = sheet_.corner(column_, row_);
    return {corner.x + sheet_.width() * float(0.5 + 0.5 * f[0] / range_[0]),
            corner.y + sheet_.height() * float(0.5 + 0.5 * f[1] / range_[1])};
}

void SpectrumPanel::ellipse(Frequency middle, const covariance::Sym2<double>& s, Ink ink) {
    const float ux = 0.5f * sheet_.width() / float(range_[0]);
    const float uy = 0.5f * sheet_.height() / float(range_[1]);
    const float square = kDeviations * kDeviations;
    const covariance::Sym2<float> c{square * ux * ux * float(s.xx), square * ux * uy * float(s.xy),
                                    square * uy * uy * float(s.yy)};
    const Vec2 p = at(middle), corner = sheet_.corner(column_, row_);
    const float rx = std::sqrt(c.xx), ry = std::sqrt(c.yy);
    if (p.x - rx < corner.x || p.x + rx > corner.x + sheet_.width() || p.y - ry < corner.y ||
        p.y + ry > corner.y + sheet_.height())
        return;
    sheet_.drawing.ellipse(p.x, p.y, c, ink, 1.6f);
}

void SpectrumPanel::box(Frequency half, Ink ink) {
    const Vec2 low = at({-half[0], -half[1]}), high = at(half);
    sheet_.drawing.frame(low.x, low.y, high.x - low.x, high.y - low.y, ink, 1);
}

double largest_amplitude(const GridSpectrum& spectrum) {
    double most = 0;
    for (int j = 0; j < spectrum.height(); ++j)
        for (int i = 0; i < spectrum.width(); ++i)
            most = std::max(most, std::abs(spectrum.at(i, j)));
    return most;
}

}  // namespace covtrace::reproduce
