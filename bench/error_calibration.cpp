/// Whether the layer `error` tells the error that is measured.
///
///     error_calibration REFERENCE.exr REFERENCE2.exr IMAGE.exr ...
///
/// The references are two independent converged images; the images are of the same scene with other
/// seeds. Sorts the tiles of all images (16 x 16 pixels; 8 x 8 where that makes fewer than 200 of
/// an image) by their estimated squared error and prints for 20 bins of equally many tiles the
/// means of the estimated and of the true one, and their ratio; then in how many bins it lies
/// between 0.7 and 1.4, and the ratio of the whole. Once with squared errors of the luminance over
/// Y^2 + 0.01, Y of the references, and once with squared errors as they are. The true ones are
/// (Y - R)(Y - R2): their mean has no part of the references' own noise.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "error_bins.h"
#include "image/image.h"

using namespace covtrace;

namespace {

struct Measures {
    std::vector<ErrorTile> relative, absolute;
};

void add_tiles(const Image& image, const std::array<Image, 2>& reference, Measures& tiles) {
    const Channel* error = image.find("error.Y");
    if (!error) throw Error(ErrorKind::usage, "an image has no layer `error`: --layers error");
    Plane estimated(image.width(), image.height()), real = estimated, scale = estimated;
    for (size_t i = 0; i < image.pixel_count(); ++i) {
        const float a = luminance(reference[0].rgb(i)), b = luminance(reference[1].rgb(i)),
                    v = luminance(image.rgb(i));
        scale[i] = 1 / (sqr(0.5f * (a + b)) + 0.01f);
        estimated[i] = sqr(error->values[i]);
        real[i] = (v - a) * (v - b);
    }
    const int side = tile_side(image.width(), image.height());
    for (const ErrorTile& t : error_tiles(estimated, real, side)) tiles.absolute.push_back(t);
    for (Plane* p : {&estimated, &real})
        for (size_t i = 0; i < p->size(); ++i) (*p)[i] *= scale[i];
    for (const ErrorTile& t : error_tiles(estimated, real, side)) tiles.relative.push_back(t);
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
