#include "shading/medium.h"

#include <cmath>

namespace covtrace {

namespace {

float pass(float coefficient, float distance) {
    return coefficient > 0 ? std::exp(-coefficient * distance) : 1.0f;
}

}  // namespace

Rgb Medium::albedo() const {
    const Rgb t = extinction();
    const auto share = [](float part, float whole) { return whole > 0 ? part / whole : 0.0f; };
    return {share(scattering.r, t.r), share(scattering.g, t.g), share(scattering.b, t.b)};
}

Rgb transmittance(const Medium& medium, float distance) {
    const Rgb s = medium.extinction();
    return {pass(s.r, distance), pass(s.g, distance), pass(s.b, distance)};
}

Rgb emitted_along(const Medium& medium, float distance) {
    Rgb sum;
    const Rgb extinction = medium.extinction();
    for (int c = 0; c < 3; ++c) {
        if (!(medium.absorption[c] > 0 && medium.emission[c] > 0)) continue;
        sum[c] = medium.absorption[c] / extinction[c] * medium.emission[c] *
                 -std::expm1(-extinction[c] * distance);
    }
    return sum;
}

MediumEvent sample_event(const Medium& medium, float length, Rgb throughput, Vec2 u) {
    const Rgb through = transmittance(medium, length);
    const float sum = throughput.r + throughput.g + throughput.b;
    if (!medium.scatters() || !(sum > 0)) return {false, length, through};

    const Rgb share = throughput * (1 / sum), extinction = medium.extinction(),
              albedo = medium.albedo();
    int channel = 0;
    float v = u.x;
    while (channel < 2 && v >= share[channel]) v -= share[channel++];
    const bool tries = v < albedo[channel] * share[channel];  // rather than be absorbed
    const float distance = tries ? -std::log1p(-u.y) / extinction[channel] : length;
    if (tries && distance < length) {
        const Rgb value = medium.scattering * transmittance(medium, distance);
        const float density = share.r * value.r + share.g * value.g + share.b * value.b;
        return {true, distance, density > 0 ? value * (1 / density) : Rgb(0)};
    }
    float probability = 0;
    for (int c = 0; c < 3; ++c) probability += share[c] * (1 - albedo[c] * (1 - through[c]));
    return {false, length, probability > 0 ? through * (1 / probability) : Rgb(0)};
}

}  // namespace covtrace
