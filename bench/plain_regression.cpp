/// What first-order regression alone makes of the samples (NFOR; Bitterli et al. 2016), for
/// `bench/quality --columns nfor`.
///
///     plain_regression FILM OUT.exr
///
/// The film is that of `covtrace render --method hybrid --checkpoint FILM`. Of the candidates of
/// the hybrid method only plain windows of two tolerances are left, explained by filtered features,
/// the better one of each pixel by the errors that the other half shows.
#include <fmt/format.h>

#include "image/image.h"
#include "planner/covariance_buffer.h"
#include "reconstruction/hybrid.h"
#include "render/film_file.h"
#include "render/hybrid_film.h"

using namespace covtrace;

namespace {

void write_plain_regression(const char* film, const char* out) {
    const RenderState state = read_film(film);
    if (state.films.size() != 2)
        throw Error(ErrorKind::usage, fmt::format("{}: not of --method hybrid", film));
    HybridSettings settings;
    settings.candidates.gaussians.clear();
    settings.candidates.fits = {{0.5f}, {1}};
    settings.mix = false;
    const HybridImage reconstructed = reconstruct(
        halves_of(state.films), preintegrate(smooth(state.covariance())).spectrum, settings);
    Image image;
    image.data = image.display = state.region;
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
