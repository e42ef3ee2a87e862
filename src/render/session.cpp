#include "render/session.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "reconstruction/gather.h"
#include "render/job.h"
#include "render/layers.h"
#include "render/round.h"

namespace covtrace {

namespace {

/// The sizes of the rounds are fixed: the mean count after each grows by half. A budget in samples
/// or time only says after which of them, and where inside the last one, to stop.
double next_round(double taken) {
    return std::max(taken + 1, std::floor(taken * 1.5));
}

/// Traces counts up to an average of `target`; the new counts per pixel come from `density`.
void trace_round(RenderJob& job, Film& film, std::span<const float> density, double taken,
                 double target) {
    std::vector<uint32_t> have(film.pixels.size());
    for (size_t i = 0; i < have.size(); ++i) have[i] = film.pixels[i].count;
    const double most = job.options.max_spp ? double(*job.options.max_spp) : std::ceil(16 * target);
    const int64_t total = std::llround(target * double(job.pixels()));
    const auto limit = uint32_t(std::clamp(most, 1.0, 4e9));
    std::vector<uint32_t> counts = job.options.progressive
                                       ? allocate_unmet(density, total, have, limit)
                                       : allocate(density, total, have, limit);
    for (size_t i = 0; i < counts.size(); ++i) counts[i] -= std::min(counts[i], have[i]);
    const double start = job.monitor.elapsed();
    {
        const PhaseTimer timer(job.monitor, job.phase("radiance"));
        job.result.statistics.radiance.add(radiance_pass(job.context, film, counts, job.monitor,
                                                         job.reporter("radiance", taken, target)));
    }
    job.traced(target - taken, job.monitor.elapsed() - start);
}

void trace_rounds(RenderJob& job, Film& film, std::span<const float> density, double taken) {
    while (!job.monitor.cancelled()) {
        if (job.options.error && estimated_error(film) < *job.options.error) break;
        const double target = job.plan_round(taken, next_round(taken));
        if (!(target > taken)) break;
        trace_round(job, film, density, taken, target);
        report_round(job.monitor, film, job.display, !job.scene.lights.has_environment());
        if (film.mean_count() <= taken) break;  // every pixel is at its limit
        taken = target;
    }
    job.result.statistics.samples_per_pixel = film.mean_count();
}

FilterField predicted_filters(const RenderOptions& options, const CovarianceBuffer& buffer,
                              const FilterSettings& settings) {
    const Prediction p = preintegrate(smooth(buffer));
    return filter_field(p.spectrum, p.width, p.height, options.filter, settings);
}

/// The sizes of filters where the buffer knows light, at least `smallest`; infinite elsewhere.
std::vector<float> known_sizes(const FilterField& field, const CovarianceBuffer& buffer,
                               float smallest) {
    std::vector<float> sizes(field.covariance.size(), kInfinity);
    for (size_t i = 0; i < sizes.size(); ++i)
        if (buffer.weight[i] > 0)
            sizes[i] = std::max(smallest, covariance::filter_size(field.covariance[i]));
    return sizes;
}

void gather_image(RenderJob& job, const Film& film, const CovarianceBuffers& buffers,
                  const std::vector<float>& density) {
    job.monitor.update("reconstruction", RenderJob::kTracingShare, film.mean_count());
    const PhaseTimer timer(job.monitor, job.phase("reconstruction"));
    const double taken = film.mean_count();
    const FilterSettings settings = filter_settings(taken),
                         settings_in_view = filter_settings_in_view(taken);
    FilterField field = predicted_filters(job.options, buffers.scattered, settings);
    FilterField in_view_field = predicted_filters(job.options, buffers.in_view, settings_in_view);
    if (job.options.filter == FilterRule::verified) {
        // The border between a surface and the sky behind it is known to the light that passes
        // beside it: the surface where the sky has no detail, the sky where the surface has none.
        const auto beside_scattered =
            known_sizes(in_view_field, buffers.in_view, settings.limits.s_min);
        limit_by_neighbours(field, settings, beside_scattered);
        limit_by_neighbours(in_view_field, settings_in_view,
                            known_sizes(field, buffers.scattered, 0));
    }
    const bool emitters_found =
        std::any_of(buffers.in_view.weight.begin(), buffers.in_view.weight.end(),
                    [](float w) { return w > 0; });
    std::vector<Rgb> scattered(film.pixels.size()), in_view(film.pixels.size());
    std::vector<float> variance(film.pixels.size());
    std::vector<uint32_t> count(film.pixels.size());
    for (size_t i = 0; i < scattered.size(); ++i) {
        const FilmPixel& pixel = film.pixels[i];
        scattered[i] = pixel.mean - pixel.in_view;
        in_view[i] = pixel.in_view;
        const Rgb v = pixel.variance_of_mean();
        variance[i] = sqr(luminance({std::sqrt(v.r), std::sqrt(v.g), std::sqrt(v.b)}));
        count[i] = pixel.count;
    }
    GatheredImage gathered = gather(scattered, variance, count, field);
    // Where no covariance path met an emitter nothing is known of them: they stay as they are.
    if (emitters_found) in_view = gather(in_view, variance, count, in_view_field).color;
    for (size_t i = 0; i < scattered.size(); ++i) gathered.color[i] += in_view[i];
    const CovarianceBuffer all = merge(buffers);
    const Prediction raw = preintegrate(all);
    std::vector<float> asked(density.size());
    for (size_t i = 0; i < asked.size(); ++i) asked[i] = density[i] * float(taken);
    job.result.image = make_layers(film, job.display, !job.scene.lights.has_environment(),
                                   CovarianceLayers{all, raw, std::move(asked), field, gathered,
                                                    emitters_found ? &buffers.scattered : nullptr,
                                                    emitters_found ? &in_view_field : nullptr});
}

}  // namespace

void render_uniform(RenderJob& job) {
    Film film(job.region);
    const std::vector<float> even(film.pixels.size(), 1.0f);
    trace_rounds(job, film, even, 0);
    job.result.statistics.memory["film"] = film.memory();
    job.result.image =
        make_layers(film, job.display, !job.scene.lights.has_environment(), std::nullopt);
}

void render_covariance(RenderJob& job) {
    {
        const PhaseTimer timer(job.monitor, job.phase("spectra"));
        job.scene.prepare_spectra(job.options.texture_bandwidth);
    }
    Film film(job.region);
    const double spp = job.target_spp.value_or(16);
    const double wanted =
        job.options.cov_spp ? *job.options.cov_spp : std::clamp(std::floor(spp / 4), 2.0, 4.0);
    const double cov_spp = job.target_spp ? std::min(wanted, spp) : wanted;
    CovarianceBuffers buffers(film.bounds.width(), film.bounds.height());
    job.result.statistics.memory["prediction"] = buffers.memory();
    const SceneOccluders occluders(job);
    {
        const PhaseTimer timer(job.monitor, job.phase("covariance"));
        const std::vector<float> even(film.pixels.size(), 1.0f);
        const std::vector<uint32_t> none(film.pixels.size(), 0);
        const auto counts =
            allocate(even, std::llround(cov_spp * double(job.pixels())), none, 1u << 30);
        job.result.statistics.covariance =
            covariance_pass(job.context, occluders.view(), job.options.brdf_covariance, film,
                            counts, buffers, job.monitor, job.reporter("covariance", 0, cov_spp));
    }
    Prediction planned_for;
    {
        const PhaseTimer timer(job.monitor, job.phase("plan"));
        planned_for = preintegrate(smooth(merge(buffers)));
    }
    // A covariance path costs a little more than a radiance path: good enough to plan the first
    // round.
    job.traced(cov_spp, job.phase("covariance"));
    job.reserve(6 * job.phase("plan"));
    const FilterSettings planned = filter_settings(spp);
    const std::vector<float> density =
        relative_density(planned_for, job.options.density, planned.c, planned.limits);
    trace_rounds(job, film, density, cov_spp);
    job.result.statistics.memory["film"] = film.memory();
    gather_image(job, film, buffers, density);
}

RenderResult render(RenderScene& scene, const RenderOptions& options, Monitor& monitor) {
    const PixelBounds region = render_region(scene.description.film);
    if (region.width() <= 0 || region.height() <= 0)
        throw Error(ErrorKind::scene, scene.description.film.where,
                    "the film's crop window holds no pixel");
    if (options.error && options.method == Method::covariance)
        throw Error(ErrorKind::usage,
                    "--error: covariance tracing does not measure its error; expected --method "
                    "hybrid or uniform");
    const Error too_large(ErrorKind::limit, "not enough memory for an image of " +
                                                std::to_string(region.width()) + "x" +
                                                std::to_string(region.height()) + " pixels");
    // Film, layers and the buffers of the method, as measured. A system that promises more memory
    // than it has would end the process in the middle of the render.
    const double bytes_per_pixel = options.method == Method::uniform      ? 130
                                   : options.method == Method::covariance ? 350
                                                                          : 1000;
    const double memory = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGE_SIZE));
    if (bytes_per_pixel * double(region.width()) * double(region.height()) > memory)
        throw too_large;
    try {
        RenderJob job(scene, options, monitor);
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
        job.result.complete = !monitor.cancelled();
        return std::move(job.result);
    } catch (const std::bad_alloc&) {
        throw too_large;
    }
}

}  // namespace covtrace
