#include "render/round.h"

#include <cmath>
#include <limits>

#include "render/layers.h"

namespace covtrace {

double estimated_error(const Film& film) {
    constexpr double kFloor = 0.01;  // constant in the denominator of relMSE
    double sum = 0;
    size_t known = 0;
    for (const FilmPixel& p : film.pixels) {
        if (p.count < 2) continue;
        ++known;
        const Rgb variance = p.variance_of_mean();
        for (int c = 0; c < 3; ++c)
            sum += double(variance[c]) / (double(p.mean[c]) * double(p.mean[c]) + kFloor);
    }
    if (2 * known < film.pixels.size()) return std::numeric_limits<double>::quiet_NaN();
    return std::sqrt(sum / (3 * double(known)));
}

void show_round(const Monitor& monitor, const Film& film, const PixelBounds& display,
                bool has_holes) {
    monitor.show(make_layers(film, display, has_holes, std::nullopt));
}

}  // namespace covtrace
