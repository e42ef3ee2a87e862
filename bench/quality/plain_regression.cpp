/// First-order regression alone (NFOR; Bitterli et al. 2016) of the samples of a film, for
/// `bench/quality/gain --columns nfor`.
///
///     plain_regression FILM OUT.exr
///
/// The film is that of `covtrace render --method hybrid --checkpoint FILM`.
#include <fmt/format.h>

#include "image/image.h"
#include "support/hybrid_samples.h"

using namespace covtrace;

namespace {

void write_plain_regression(const char* film, const char* out) {
    const HybridSamples samples = read_hybrid_samples(film);
    const HybridImage reconstructed =
        reconstruct(samples.halves, samples.spectrum, plain_regression());
    Image image;
    image.data = image.display = samples.region;
    for (size_t c = 0; c < 3; ++c)
        image.add_channel(std::string(1, "RGB"[c])).values = reconstructed.color[c].values;
    write_exr(image, out);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        fmt::print(stderr, "usage: plain_regression FILM OUT\n");
        return 2;
    }
    try {
        write_plain_regression(argv[1], argv[2]);
    } catch (const std::exception& e) {
        fmt::print(stderr, "plain_regression: {}\n", e.what());
        return 1;
    }
}
