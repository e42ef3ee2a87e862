#include "foreign/image_halves.h"

#include <algorithm>
#include <cmath>

#include "core/display_exposure.h"
#include "core/hash.h"
#include "core/vec.h"
#include "reconstruction/luminance.h"

namespace covtrace {

namespace {

/// Samples of a half where nobody knows them: they only decide how much a told error is raised for
/// the noise that halves of few samples share.
constexpr float kUnknownSamples = 8;
constexpr float kFarthest = 1e9f;  // distance from which on a depth stands for the background

bool is_finite(const LayerChannels& channels, size_t i) {
    return std::all_of(channels.begin(), channels.end(),
                       [i](const Channel* c) { return std::isfinite(c->values[i]); });
}

bool is_finite(const std::optional<LayerChannels>& channels, size_t i) {
    return !channels || is_finite(*channels, i);
}

/// Whether light can be reckoned with: infinite and undefined values cannot.
bool is_light(const Rgb& exposed) {
    return std::abs(exposed.r) <= kBrightestShown && std::abs(exposed.g) <= kBrightestShown &&
           std::abs(exposed.b) <= kBrightestShown;
}

Rgb exposed_color(const SampledImage& s, size_t i) {
    Rgb c;
    for (size_t k = 0; k < 3; ++k) c[int(k)] = s.exposure * s.layers.color[k]->values[i];
    return c;
}

/// The logarithm of the distance, as the reconstruction has it: 0 where nothing is seen.
float log_depth(const FoundLayers& layers, size_t i) {
    float z = 0;
    if (layers.depth)
        z = layers.depth->values[i];
    else if (layers.place)
        z = std::hypot((*layers.place)[0]->values[i], (*layers.place)[1]->values[i],
                       (*layers.place)[2]->values[i]);
    return z > 0 && z < kFarthest ? std::log(z) : 0.0f;
}

float samples_of(const SampledImage& s, size_t i) {
    if (s.samples) return *s.samples;
    return s.layers.samples ? s.layers.samples_unit * s.layers.samples->values[i] : kUnknownSamples;
}

bool are_samples_known(const SampledImage& s) {
    return s.samples || s.layers.samples;
}

/// The image as a half; lost pixels have the count 0, and are filled.
HalfBuffer half_of(const SampledImage& s) {
    const FoundLayers& layers = s.layers;
    HalfBuffer half(s.image.width(), s.image.height());
    for (size_t i = 0; i < half.count.size(); ++i) {
        const Rgb color = exposed_color(s, i);
        if (!is_light(color) || !is_finite(layers.albedo, i) || !is_finite(layers.normal, i))
            continue;
        const float samples = samples_of(s, i);
        half.count[i] = std::isfinite(samples) ? std::max(0.0f, samples) : 0.0f;
        for (size_t k = 0; k < 3; ++k) {
            half.color[k][i] = color[int(k)];
            if (layers.albedo) half.feature[k][i] = (*layers.albedo)[k]->values[i];
            if (layers.normal) half.feature[3 + k][i] = (*layers.normal)[k]->values[i];
        }
        half.feature[6][i] = log_depth(layers, i);
    }
    fill_holes(half);
    return half;
}

/// The variances of a pixel's mean. What a pixel knows of its own spread counts as its samples, and
/// that of the 7 x 7 pixels around it as one more: pixels that rare light has missed would else
/// seem to be without noise.
ColorPlanes variance_of(const SampledImage& s, const Plane& count) {
    constexpr int kReach = 3;
    const float most = sqr(kBrightestShown);
    ColorPlanes variance;
    for (size_t k = 0; k < 3; ++k) {
        Plane v(count.width, count.height);
        for (size_t i = 0; i < v.size(); ++i) {
            const float value = (*s.layers.variance)[k]->values[i];
            const float samples = s.layers.is_variance_of_one ? std::max(1.0f, count[i]) : 1.0f;
            const float exposed = std::min(value / samples * s.exposure * s.exposure, most);
            v[i] = count[i] > 0 && std::isfinite(value) ? std::max(0.0f, exposed) : 0.0f;
        }
        const Plane around = box_blur(v, kReach);
        for (size_t i = 0; i < v.size(); ++i) {
            const float n = std::max(1.0f, count[i]);
            v[i] = ((n - 1) * v[i] + around[i]) / n;
        }
        variance[k] = std::move(v);
    }
    return variance;
}

/// Whether a negative pixel of `half` says nothing of the picture: `other` is far from it, as the
/// two differ nowhere around. Where a filter has negative lobes, what is bright stands beside it
/// and differs as much, and noise that falls below 0 is no farther than other noise.
bool is_lone_negative(const Plane& half, const Plane& other, int x, int y) {
    constexpr int kAround = 2;
    constexpr float kFar = 8;  // times the deviation around: no noise gets there
    if (other(x, y) < 0) return false;
    float sum = 0;
    int count = 0;
    for (int qy = std::max(0, y - kAround); qy <= std::min(half.height - 1, y + kAround); ++qy)
        for (int qx = std::max(0, x - kAround); qx <= std::min(half.width - 1, x + kAround); ++qx) {
            if (qx == x && qy == y) continue;
            sum += sqr(half(qx, qy) - other(qx, qy));
            ++count;
        }
    return sqr(half(x, y) - other(x, y)) * float(count) > sqr(kFar) * sum;
}

/// Gives lone negative pixels of a half the other's colour, and no samples. A network takes
/// negative light for black, and what is black in an even surrounding for a detail.
void replace_lone_negatives(Halves& halves) {
    const std::array<Plane, 2> bright{luminance(halves[0].color), luminance(halves[1].color)};
    for (size_t k = 0; k < 2; ++k) {
        const HalfBuffer& other = halves[1 - k];
        for (int y = 0; y < bright[k].height; ++y)
            for (int x = 0; x < bright[k].width; ++x) {
                const size_t i = size_t(y) * size_t(bright[k].width) + size_t(x);
                if (!(bright[k][i] < 0) || !(other.count[i] > 0) ||
                    !is_lone_negative(bright[k], bright[1 - k], x, y))
                    continue;
                halves[k].count[i] = 0;
                for (size_t c = 0; c < 3; ++c) halves[k].color[c][i] = other.color[c][i];
            }
    }
}

float random_sign(size_t pixel) {
    return hash_combine(0x68616c766573, pixel) >> 63 ? 1.0f : -1.0f;
}

int lost_pixels(const Halves& halves) {
    int lost = 0;
    for (size_t i = 0; i < halves[0].count.size(); ++i)
        if (!(halves[0].count[i] > 0) || !(halves[1].count[i] > 0)) ++lost;
    return lost;
}

}  // namespace

ImageHalves halves_of_two(const SampledImage& a, const SampledImage& b) {
    ImageHalves result{{half_of(a), half_of(b)}};
    Halves& halves = result.halves;
    result.lost = lost_pixels(halves);
    replace_lone_negatives(halves);
    set_variance_from_difference(halves);
    if (a.layers.variance && b.layers.variance) {
        halves[0].color_variance = variance_of(a, halves[0].count);
        halves[1].color_variance = variance_of(b, halves[1].count);
    }
    result.are_samples_known = are_samples_known(a) && are_samples_known(b);
    return result;
}

ImageHalves halves_of_one(const SampledImage& s) {
    const HalfBuffer whole = half_of(s);
    ImageHalves result{{whole, whole}};
    result.lost = lost_pixels(result.halves);
    result.are_samples_known = are_samples_known(s);
    const ColorPlanes variance = variance_of(s, whole.count);
    for (size_t half = 0; half < 2; ++half) {
        HalfBuffer& h = result.halves[half];
        const float sign = half == 0 ? 1.0f : -1.0f;
        for (size_t i = 0; i < h.count.size(); ++i) {
            const float z = sign * random_sign(i);
            h.count[i] *= 0.5f;
            for (size_t k = 0; k < 3; ++k) {
                h.color[k][i] += std::sqrt(variance[k][i]) * z;
                h.color_variance[k][i] = 2 * variance[k][i];
            }
        }
    }
    return result;
}

}  // namespace covtrace
