#include "render/session.h"

#include <unistd.h>

#include <algorithm>
#include <new>
#include <utility>

#include "render/job.h"
#include "render/methods/covariance.h"
#include "render/methods/hybrid.h"
#include "render/methods/uniform.h"
#include "render/overrides.h"
#include "render/render_memory.h"

namespace covtrace {

RenderResult render(const RenderScene& scene, const RenderOptions& options, Monitor& monitor,
                    FilmKeeping keeping) {
    const PixelBounds region = render_region(scene.description.film);
    if (region.width() <= 0 || region.height() <= 0)
        throw Error(ErrorKind::scene, scene.description.film.where,
                    "the film's crop window holds no pixel");
    if (options.error && options.method == Method::covariance)
        throw Error(
            ErrorKind::usage, OptionName{"error"},
            "covariance tracing does not measure its error; expected the method hybrid or uniform");
    if (options.density_factor && !(options.method == Method::covariance &&
                                    options.density == DensityRule::thesis && !options.progressive))
        throw Error(ErrorKind::usage, OptionName{"k"},
                    "only the density thesis of the method covariance has this factor, where it is "
                    "not progressive");
    if (!keeping.shard.is_all() && (options.seconds || options.error))
        throw Error(ErrorKind::usage, OptionName{"shard"},
                    "shards cannot agree on when to stop by time or error; expected samples per "
                    "pixel alone");
    const Error too_large(ErrorKind::limit, "not enough memory for an image of " +
                                                std::to_string(region.width()) + "x" +
                                                std::to_string(region.height()) + " pixels");
    // Images that need more memory than there is are refused: a system that promises more than it
    // has would end the process in the middle of the render.
    double needed = 0;
    for (const auto& [name, bytes] :
         render_memory(scene.description.film, options, scene.tells_opacity))
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
