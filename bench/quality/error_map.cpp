/// A map of where the error of images is.
///
///     error_map MAP.png REFERENCE.exr IMAGE.exr ...
///
/// MAP shows the reference and, for every image, the root of its relative squared error per pixel,
/// sqrt(mean over the channels of (I - R)^2 / (R^2 + 0.01)). Prints each image's share of its error
/// in the worst 1 % and 10 % of its pixels.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "image/image.h"
#include "support/false_colour.h"

using namespace covtrace;

namespace {

std::vector<float> squared_errors(const Image& image, const Image& reference) {
    std::vector<float> result;
    for (size_t i = 0; i < reference.pixel_count(); ++i) {
        const Rgb v = image.rgb(i), r = reference.rgb(i);
        float sum = 0;
        for (int k = 0; k < 3; ++k) sum += sqr(v[k] - r[k]) / (r[k] * r[k] + 0.01f) / 3;
        result.push_back(sum);
    }
    return result;
}

void print_concentration(const char* file, std::vector<float> errors) {
    std::sort(errors.rbegin(), errors.rend());
    const double all = std::accumulate(errors.begin(), errors.end(), 0.0);
    const auto share = [&](size_t divisor) {
        return 100 *
               std::accumulate(errors.begin(), errors.begin() + ptrdiff_t(errors.size() / divisor),
                               0.0) /
               all;
    };
    fmt::print(
        "{}: relMSE {:.5f}, {:.0f} % of it in the worst 1 % of the pixels, {:.0f} % in 10 %\n",
        file, all / double(errors.size()), share(100), share(10));
}

void write_map(const char* map, const char* reference_file, std::span<char*> files) {
    const LogColours colours{{{0.003f, {0, 0, 0}},
                              {0.01f, {0, 0.05f, 0.4f}},
                              {0.03f, {0.1f, 0.6f, 0.2f}},
                              {0.1f, {1, 0.8f, 0}},
                              {0.3f, {1, 0, 0}},
                              {1, {1, 1, 1}}}};
    const Image reference = read_image(reference_file);
    PanelPicture picture(reference.width(), reference.height());
    std::vector<Rgb> panel;
    for (size_t i = 0; i < reference.pixel_count(); ++i) panel.push_back(reference.rgb(i));
    picture.add(panel);
    for (const char* file : files) {
        const Image image = read_image(file);
        if (image.data != reference.data)
            throw Error(ErrorKind::usage,
                        fmt::format("{}: has other pixels than the reference", file));
        const std::vector<float> errors = squared_errors(image, reference);
        std::transform(errors.begin(), errors.end(), panel.begin(),
                       [&](float e) { return colours(std::sqrt(e)); });
        picture.add(panel, colours, {0.003f, 0.01f, 0.03f, 0.1f, 0.3f, 1});
        print_concentration(file, errors);
    }
    picture.write_png(map);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 4) {
        fmt::print(stderr, "usage: error_map MAP.png REFERENCE IMAGE ...\n");
        return 2;
    }
    try {
        write_map(argv[1], argv[2], std::span(argv + 3, argv + argc));
    } catch (const std::exception& e) {
        fmt::print(stderr, "error_map: {}\n", e.what());
        return 1;
    }
}
