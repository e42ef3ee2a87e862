/// Errors of images beside two references that are noisy themselves.
///
///     error_by_products REFERENCE.exr REFERENCE2.exr IMAGE.exr ...
///
/// The references are two independent images of the same scene with other seeds. Prints for each
/// image the mean of
///
///     (image - reference) (image - reference2) / (R^2 + 0.01),
///
/// over the three channels and all pixels but the 0.1 % that differ most, R the mean of both
/// references smoothed over 2 pixels. The noise of the references adds nothing to the mean of the
/// products. In the relMSE of `covtrace compare` it adds its square, and, where it is large, more:
/// what divides is noisy, too, and has the least values where the reference happens to be dark, so
/// that images count as bad for being as bright as the truth.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "core/plane.h"
#include "core/vec.h"
#include "image/image.h"

using namespace covtrace;

namespace {

constexpr float kSmoothing = 2, kDark = 0.01f;
constexpr double kTrimmed = 0.001;

struct References {
    std::array<Image, 2> half;
    std::array<Plane, 3> smooth;  ///< mean of both, smoothed

    References(const char* first, const char* second)
        : half{read_image(first), read_image(second)} {
        if (half[0].data != half[1].data)
            throw Error(ErrorKind::usage, "the references have other pixels than each other");
        for (int c = 0; c < 3; ++c) {
            Plane mean(half[0].width(), half[0].height());
            for (size_t i = 0; i < mean.size(); ++i)
                mean[i] = 0.5f * (half[0].rgb(i)[c] + half[1].rgb(i)[c]);
            smooth[size_t(c)] = gaussian_blur(mean, kSmoothing);
        }
    }
};

double error(const Image& image, const References& references) {
    const size_t n = image.pixel_count();
    std::vector<double> products(n), squares(n);
    for (size_t i = 0; i < n; ++i) {
        const Rgb v = image.rgb(i), a = references.half[0].rgb(i), b = references.half[1].rgb(i);
        for (int c = 0; c < 3; ++c) {
            const double weight = 1 / (3 * double(sqr(references.smooth[size_t(c)][i]) + kDark));
            products[i] += weight * double(v[c] - a[c]) * double(v[c] - b[c]);
            squares[i] += weight * sqr(double(v[c]) - 0.5 * double(a[c] + b[c]));
        }
    }
    std::vector<size_t> order(n);
    std::iota(order.begin(), order.end(), size_t(0));
    std::stable_sort(order.begin(), order.end(),
                     [&](size_t i, size_t j) { return squares[i] < squares[j]; });
    order.resize(n - size_t(kTrimmed * double(n)));
    double sum = 0;
    for (size_t i : order) sum += products[i];
    return sum / double(order.size());
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 4) {
        fmt::print(stderr, "usage: error_by_products REFERENCE REFERENCE2 IMAGE ...\n");
        return 2;
    }
    try {
        const References references(argv[1], argv[2]);
        for (int i = 3; i < argc; ++i) {
            const Image image = read_image(argv[i]);
            if (image.data != references.half[0].data)
                throw Error(ErrorKind::usage,
                            fmt::format("{}: has other pixels than the references", argv[i]));
            fmt::print("{:.6f} {}\n", error(image, references), argv[i]);
        }
    } catch (const std::exception& e) {
        fmt::print(stderr, "error_by_products: {}\n", e.what());
        return 1;
    }
}
