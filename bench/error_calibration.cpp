/// Whether the layer `error` tells the error that is measured.
///
///     error_calibration REFERENCE.exr REFERENCE2.exr IMAGE.exr ...
///
/// The references are two independent converged images; the images are of the same scene with other
/// seeds. Sorts the 16 x 16 tiles of all images by their estimated squared error and prints for 20
/// bins of equally many tiles the means of the estimated and of the true one, and their ratio; then
/// in how many bins it lies between 0.7 and 1.4, and the ratio of the whole. Squared errors are
/// those of the luminance over Y^2 + 0.01, Y of the references. The true ones are (Y - R)(Y - R2):
/// their mean has no part of the references' own noise.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "image/image.h"

using namespace covtrace;

namespace {

struct Tile {
    double estimated = 0, real = 0;
    void operator+=(const Tile& t) {
        estimated += t.estimated;
        real += t.real;
    }
};

void add_tiles(const Image& image, const std::array<Image, 2>& reference,
               std::vector<Tile>& tiles) {
    constexpr int kSide = 16;
    const Channel* error = image.find("error.Y");
    if (!error) throw Error(ErrorKind::usage, "an image has no layer `error`: --layers error");
    const int w = image.width(), across = (w + kSide - 1) / kSide;
    const size_t first = tiles.size();
    tiles.resize(first + size_t(across) * size_t((image.height() + kSide - 1) / kSide));
    for (size_t i = 0; i < image.pixel_count(); ++i) {
        const int x = int(i) % w, y = int(i) / w;
        const float a = luminance(reference[0].rgb(i)), b = luminance(reference[1].rgb(i)),
                    v = luminance(image.rgb(i));
        const double scale = 1 / (sqr(0.5 * double(a + b)) + 0.01);
        tiles[first + size_t(y / kSide * across + x / kSide)] +=
            {scale * sqr(double(error->values[i])), scale * double(v - a) * double(v - b)};
    }
}

void print_bins(std::vector<Tile> tiles) {
    std::sort(tiles.begin(), tiles.end(),
              [](const Tile& a, const Tile& b) { return a.estimated < b.estimated; });
    constexpr size_t kBins = 20;
    int good = 0;
    Tile all;
    fmt::print("bin   estimated        true  ratio\n");
    for (size_t bin = 0; bin < kBins; ++bin) {
        const size_t from = bin * tiles.size() / kBins, to = (bin + 1) * tiles.size() / kBins;
        Tile sum;
        for (size_t i = from; i < to; ++i) sum += tiles[i];
        all += sum;
        const double pixels = 256.0 * double(to - from), ratio = sum.real / sum.estimated;
        if (ratio >= 0.7 && ratio <= 1.4) ++good;
        fmt::print("{:3} {:11.3g} {:11.3g} {:6.2f}\n", bin + 1, sum.estimated / pixels,
                   sum.real / pixels, ratio);
    }
    fmt::print("{} of {} bins within 0.7 and 1.4; the whole: {:.2f}\n", good, kBins,
               all.real / all.estimated);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 4) {
        fmt::print(stderr, "usage: error_calibration REFERENCE REFERENCE2 IMAGE ...\n");
        return 2;
    }
    try {
        const std::array<Image, 2> reference{read_image(argv[1]), read_image(argv[2])};
        std::vector<Tile> tiles;
        for (int i = 3; i < argc; ++i) {
            const Image image = read_image(argv[i]);
            if (image.data != reference[0].data || image.data != reference[1].data)
                throw Error(ErrorKind::usage,
                            fmt::format("{}: has other pixels than the references", argv[i]));
            add_tiles(image, reference, tiles);
        }
        print_bins(std::move(tiles));
    } catch (const std::exception& e) {
        fmt::print(stderr, "error_calibration: {}\n", e.what());
        return 1;
    }
}
