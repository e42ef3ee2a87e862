#include "render/session.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "reconstruction/gather.h"
#include "render/layers.h"
#include "render/round.h"

namespace covtrace {

namespace {

/// Adds the seconds that a scope took to a phase.
class PhaseTimer {
  public:
    PhaseTimer(const Monitor& monitor, double& total)
        : monitor_(monitor), total_(total), start_(monitor.elapsed()) {}
    ~PhaseTimer() { total_ += monitor_.elapsed() - start_; }

  private:
    const Monitor& monitor_;
    double& total_;
    const double start_;
};

/// The sizes of the rounds are fixed: the mean count after each grows by half. A budget in samples
/// or time only says after which of them, and where inside the last one, to stop.
double next_round(double taken) {
    return std::max(taken + 1, std::floor(taken * 1.5));
}

class Session {
  public:
    Session(RenderScene& scene, const RenderOptions& options, Monitor& monitor)
        : scene_(scene),
          options_(options),
          monitor_(monitor),
          film_(render_region(scene.description.film)),
          context_{
              scene,
              options.seed,
              options.max_depth.value_or(scene.description.max_depth),
              (scene.description.camera.shutter_close - scene.description.camera.shutter_open) *
                  scene.description.film.iso / 100 * scene.description.camera.film_irradiance,
              scene.description.film.max_component_value,
              scene.description.film.white_balance} {
        if (options.spp || !options.seconds)
            target_spp_ = options.spp.value_or(scene.description.samples_per_pixel);
    }

    RenderResult run() {
        if (options_.method == Method::uniform)
            trace_uniform();
        else
            trace_covariance();
        result_.statistics.memory["film"] = film_.pixels.size() * sizeof(FilmPixel);
        result_.statistics.samples_per_pixel = film_.mean_count();
        result_.complete = !monitor_.cancelled();
        return std::move(result_);
    }

  private:
    double& phase(const char* name) { return result_.statistics.seconds[name]; }
    int64_t pixels() const { return int64_t(film_.pixels.size()); }

    PassProgress reporter(const char* name, double from, double to, double spp_from,
                          double spp_to) {
        return [this, name, from, to, spp_from, spp_to](double f) {
            monitor_.update(name, from + f * (to - from), spp_from + f * (spp_to - spp_from));
        };
    }

    /// The mean count to trace up to next, given what is taken; equal to `taken` when it is enough.
    double plan_round(double taken) {
        double target = next_round(taken);
        if (target_spp_) target = std::min(target, *target_spp_);
        if (options_.seconds && radiance_spp_ > 0) {
            const double left = *options_.seconds - reserve_ - monitor_.elapsed();
            const double affordable =
                taken + std::floor(left / (radiance_seconds_ / radiance_spp_) * 16) / 16;
            target = std::min(target, affordable);
        }
        return std::max(target, taken);
    }

    double fraction(double spp) const {
        double f = 0;
        if (target_spp_) f = spp / *target_spp_;
        if (options_.seconds) f = std::max(f, monitor_.elapsed() / *options_.seconds);
        return std::clamp(f, 0.0, 1.0) * kTracingShare;
    }

    /// Traces counts up to an average of `target`; the new counts per pixel come from `density`.
    void trace_round(std::span<const float> density, double taken, double target) {
        std::vector<uint32_t> have(film_.pixels.size());
        for (size_t i = 0; i < have.size(); ++i) have[i] = film_.pixels[i].count;
        const double most = options_.max_spp ? double(*options_.max_spp) : std::ceil(16 * target);
        std::vector<uint32_t> counts = allocate(density, std::llround(target * double(pixels())),
                                                have, uint32_t(std::clamp(most, 1.0, 4e9)));
        for (size_t i = 0; i < counts.size(); ++i) counts[i] -= std::min(counts[i], have[i]);
        const double start = monitor_.elapsed();
        {
            const PhaseTimer timer(monitor_, phase("radiance"));
            result_.statistics.radiance.add(radiance_pass(
                context_, film_, counts, monitor_,
                reporter("radiance", fraction(taken), fraction(target), taken, target)));
        }
        radiance_seconds_ += monitor_.elapsed() - start;
        radiance_spp_ += target - taken;
    }

    void trace_rounds(std::span<const float> density, double taken) {
        while (!monitor_.cancelled()) {
            const double target = plan_round(taken);
            if (!(target > taken)) break;
            trace_round(density, taken, target);
            report_round(monitor_, film_, display(), !scene_.lights.has_environment());
            if (film_.mean_count() <= taken) break;  // every pixel is at its limit
            taken = target;
        }
    }

