#include "render/session.h"

#include <unistd.h>

#include <algorithm>
#include <new>
#include <utility>

#include "reconstruction/patch_distance.h"
#include "render/job.h"

namespace covtrace {

std::optional<double> target_spp(const SceneDescription& scene, const RenderOptions& options) {
    const bool ends_otherwise = options.seconds || options.error || options.density_factor;
    if (!options.spp && ends_otherwise) return std::nullopt;
    return options.spp.value_or(scene.samples_per_pixel);
}

namespace {

/// Layers and the buffers of the reconstruction, bytes per pixel: `bench/film_cost memory`.
size_t image_bytes(Method method) {
    return method == Method::uniform ? 68 : method == Method::covariance ? 396 : 488;
}

/// The reconstruction's planes go on beyond the image, by the reach of its filters and by whole
/// blocks of patches: bytes, measured on images of one row and of one column, where they are most
/// of it.
size_t border_bytes(Method method, const PixelBounds& region) {
    if (method != Method::hybrid) return 0;
    constexpr size_t kReach = 2 * 13, kBytes = 160;
    const size_t width = size_t(region.width()), height = size_t(region.height());
    const size_t all = (width + kReach + size_t(kLongestPatchRow)) *
                       (height + kReach + size_t(kLargestPatchBlock));
    return kBytes * (all - width * height);
}

/// What a denoiser adds to that. While it works the candidates are not there, of which only its own
/// stays.
size_t denoiser_bytes(const Denoiser& denoiser, size_t pixels) {
    constexpr size_t kMeanwhile = 310, kCandidate = 36;
    const size_t peak = denoiser.memory(pixels) + kMeanwhile * pixels,
                 otherwise = image_bytes(Method::hybrid) * pixels;
    return std::max(peak, otherwise + kCandidate * pixels) - otherwise;
}

}  // namespace

std::map<std::string, size_t> render_memory(const FilmDescription& film,
                                            const RenderOptions& options) {
    const size_t kept =
        film_bytes_per_pixel(options.method, {options.emitters_apart, options.features});
    const PixelBounds region = render_region(film);
    const size_t pixels = size_t(region.width()) * size_t(region.height());
    std::map<std::string, size_t> bytes{
        {"film", kept * pixels},
        {"image", image_bytes(options.method) * pixels + border_bytes(options.method, region)}};
    if (options.method == Method::hybrid && options.denoiser)
        bytes["denoiser"] = denoiser_bytes(*options.denoiser, pixels);
    return bytes;
}

RenderResult render(RenderScene& scene, const RenderOptions& options, Monitor& monitor,
                    FilmKeeping keeping) {
    const PixelBounds region = render_region(scene.description.film);
    if (region.width() <= 0 || region.height() <= 0)
        throw Error(ErrorKind::scene, scene.description.film.where,
                    "the film's crop window holds no pixel");
    if (options.error && options.method == Method::covariance)
        throw Error(ErrorKind::usage,
                    "--error: covariance tracing does not measure its error; expected --method "
                    "hybrid or uniform");
    if (options.density_factor && !(options.method == Method::covariance &&
                                    options.density == DensityRule::thesis && !options.progressive))
        throw Error(ErrorKind::usage,
                    "--k: only the thesis' density has this factor; expected --method covariance "
                    "--density thesis, without --progressive");
    if (!keeping.shard.is_all() && (options.seconds || options.error))
        throw Error(ErrorKind::usage,
                    "--shard: shards cannot agree on when to stop by time or error; expected --spp "
                    "alone");
    const Error too_large(ErrorKind::limit, "not enough memory for an image of " +
                                                std::to_string(region.width()) + "x" +
                                                std::to_string(region.height()) + " pixels");
    // A system that promises more memory than it has would end the process in the middle of the
    // render.
    double needed = 0;
    for (const auto& [name, bytes] : render_memory(scene.description.film, options))
        needed += double(bytes);
    if (needed > double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGE_SIZE))) throw too_large;
    try {
        RenderJob job(scene, options, monitor, std::move(keeping));
        switch (options.method) {
            case Method::uniform:
                render_uniform(job);
                break;
            case Method::covariance:
                render_covariance(job);
                break;
            case Method::hybrid:
                render_hybrid(job);
                break;
        }
        job.result.complete = job.state.complete;
        return std::move(job.result);
    } catch (const std::bad_alloc&) {
        throw too_large;
    }
}

}  // namespace covtrace
