#include "reproduce/space_time.h"

#include <cmath>

#include "core/parallel.h"
#include "laboratory/fields.h"

namespace covtrace::reproduce {

Grid light_field(const RenderScene& scene, std::array<int, 2> size, int row, uint64_t seed) {
    constexpr uint32_t kSubsamples = 16;  // of a pixel in a slot
    Grid grid(size[0], kSlots * kIntervals);
    const SensorRays rays(scene, {0.5f * float(size[0]), float(row) + 0.5f});
    const LocalField field = radiance_field(scene, rays, scene.description.max_depth, seed);
    parallel_for(grid.height, [&](int64_t slot) {
        for (int x = 0; x < grid.width; ++x) {
            double sum = 0;
            for (uint32_t i = 0; i < kSubsamples; ++i) {
                Sampler sampler(seed, x, int(slot), i);
                const Sampler::CameraSample u = sampler.camera();
                const PixelFilter::Sample at = scene.filter.sample(u.film);
                const double time = (double(slot) + double(u.time)) / grid.height;
                const SensorOffset offset{x + 0.5 - 0.5 * size[0] + double(at.offset.x),
                                          double(at.offset.y), 0, 0, time - 0.5};
                sum += double(at.weight) * field(offset, i);
            }
            grid.at(x, int(slot)) = sum / kSubsamples;
        }
    });
    return grid;
}

Grid while_open(const Grid& slice) {
    Grid open = slice;
    for (int slot = 0; slot < open.height; ++slot)
        if (slot / kSlots != kIntervals / 2)
            for (int x = 0; x < open.width; ++x) open.at(x, slot) = 0;
    return open;
}

Grid integrated(const Grid& slice) {
    const Grid open = while_open(slice);
    Grid row(open.width, 1);
    for (int slot = 0; slot < open.height; ++slot)
        for (int x = 0; x < open.width; ++x) row.at(x, 0) += open.at(x, slot) / kSlots;
    return row;
}

Grid moment(const Grid& slice, int slot) {
    Grid row(slice.width, 1);
    for (int x = 0; x < slice.width; ++x) row.at(x, 0) = slice.at(x, slot);
    return row;
}

Grid without_mean(const Grid& grid, std::array<double, 2> window) {
    Grid ones(grid.width, grid.height);
    for (double& value : ones.values) value = 1;
    const Grid weights = windowed(ones, window);
    double sum = 0, all = 0;
    for (size_t i = 0; i < grid.values.size(); ++i) {
        sum += weights.values[i] * grid.values[i];
        all += weights.values[i];
    }
    Grid result = grid;
    for (double& value : result.values) value -= sum / all;
    return result;
}

SpaceTimeCovariance measured_covariance(const std::vector<Grid>& slices,
                                        std::array<double, 2> window) {
    SpaceTimeCovariance m;
    double energy = 0, energy_behind = 0;
    for (const Grid& slice : slices) {
        const GridSpectrum spectrum(windowed(slice, window));
        for (int j = 0; j < spectrum.height(); ++j)
            for (int i = 0; i < spectrum.width(); ++i) {
                const double e = std::norm(spectrum.at(i, j));
                const double x = spectrum.frequency_x(i), t = kSlots * spectrum.frequency_y(j);
                energy += e;
                m.xx += 2 * e * x * x;
                m.xt += 2 * e * x * t;
                m.tt += 2 * e * t * t;
            }
        const GridSpectrum behind(windowed(integrated(slice), window));
        for (int i = 0; i < behind.width(); ++i) {
            const double e = std::norm(behind.at(i, 0)), x = behind.frequency_x(i);
            energy_behind += e;
            m.behind += 2 * e * x * x;
        }
    }
    for (double* value : {&m.xx, &m.xt, &m.tt}) *value /= energy;
    m.behind /= energy_behind;
    m.xx -= window_variance(window[0]);
    m.tt -= window_variance(window[1] / kSlots);
    m.behind -= window_variance(window[0]);
    return m;
}

}  // namespace covtrace::reproduce