    void trace_uniform() {
        const std::vector<float> even(film_.pixels.size(), 1.0f);
        reserve_ = kWriteSeconds;
        trace_rounds(even, 0);
        result_.image =
            make_layers(film_, display(), !scene_.lights.has_environment(), std::nullopt);
    }

    void trace_covariance() {
        {
            const PhaseTimer timer(monitor_, phase("spectra"));
            scene_.prepare_spectra();
        }
        const double spp = target_spp_.value_or(16);
        const double wanted =
            options_.cov_spp ? *options_.cov_spp : std::clamp(std::floor(spp / 4), 2.0, 4.0);
        const double cov_spp = target_spp_ ? std::min(wanted, spp) : wanted;
        CovarianceBuffers buffers(film_.bounds.width(), film_.bounds.height());
        result_.statistics.memory["prediction"] = buffers.memory();
        std::optional<VoxelGrid> grid;
        std::optional<OccluderQuery> query;
        if (options_.occlusion == Occlusion::grid) {
            const PhaseTimer timer(monitor_, phase("grid"));
            grid.emplace(scene_.geometry,
                         VoxelGridOptions{.width = options_.voxels,
                                          .cancelled = [this] { return monitor_.cancelled(); }});
        } else if (options_.occlusion == Occlusion::query) {
            const PhaseTimer timer(monitor_, phase("outlines"));
            query.emplace(scene_.geometry, [this] { return monitor_.cancelled(); });
        }
        if (grid) result_.statistics.memory["occluders"] = grid->memory();
        if (query) result_.statistics.memory["occluders"] = query->memory();
        const Occluders occluders{grid ? &*grid : nullptr, query ? &*query : nullptr};
        {
            const PhaseTimer timer(monitor_, phase("covariance"));
            const std::vector<float> even(film_.pixels.size(), 1.0f);
            const std::vector<uint32_t> none(film_.pixels.size(), 0);
            const auto counts =
                allocate(even, std::llround(cov_spp * double(pixels())), none, 1u << 30);
            result_.statistics.covariance = covariance_pass(
                context_, occluders, options_.brdf_covariance, film_, counts, buffers, monitor_,
                reporter("covariance", 0, fraction(cov_spp), 0, cov_spp));
        }
        Prediction planned_for;
        {
            const PhaseTimer timer(monitor_, phase("plan"));
            planned_for = preintegrate(smooth(merge(buffers)));
        }
        // A covariance path costs a little more than a radiance path: good enough to plan the first
        // round.
        radiance_seconds_ = phase("covariance");
        radiance_spp_ = cov_spp;
        reserve_ = kWriteSeconds + 6 * phase("plan");
        const FilterSettings planned = filter_settings(spp);
        const std::vector<float> density =
            relative_density(planned_for, options_.density, planned.c, planned.limits);
        trace_rounds(density, cov_spp);
        reconstruct(buffers, density);
    }

    FilterField predicted_filters(const CovarianceBuffer& buffer, const FilterSettings& settings,
                                  std::span<const float> others = {}) {
        const Prediction p = preintegrate(smooth(buffer));
        FilterField field = filter_field(p.spectrum, p.width, p.height, options_.filter, settings);
        if (options_.filter == FilterRule::verified) limit_by_neighbours(field, settings, others);
        return field;
    }

