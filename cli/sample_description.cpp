#include "cli/sample_description.h"

#include <fmt/format.h>

#include <limits>
#include <memory>

#include "render/job.h"
#include "render/overrides.h"

namespace covtrace::cli {

namespace {

std::string text(Vec3 v) {
    return fmt::format("{:.9g},{:.9g},{:.9g}", v.x, v.y, v.z);
}
std::string text(Rgb c) {
    return fmt::format("{:.9g},{:.9g},{:.9g}", c.r, c.g, c.b);
}

/// One line on a vertex: place, material or medium, and the luminances that reach the sensor from
/// it.
std::string describe(const PathVertex& v, int index) {
    std::string line =
        fmt::format("vertex {}: at {} time {:.9g}", index, text(v.hit.position), v.hit.time);
    line += v.medium >= 0 ? fmt::format(", in medium {}", v.medium)
                          : fmt::format(", material {}, normal {}", v.material, text(v.shading.z));
    line += fmt::format("; to the sensor: emitted {:.9g}, lights {:.9g}, medium before it {:.9g}",
                        v.emitted, v.direct, v.glow);
    if (v.scatters) line += "; goes on to " + text(v.next_event.wi);
    return line + "\n";
}

}  // namespace

std::string describe_sample(const RenderScene& scene, const RenderOptions& options,
                            const DebugPixel& p) {
    const PixelBounds region = render_region(scene.description.film);
    if (!region.contains({p.x, p.y, p.x + 1, p.y + 1}))
        throw Error(ErrorKind::usage,
                    fmt::format("--debug-pixel: {},{} is not one of the pixels "
                                "{},{} to {},{}",
                                p.x, p.y, region.x0, region.y0, region.x1 - 1, region.y1 - 1));
    // The two halves of `hybrid` take turns in the numbers of samples (PassContext::sample_name).
    const PassContext whole = pass_context(scene, options);
    const PassContext context =
        options.method == Method::hybrid ? half_context(whole, uint32_t(p.sample % 2)) : whole;
    const uint64_t index = p.sample / context.halves;
    if (index > std::numeric_limits<uint32_t>::max())
        throw Error(ErrorKind::usage,
                    fmt::format("--debug-pixel: sample {} is more than a pixel has", p.sample));
    const auto record = std::make_unique<PathRecord>();
    PathResult path;
    const FilmSample s = take_sample(context, p.x, p.y, uint32_t(index), record.get(), path);
    std::string out = fmt::format("pixel {},{} sample {} (seed {}, index {})\nradiance {}{}\n", p.x,
                                  p.y, p.sample, context.seed, index, text(s.radiance),
                                  is_finite(s.radiance) ? "" : ": not finite, counts as black");
    out += fmt::format("albedo {}\nnormal {}\ndepth {:.9g}\nrays {}\n", text(s.albedo),
                       text(s.normal), s.depth, s.rays);
    out += fmt::format("camera ray from {} to {} time {:.9g}\n", text(record->camera_ray.origin),
                       text(record->camera_ray.direction), record->camera_ray.time);
    for (int i = 0; i < record->count; ++i) out += describe(record->vertices[size_t(i)], i);
    if (record->escaped != 0 || record->escape_glow != 0)
        out += fmt::format("leaves the scene towards {}; to the sensor: {:.9g}, medium {:.9g}\n",
                           text(record->escape_direction), record->escaped, record->escape_glow);
    return out;
}

}  // namespace covtrace::cli
