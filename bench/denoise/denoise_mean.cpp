// The usual way with images of another renderer: the mean of the renders that there are, and
// that mean through Open Image Denoise at high quality, guided by albedo and normal that are freed
// of their noise before (`cleanAux`).
//
//     denoise_mean MEAN.exr DENOISED.exr IMAGE.exr [IMAGE.exr ...]
//
// The layers are found as `covtrace denoise` finds them, the library as by the program. MEAN.exr
// gets R, G, B alone.
#include <fmt/format.h>

#include <span>

#include "foreign/layer_search.h"
#include "image/image.h"
#include "image/layer_names.h"
#include "support/hybrid_samples.h"

using namespace covtrace;

namespace {

void add(const LayerChannels& channels, float weight, std::array<Plane, 3>& sum) {
    for (size_t k = 0; k < 3; ++k)
        for (size_t i = 0; i < sum[k].size(); ++i) sum[k][i] += weight * channels[k]->values[i];
}

void write(const ColorPlanes& color, const Image& like, const char* file) {
    Image image;
    image.data = like.data;
    image.display = like.display;
    for (size_t k = 0; k < 3; ++k)
        image.add_channel(std::string(1, "RGB"[k])).values = color[k].values;
    write_exr(image, file, 2);
}

void denoise_mean(const char* mean, const char* denoised, std::span<char*> files) {
    const auto denoiser = required_denoiser();
    Image first = read_image(files[0]);
    restore_layer_names(first);
    const Plane none(first.width(), first.height());
    ColorPlanes color{none, none, none};
    NoisyFeatures features{color, color};
    for (const char* file : files) {
        Image image = read_image(file);
        restore_layer_names(image);
        if (image.data != first.data)
            throw Error(ErrorKind::usage,
                        fmt::format("{}: has other pixels than {}", file, files[0]));
        const FoundLayers layers = find_layers(image, {}, file);
        if (!layers.albedo || !layers.normal)
            throw Error(ErrorKind::usage, fmt::format("{}: has no albedo or no normal", file));
        const float weight = 1 / float(files.size());
        add(layers.color, weight, color);
        add(*layers.albedo, weight, features.albedo);
        add(*layers.normal, weight, features.normal);
    }
    write(color, first, mean);
    write(denoiser->denoise(features, {{.color = color}})[0], first, denoised);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 4) {
        fmt::print(stderr, "usage: denoise_mean MEAN.exr DENOISED.exr IMAGE.exr ...\n");
        return 2;
    }
    try {
        denoise_mean(argv[1], argv[2], std::span(argv + 3, size_t(argc - 3)));
    } catch (const std::exception& e) {
        fmt::print(stderr, "denoise_mean: {}\n", e.what());
        return 1;
    }
}
