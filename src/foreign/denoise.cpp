#include "foreign/denoise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/display_exposure.h"
#include "core/error.h"
#include "foreign/image_halves.h"
#include "foreign/noise_correlation.h"
#include "foreign/phased_denoiser.h"
#include "image/exr_names.h"
#include "image/finite_pixels.h"
#include "reconstruction/hybrid.h"
#include "reconstruction/luminance.h"

namespace covtrace {

namespace {

/// Correlation of neighbours' noise from which on pixels share samples. Of images with noise of
/// their own it is within 0.03 of 0, of 128x96 pixels.
constexpr float kShared = 0.1f;

std::string size_of(const Image& image) {
    return std::to_string(image.width()) + "x" + std::to_string(image.height());
}

void require_same_window(const NamedImage& a, const NamedImage& b) {
    const auto refuse = [&](const std::string& what) {
        throw Error(ErrorKind::usage, b.name + ": expected another render of the picture of " +
                                          a.name + ", but " + what);
    };
    if (a.image.width() != b.image.width() || a.image.height() != b.image.height())
        refuse("it has " + size_of(b.image) + " pixels, that has " + size_of(a.image));
    if (!(a.image.data == b.image.data) || !(a.image.display == b.image.display))
        refuse("their pixels are in different places of the frame");
}

/// Refuses two images with the same pixels, but those that are black, as the frames are in which a
/// picture has not been faded in yet.
void require_other_noise(const NamedImage& a, const FoundLayers& of_a, const NamedImage& b,
                         const FoundLayers& of_b) {
    bool is_black = true;
    for (size_t k = 0; k < 3; ++k)
        for (size_t i = 0; i < a.image.pixel_count(); ++i) {
            const float va = of_a.color[k]->values[i], vb = of_b.color[k]->values[i];
            if (va != vb && !(std::isnan(va) && std::isnan(vb))) return;
            is_black = is_black && va == 0;
        }
    if (is_black) return;
    throw Error(ErrorKind::usage, b.name + " has the same pixels as " + a.name +
                                      "; expected a render with another seed, whose noise tells "
                                      "how much of it is left");
}

SampledImage sampled(const NamedImage& named, const DenoiseOptions& options) {
    SampledImage s{named.image, find_layers(named.image, options.layers, named.name), {}};
    s.samples = options.samples;
    if (!s.samples && !s.layers.samples) s.samples = samples_in_metadata(named.image);
    if (!options.layers.variance.empty()) s.layers.is_variance_of_one = false;
    return s;
}

void require_variance(const NamedImage& named, const SampledImage& s) {
    const auto has_noise = [](const Channel* c) {
        return std::any_of(c->values.begin(), c->values.end(), [](float v) { return v > 0; });
    };
    if (!s.layers.variance ||
        std::none_of(s.layers.variance->begin(), s.layers.variance->end(), has_noise))
        throw Error(ErrorKind::usage,
                    named.name + (s.layers.variance ? " has a variance of 0" : " has no variance") +
                        "; expected a second render with another seed, or a layer with the "
                        "variance of the pixels");
    if (s.layers.is_variance_of_one && !s.samples)
        throw Error(ErrorKind::usage, OptionName{"samples"},
                    named.name + " has the variance of one sample; expected the samples per pixel");
}

/// The exposure of the images' mean, the same for all of them.
float exposure_of(std::span<const SampledImage> images) {
    Plane mean(images[0].image.width(), images[0].image.height());
    for (size_t i = 0; i < mean.size(); ++i) {
        double sum = 0;
        int known = 0;
        for (const SampledImage& s : images) {
            Rgb c;
            for (size_t k = 0; k < 3; ++k) c[int(k)] = s.layers.color[k]->values[i];
            if (const float y = luminance(c); std::isfinite(y)) {
                sum += double(y);
                ++known;
            }
        }
        mean[i] = known > 0 ? float(sum / known) : 0.0f;
    }
    return exposure_of_unknown_units(mean);
}

void add(Image& image, std::string name, std::vector<float> values) {
    image.add_channel(std::move(name)).values = std::move(values);
}

/// Takes the camera and the colour space over, which are those of the picture; what else files tell
/// is of one render.
void take_metadata(const Image& from, Image& to) {
    for (const char* key : {kChromaticities, kPixelAspectRatio, "worldToCamera", "worldToNDC"})
        if (const auto it = from.metadata.find(key); it != from.metadata.end())
            to.metadata.insert(*it);
}

void add_alpha(std::span<const NamedImage> images, Image& result) {
    std::vector<float> mean(result.pixel_count());
    for (const NamedImage& named : images) {
        const Channel* alpha = named.image.find("A");
        if (!alpha) return;
        for (size_t i = 0; i < mean.size(); ++i) mean[i] += alpha->values[i] / float(images.size());
    }
    add(result, "A", std::move(mean));
}

/// The mean of both halves.
ColorPlanes mean_of(const ColorPlanes& a, const ColorPlanes& b) {
    ColorPlanes mean = a;
    for (size_t k = 0; k < 3; ++k)
        for (size_t i = 0; i < mean[k].size(); ++i) mean[k][i] = 0.5f * (a[k][i] + b[k][i]);
    return mean;
}

double samples_per_pixel(const Halves& halves) {
    double count = 0;
    for (const HalfBuffer& half : halves)
        for (float n : half.count.values) count += double(n);
    return count / double(halves[0].count.size());
}

/// Adds the layer in the units of the images: divided by the exposure, of variances twice.
void add_channels(ColorPlanes planes, const std::string& layer, float exposure, Image& image,
                  int power = 1) {
    for (size_t k = 0; k < 3; ++k) {
        for (float& v : planes[k].values)
            for (int times = 0; times < power; ++times) v /= exposure;
        add(image, layer + "RGB"[k], std::move(planes[k].values));
    }
}

/// Root of the mean relative squared error of the luminance.
double relative_error(const HybridImage& mixed) {
    const Plane bright = luminance(mixed.color);
    double sum = 0, known = 0;
    for (size_t i = 0; i < bright.size(); ++i) {
        const float e = mixed.variance[i] / (sqr(bright[i]) + kDarkSquared);
        if (!std::isfinite(e)) continue;  // brighter than squares can hold
        sum += double(e);
        ++known;
    }
    return std::sqrt(sum / known);
}

void warn_of_missing_features(const FoundLayers& layers, DenoisedImage& result) {
    std::string missing;
    const auto miss = [&](bool has, const char* name) {
        if (!has) missing += (missing.empty() ? "" : ", ") + std::string(name);
    };
    miss(layers.albedo.has_value(), "albedo");
    miss(layers.normal.has_value(), "normal");
    miss(layers.depth || layers.place, "depth");
    if (!missing.empty())
        result.warnings.push_back(
            {{},
             "no layer is known as " + missing + ": edges and textures keep more noise without"});
}

/// Halves of one image or of two, which are checked and exposed.
ImageHalves halves_of(std::span<const NamedImage> images, std::span<SampledImage> samples) {
    if (images.size() == 1) {
        require_variance(images[0], samples[0]);
    } else {
        require_same_window(images[0], images[1]);
        require_other_noise(images[0], samples[0].layers, images[1], samples[1].layers);
    }
    const float exposure = exposure_of(samples);
    for (SampledImage& s : samples) s.exposure = exposure;
    return images.size() == 1 ? halves_of_one(samples[0]) : halves_of_two(samples[0], samples[1]);
}

void tell_denoiser(const DenoiseOptions& options, const HybridImage& mixed, Image& image) {
    if (!mixed.denoiser_failure.empty()) {
        image.metadata["covtrace:denoiserFailure"] = mixed.denoiser_failure;
    } else if (options.denoiser) {
        image.metadata["covtrace:denoiser"] = options.denoiser->name();
        image.metadata["covtrace:denoiserQuality"] = std::string(name_of(options.quality));
    }
}

}  // namespace

DenoisedImage denoise(std::span<const NamedImage> images, const DenoiseOptions& options) {
    if (images.empty() || images.size() > 2)
        throw Error(ErrorKind::usage, "expected one image with its variance, or two images");
    std::vector<SampledImage> samples;
    for (const NamedImage& named : images) samples.push_back(sampled(named, options));
    auto [halves, lost, are_samples_known] = halves_of(images, samples);
    for (size_t k = 0; k < images.size(); ++k)
        if (is_empty(halves[k]))
            throw Error(ErrorKind::usage, images[k].name + " has no pixel that is finite");
    DenoisedImage result;
    warn_of_missing_features(samples[0].layers, result);
    if (lost > 0)
        result.warnings.push_back({{},
                                   std::to_string(lost) + " pixel" + (lost == 1 ? " is" : "s are") +
                                       " not finite, or beyond all light: lost samples"});
    Image& image = result.image;
    image.data = images[0].image.data;
    image.display = images[0].image.display;
    take_metadata(images[0].image, image);
    if (are_samples_known) image.metadata["spp"] = float(samples_per_pixel(halves));

    ColorPlanes raw = mean_of(halves[0].color, halves[1].color),
                variance = mean_of(halves[0].color_variance, halves[1].color_variance);
    // The mean of both halves has half the variance of each
    for (Plane& channel : variance)
        for (float& v : channel.values) v *= 0.5f;
    const float exposure = samples[0].exposure;
    HybridSettings settings;
    settings.denoiser = options.denoiser;
    settings.quality = options.quality;
    settings.noise = HalvesNoise::independent;
    std::optional<PhasedDenoiser> phased;
    if (options.denoiser && neighbours_correlation(halves) > kShared)
        settings.denoiser = &phased.emplace(*options.denoiser);
    HybridImage mixed = reconstruct(std::move(halves), {}, settings);
    tell_denoiser(options, mixed, image);

    result.error = relative_error(mixed);
    add_channels(std::move(mixed.color), "", exposure, image);
    add_alpha(images, image);
    add_channels(std::move(raw), "raw.", exposure, image);
    add_channels(std::move(variance), "variance.", exposure, image, 2);
    for (float& v : mixed.variance.values) v = std::sqrt(v) / exposure;
    add(image, "error.Y", std::move(mixed.variance.values));
    replace_nonfinite(image);
    return result;
}

}  // namespace covtrace
