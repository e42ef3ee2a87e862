#include "laboratory/edge_spread.h"

#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "core/sampler.h"
#include "core/warp.h"

namespace covtrace {

EdgeSpread edge_spread(const LocalField& field, const LocalField& without, Vec2 direction,
                       double reach, uint32_t samples, uint64_t seed) {
    constexpr uint32_t kBins = 200;
    const uint32_t per_bin = std::max(1u, samples / kBins);
    std::vector<double> profile(kBins);
    parallel_for(kBins, [&](int64_t bin) {
        double sum = 0, whole = 0;
        for (uint32_t i = 0; i < per_bin; ++i) {
            Sampler sampler(seed, int(bin), 1, i);
            const Sampler::CameraSample u = sampler.camera();
            const Vec2 lens = square_to_disc(u.lens);
            const double s = reach * (2 * (double(bin) + u.film.x) / kBins - 1);
            const SensorOffset p{s * direction.x, s * direction.y, lens.x, lens.y,
                                 double(u.time) - 0.5};
            const uint32_t index = uint32_t(bin) * per_bin + i;
            sum += field(p, index);
            whole += without ? without(p, index) : 1;
        }
        profile[size_t(bin)] = sum / whole;
    });
    constexpr uint32_t kEnd = kBins / 10;
    EdgeSpread e;
    for (uint32_t i = 0; i < kEnd; ++i) {
        e.low += profile[i] / kEnd;
        e.high += profile[kBins - 1 - i] / kEnd;
    }
    // Integrate by parts, with h from 0 to 1 and h' the line spread function on [-r, r]:
    // <s> = r - Int h ds,  <s^2> = r^2 - 2 Int s h ds.
    double first = 0, second = 0;
    const double step = 2 * reach / kBins;
    for (uint32_t i = kEnd; i < kBins; ++i) {
        const double s = reach * (2 * (i + 0.5) / kBins - 1);
        const double h = i < kBins - kEnd ? (profile[i] - e.low) / (e.high - e.low) : 1.0;
        first += h * step;
        second += 2 * s * h * step;
    }
    e.centre = reach - first;
    e.deviation = std::sqrt(std::max(0.0, reach * reach - second - e.centre * e.centre));
    return e;
}

}  // namespace covtrace