    void reconstruct(const CovarianceBuffers& buffers, const std::vector<float>& density) {
        monitor_.update("reconstruction", kTracingShare, film_.mean_count());
        const PhaseTimer timer(monitor_, phase("reconstruction"));
        const double taken = film_.mean_count();
        const FilterField field = predicted_filters(buffers.scattered, filter_settings(taken));
        const bool emitters_found =
            std::any_of(buffers.in_view.weight.begin(), buffers.in_view.weight.end(),
                        [](float w) { return w > 0; });
        // The edge of a surface before the sky is known from the surface: the sky has no detail.
        std::vector<float> beside(field.covariance.size(), kInfinity);
        for (size_t i = 0; i < beside.size(); ++i)
            if (buffers.scattered.weight[i] > 0)
                beside[i] = covariance::filter_size(field.covariance[i]);
        const FilterField in_view_field =
            predicted_filters(buffers.in_view, filter_settings_in_view(taken), beside);
        std::vector<Rgb> scattered(film_.pixels.size()), in_view(film_.pixels.size());
        std::vector<float> variance(film_.pixels.size());
        std::vector<uint32_t> count(film_.pixels.size());
        for (size_t i = 0; i < scattered.size(); ++i) {
            const FilmPixel& pixel = film_.pixels[i];
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
        result_.image = make_layers(film_, display(), !scene_.lights.has_environment(),
                                    CovarianceLayers{all, raw, std::move(asked), field, gathered,
                                                     emitters_found ? &buffers.scattered : nullptr,
                                                     emitters_found ? &in_view_field : nullptr});
    }

    PixelBounds display() const {
        return {0, 0, scene_.description.film.width, scene_.description.film.height};
    }

    static constexpr double kTracingShare =
        0.97;  // of the progress bar; the rest is reconstruction and output
    static constexpr double kWriteSeconds = 0.1;

    RenderScene& scene_;
    const RenderOptions& options_;
    Monitor& monitor_;
    Film film_;
    PassContext context_;
    RenderResult result_;
    std::optional<double> target_spp_;
    double radiance_seconds_ = 0,
           radiance_spp_ = 0;  // measured so far: what a sample per pixel costs
    double reserve_ = 0;       // seconds kept for what follows the samples
};

}  // namespace

void apply(const SceneOverrides& overrides, SceneDescription& scene) {
    if (overrides.resolution) {
        // The same picture with other pixels: a crop given in pixels keeps its place in the frame.
        FilmDescription& film = scene.film;
        if (film.pixel_bounds) {
            const auto& b = *film.pixel_bounds;
            film.crop_window = {float(b[0]) / float(film.width), float(b[1]) / float(film.width),
                                float(b[2]) / float(film.height), float(b[3]) / float(film.height)};
            film.pixel_bounds.reset();
        }
        film.width = (*overrides.resolution)[0];
        film.height = (*overrides.resolution)[1];
    }
    if (overrides.crop) {
        const PixelBounds& c = *overrides.crop;
        if (c.x0 < 0 || c.y0 < 0 || c.x1 > scene.film.width || c.y1 > scene.film.height ||
            c.x0 >= c.x1 || c.y0 >= c.y1)
            throw Error(ErrorKind::usage, "--crop must lie inside the frame of " +
                                              std::to_string(scene.film.width) + "x" +
                                              std::to_string(scene.film.height) +
                                              " pixels and hold at least one");
        scene.film.pixel_bounds = {c.x0, c.x1, c.y0, c.y1};
    }
    if (overrides.shutter) {
        scene.camera.shutter_open = (*overrides.shutter)[0];
        scene.camera.shutter_close = (*overrides.shutter)[1];
    }
    if (overrides.focal_distance) scene.camera.focal_distance = *overrides.focal_distance;
    if (overrides.f_number) {
        // A full-frame sensor, 24 mm high: focal length from the field of view, in metres.
        const float focal_length = 0.012f / std::tan(scene.camera.fov * kPi / 360);
        scene.camera.lens_radius = focal_length / (2 * *overrides.f_number);
    }
}

PixelBounds render_region(const FilmDescription& film) {
    if (film.pixel_bounds) {
        const auto& b = *film.pixel_bounds;
        return {std::max(0, b[0]), std::max(0, b[2]), std::min(film.width, b[1]),
                std::min(film.height, b[3])};
    }
    const auto pixel = [](float fraction, int size) {
        return int(std::ceil(fraction * float(size)));
    };
    const auto& c = film.crop_window;
    return {std::clamp(pixel(c[0], film.width), 0, film.width),
            std::clamp(pixel(c[2], film.height), 0, film.height),
            std::clamp(pixel(c[1], film.width), 0, film.width),
            std::clamp(pixel(c[3], film.height), 0, film.height)};
}

RenderResult render(RenderScene& scene, const RenderOptions& options, Monitor& monitor) {
    const PixelBounds region = render_region(scene.description.film);
    if (region.width() <= 0 || region.height() <= 0)
        throw Error(ErrorKind::scene, scene.description.film.where,
                    "the film's crop window holds no pixel");
    const Error too_large(ErrorKind::limit, "not enough memory for an image of " +
                                                std::to_string(region.width()) + "x" +
                                                std::to_string(region.height()) + " pixels");
    // Film, layers and the buffers of the method, as measured. A system that promises more memory
    // than it has would end the process in the middle of the render.
    const double bytes_per_pixel = options.method == Method::uniform ? 130 : 350;
    const double memory = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGE_SIZE));
    if (bytes_per_pixel * double(region.width()) * double(region.height()) > memory)
        throw too_large;
    try {
        return Session(scene, options, monitor).run();
    } catch (const std::bad_alloc&) {
        throw too_large;
    }
}

}  // namespace covtrace
