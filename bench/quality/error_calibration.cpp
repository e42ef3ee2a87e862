/// The layer `error` beside the error that is measured.
///
///     error_calibration REFERENCE.exr REFERENCE2.exr IMAGE.exr ...
///
/// The references are two independent converged images; the images are of the same scene with other
/// seeds. Sorts the tiles of all images (16 x 16 pixels; 8 x 8 where that makes fewer than 200 of
/// an image) by their estimated squared error and prints for 20 bins of equally many tiles the
/// means of the estimated and of the true one, and their ratio; then that ratio in ten groups of
/// 8 x 8 blocks sorted by the mean of the references' luminance (relative errors only), which shows
/// dark parts; then in how many bins it lies between 0.7 and 1.4, and the ratio of the whole. Once
/// with squared errors of the luminance over Y^2 + 0.01, Y of the references, and once with squared
/// errors as they are. The true ones are (Y - R)(Y - R2): their mean has no part of the references'
/// own noise.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "image/brightness_deciles.h"
#include "image/image.h"
#include "support/error_bins.h"

using namespace covtrace;

namespace {

struct Measures {
    std::vector<ErrorTile> relative, absolute;
    std::array<ErrorTile, kDeciles> relative_by_brightness;
};

void add_by_brightness(const Plane& estimated, const Plane& real, const Plane& reference,
                       std::array<ErrorTile, kDeciles>& sums) {
    const std::vector<uint8_t> deciles = brightness_deciles(reference);
    for (size_t i = 0; i < deciles.size(); ++i)
        if (deciles[i] != kNoDecile) sums[deciles[i]] += {estimated[i], real[i], 1};
}

void add_tiles(const Image& image, const std::array<Image, 2>& reference, Measures& tiles) {
    const Channel* error = image.find("error.Y");
    if (!error) throw Error(ErrorKind::usage, "an image has no layer `error`: --layers error");
    Plane estimated(image.width(), image.height()), real = estimated, brightness = estimated;
    for (size_t i = 0; i < image.pixel_count(); ++i) {
        const float a = luminance(reference[0].rgb(i)), b = luminance(reference[1].rgb(i)),
                    v = luminance(image.rgb(i));
        brightness[i] = 0.5f * (a + b);
        estimated[i] = sqr(error->values[i]);
        real[i] = (v - a) * (v - b);
    }
    const int side = tile_side(image.width(), image.height());
    for (const ErrorTile& t : error_tiles(estimated, real, side)) tiles.absolute.push_back(t);
    for (Plane* p : {&estimated, &real})
        for (size_t i = 0; i < p->size(); ++i) (*p)[i] /= sqr(brightness[i]) + 0.01f;
    for (const ErrorTile& t : error_tiles(estimated, real, side)) tiles.relative.push_back(t);
    add_by_brightness(estimated, real, brightness, tiles.relative_by_brightness);
}

void print_bins(const Measures& tiles) {
    const std::array<ErrorBins, 2> measures{error_bins(tiles.relative), error_bins(tiles.absolute)};
    fmt::print("     relative                     absolute\n");
    fmt::print("bin  estimated       true  ratio  estimated       true  ratio\n");
    for (size_t k = 0; k < kErrorBins; ++k) {
        fmt::print("{:3}", k + 1);
        for (const ErrorBins& bins : measures) {
            const ErrorTile& bin = bins.bins[k];
            fmt::print(" {:10.3g} {:10.3g} {:6.2f}", bin.estimated / bin.pixels,
                       bin.real / bin.pixels, bin.ratio());
        }
        fmt::print("\n");
    }
    fmt::print("relative by brightness, darkest first:");
    for (const ErrorTile& decile : tiles.relative_by_brightness)
        fmt::print(" {:.2f}", decile.ratio());
    fmt::print("\n");
    fmt::print(
        "of {} bins within 0.7 and 1.4 / the whole: relative {} / {:.2f}, absolute {} / {:.2f}\n",
        kErrorBins, measures[0].good, measures[0].all.ratio(), measures[1].good,
        measures[1].all.ratio());
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 4) {
        fmt::print(stderr, "usage: error_calibration REFERENCE REFERENCE2 IMAGE ...\n");
        return 2;
    }
    try {
        const std::array<Image, 2> reference{read_image(argv[1]), read_image(argv[2])};
        Measures tiles;
        for (int i = 3; i < argc; ++i) {
            const Image image = read_image(argv[i]);
            if (image.data != reference[0].data || image.data != reference[1].data)
                throw Error(ErrorKind::usage,
                            fmt::format("{}: has other pixels than the references", argv[i]));
            add_tiles(image, reference, tiles);
        }
        print_bins(tiles);
    } catch (const std::exception& e) {
        fmt::print(stderr, "error_calibration: {}\n", e.what());
        return 1;
    }
}
