// Open Image Denoise as most renderers use it: takes the root colours of an image at high quality,
// guided by albedo and normal that are freed of their noise before (`cleanAux`). These are the
// layers featurealbedo and featureN, or albedo and N of an image that has none.
//
//     denoise_image IMAGE.exr DENOISED.exr [thorough|draft|none [draft]]
//
// The third argument says how the features are cleaned, the fourth makes the image itself a draft
// (docs/decisions/0147).
//
// IMAGE.exr is any image of `covtrace render` with its layers; for those of `--method hybrid` the
// layer `raw` is denoised. Prints the seconds that the denoiser took. The library is looked for as
// by the program.
#include <fmt/format.h>

#include <chrono>
#include <map>
#include <string>

#include "core/error.h"
#include "image/image.h"
#include "support/hybrid_samples.h"

using namespace covtrace;

namespace {

std::array<Plane, 3> planes(const Image& image, const std::array<std::string, 3>& names) {
    std::array<Plane, 3> result;
    for (size_t k = 0; k < 3; ++k) {
        const Channel* channel = image.find(names[k]);
        if (!channel) throw Error(ErrorKind::usage, "the image has no channel " + names[k]);
        result[k] = Plane(image.width(), image.height());
        result[k].values = channel->values;
    }
    return result;
}

}  // namespace

int main(int argc, char** argv) {
    const std::map<std::string, FeatureCleaning> cleanings{{"thorough", FeatureCleaning::thorough},
                                                           {"draft", FeatureCleaning::draft},
                                                           {"none", FeatureCleaning::none}};
    const std::string how = argc > 3 ? argv[3] : "thorough", of_image = argc > 4 ? argv[4] : "";
    if (argc < 3 || argc > 5 || !cleanings.contains(how) || (argc == 5 && of_image != "draft")) {
        fmt::print(stderr,
                   "usage: denoise_image IMAGE.exr DENOISED.exr [thorough|draft|none [draft]]\n");
        return 2;
    }
    try {
        const auto denoiser = required_denoiser();
        const Image image = read_image(argv[1]);
        const bool has_raw = image.find("raw.R") != nullptr;
        const auto color =
            planes(image, has_raw ? std::array<std::string, 3>{"raw.R", "raw.G", "raw.B"}
                                  : std::array<std::string, 3>{"R", "G", "B"});
        const std::string prefix = image.find("featureN.X") ? "feature" : "";
        const auto named = [&](const std::string& layer, const char* channels) {
            std::array<std::string, 3> names;
            for (size_t k = 0; k < 3; ++k) names[k] = prefix + layer + "." + channels[k];
            return planes(image, names);
        };
        const NoisyFeatures features{named("albedo", "RGB"), named("N", "XYZ"), cleanings.at(how)};
        const auto start = std::chrono::steady_clock::now();
        const ColorPlanes clean =
            denoiser->denoise(features, {{.color = color, .draft = of_image == "draft"}})[0];
        const double seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        Image result;
        result.data = image.data;
        result.display = image.display;
        for (size_t k = 0; k < 3; ++k)
            result.add_channel(std::string(1, "RGB"[k])).values = clean[k].values;
        write_exr(result, argv[2], 2);
        fmt::print("{:.3f}\n", seconds);
    } catch (const std::exception& e) {
        fmt::print(stderr, "denoise_image: {}\n", e.what());
        return 1;
    }
}
