#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "planner/adaptive.h"
#include "planner/error_goal.h"
#include "reconstruction/hybrid.h"
#include "render/hybrid.h"
#include "render/layers.h"
#include "render/round.h"

namespace covtrace {

namespace {

/// Samples per pixel of the pilot, both halves together.
constexpr double kPilot = 4;

/// Of its samples, those that leave a covariance. More cost as much as ten samples each and change
/// nothing (docs/decisions/0040).
constexpr double kPaths = 1;

/// Where the round after an average of `taken` ends: the rounds double the total, whatever the
/// budget.
double round_end(double taken) {
    double end = kPilot;
    while (end <= taken) end *= 2;
    return end;
}

class HybridRender {
  public:
    explicit HybridRender(RenderJob& job) : job_(job), film_(job.region) {
        for (int k = 0; k < 2; ++k) {
            contexts_.push_back(job.context);
            contexts_.back().seed = half_seed(job.context.seed, k);
        }
    }

    HybridSamples samples() && { return {std::move(film_), std::move(prediction_)}; }

    void trace() {
        {
            const PhaseTimer timer(job_.monitor, job_.phase("spectra"));
            job_.scene.prepare_spectra();
        }
        double taken = trace_pilot();
        if (job_.options.seconds) job_.reserve(reconstruction_time());
        while (!job_.monitor.cancelled()) {
            const double enough = enough_samples(taken);
            const double target = job_.plan_round(taken, std::min(round_end(taken), enough));
            if (!(target > taken)) break;
            image_.reset();  // of fewer samples
            trace_round(taken, target);
            if (job_.monitor.watched()) report();
            if (film_.mean_count() <= taken) break;  // every pixel is at its limit
            taken = target;
        }
        job_.result.statistics.samples_per_pixel = film_.mean_count();
        auto& memory = job_.result.statistics.memory;
        memory["film"] = film_.half[0].memory() + film_.half[1].memory();
        memory["prediction"] = film_.covariance.memory();
    }

    /// The image, made from the samples.
    void deliver() {
        if (!image_) reconstruct_image();
        const PhaseTimer timer(job_.monitor, job_.phase("reconstruction"));
        GatheredImage delivered{std::vector<Rgb>(size()), image_->variance.values};
        for (size_t i = 0; i < size(); ++i)
            delivered.color[i] = {image_->color[0][i], image_->color[1][i], image_->color[2][i]};
        if (density_.empty()) density_.assign(size(), float(film_.mean_count()));
        const FilterField field =
            filter_field(prediction_.spectrum, job_.region.width(), job_.region.height(),
                         FilterRule::verified, filter_settings(film_.mean_count()));
        job_.result.image = make_layers(
            film_.merged(), job_.display, !job_.scene.lights.has_environment(),
            CovarianceLayers{film_.covariance, raw_prediction_, density_, field, delivered});
    }

  private:
    size_t size() const { return film_.half[0].pixels.size(); }

    /// Counts of the next samples for a half, given how many each pixel should have in the end.
    std::vector<uint32_t> missing(int k, std::vector<uint32_t> wanted) const {
        for (size_t i = 0; i < wanted.size(); ++i)
            wanted[i] -= std::min(wanted[i], film_.half[size_t(k)].pixels[i].count);
        return wanted;
    }

    /// The first samples: every pixel alike, and the first of them leave their covariances.
    double trace_pilot() {
        const double pilot = job_.target_spp ? std::min(kPilot, *job_.target_spp) : kPilot;
        const double covariance =
            std::min(pilot, job_.options.cov_spp ? double(*job_.options.cov_spp) : kPaths);
        const SceneOccluders occluders(job_);
        const std::vector<float> even(size(), 1.0f);
        const std::vector<uint32_t> none(size(), 0);
        const double start = job_.monitor.elapsed();
        {
            const PhaseTimer timer(job_.monitor, job_.phase("covariance"));
            std::array<CovarianceBuffers, 2> buffers{
                CovarianceBuffers(job_.region.width(), job_.region.height()),
                CovarianceBuffers(job_.region.width(), job_.region.height())};
            for (int k = 0; k < 2; ++k) {
                const auto counts = share_between_halves(k, covariance);
                job_.result.statistics.covariance.add(covariance_pass(
                    contexts_[size_t(k)], occluders.view(), job_.options.brdf_covariance,
                    film_.half[size_t(k)], counts, buffers[size_t(k)], job_.monitor,
                    job_.reporter("covariance", 0.5 * k * covariance, 0.5 * (k + 1) * covariance)));
            }
            film_.covariance = mean(merge(buffers[0]), merge(buffers[1]));
        }
        {
            const PhaseTimer timer(job_.monitor, job_.phase("plan"));
            raw_prediction_ = preintegrate(film_.covariance);
            prediction_ = preintegrate(smooth(film_.covariance));
        }
        for (int k = 0; k < 2; ++k)
            trace(k, missing(k, share_between_halves(k, pilot)), covariance, pilot);
        job_.traced(pilot, job_.monitor.elapsed() - start);
        return pilot;
    }

    /// The counts of one half when both together take `spp` per pixel evenly. Where that is not
    /// even, a checkerboard decides which half gets the odd sample.
    std::vector<uint32_t> share_between_halves(int k, double spp) const {
        const std::vector<float> even(size(), 1.0f);
        const std::vector<uint32_t> none(size(), 0);
        const auto both = allocate(even, std::llround(spp * double(size())), none, 1u << 30);
        std::vector<uint32_t> counts(size());
        const int w = job_.region.width();
        for (size_t i = 0; i < counts.size(); ++i) {
            const bool odd = ((i % size_t(w)) + i / size_t(w)) % 2 == size_t(k);
            counts[i] = both[i] / 2 + (both[i] % 2 && odd ? 1 : 0);
        }
        return counts;
    }

    /// Of the two halves, by weight.
    static CovarianceBuffer mean(const CovarianceBuffer& a, const CovarianceBuffer& b) {
        CovarianceBuffer sum = a;
        for (size_t i = 0; i < sum.weight.size(); ++i) {
            const float total = a.weight[i] + b.weight[i];
            if (!(total > 0)) continue;
            sum.covariance[i] =
                (a.weight[i] / total) * a.covariance[i] + (b.weight[i] / total) * b.covariance[i];
            sum.weight[i] = 0.5f * total;
        }
        return sum;
    }

    void trace(int k, const std::vector<uint32_t>& counts, double from, double to) {
        const PhaseTimer timer(job_.monitor, job_.phase("radiance"));
        const double middle = 0.5 * (from + to);
        job_.result.statistics.radiance.add(
            radiance_pass(contexts_[size_t(k)], film_.half[size_t(k)], counts, job_.monitor,
                          job_.reporter("radiance", k == 0 ? from : middle, k == 0 ? middle : to)));
    }

    /// What the planner may know for one half: the samples of the other one.
    std::vector<float> density_from(const Film& film) const {
        const int w = film.bounds.width(), h = film.bounds.height();
        SampleKnowledge known{Plane(w, h), Plane(w, h), Plane(w, h), prediction_.spectrum};
        for (size_t i = 0; i < film.pixels.size(); ++i) {
            const FilmPixel& p = film.pixels[i];
            known.brightness[i] = luminance(p.mean);
            if (p.count > 1) {
                const Rgb v = p.squares / float(p.count - 1);
                known.variance[i] =
                    sqr(luminance({std::sqrt(v.r), std::sqrt(v.g), std::sqrt(v.b)}));
            }
            known.cost[i] = p.count > 0 ? float(p.rays) / float(p.count) : 1.0f;
        }
        return adaptive_density(known);
    }

    void trace_round(double taken, double target) {
        const double most =
            0.5 * (job_.options.max_spp ? double(*job_.options.max_spp) : std::ceil(16 * target));
        std::array<std::vector<uint32_t>, 2> counts;
        {
            const PhaseTimer timer(job_.monitor, job_.phase("plan"));
            const std::array<std::vector<float>, 2> density{density_from(film_.half[1]),
                                                            density_from(film_.half[0])};
            const std::vector<float> even(size(), 1.0f);
            for (int k = 0; k < 2; ++k) {
                std::vector<uint32_t> have(size());
                for (size_t i = 0; i < have.size(); ++i)
                    have[i] = film_.half[size_t(k)].pixels[i].count;
                counts[size_t(k)] =
                    missing(k, allocate(job_.options.even_counts ? even : density[size_t(k)],
                                        std::llround(target / 2 * double(size())), have,
                                        uint32_t(std::clamp(most, 1.0, 4e9))));
            }
            density_.resize(size());
            for (size_t i = 0; i < size(); ++i)
                density_[i] = 0.5f * (density[0][i] + density[1][i]) * float(target);
        }
        const double start = job_.monitor.elapsed();
        for (int k = 0; k < 2; ++k) trace(k, counts[size_t(k)], taken, target);
        job_.traced(target - taken, job_.monitor.elapsed() - start);
    }

    void reconstruct_image() {
        job_.monitor.update("reconstruction", job_.fraction(film_.mean_count()),
                            film_.mean_count());
        const PhaseTimer timer(job_.monitor, job_.phase("reconstruction"));
        image_ = reconstruct(halves_of(film_), prediction_.spectrum);
    }

    /// Shows the samples so far to who watches.
    void report() const {
        report_round(job_.monitor, film_.merged(), job_.display,
                     !job_.scene.lights.has_environment());
    }

    /// The average count at which the image will be as good as was asked for; `taken` where it is,
    /// by its own estimate.
    double enough_samples(double taken) {
        if (!job_.options.error) return std::numeric_limits<double>::infinity();
        reconstruct_image();
        double sum = 0;
        for (float e : image_->relative_error.values) sum += double(e);
        return goal_.samples(taken, std::sqrt(sum / double(size())), *job_.options.error);
    }

    /// Seconds that the reconstruction of this image will take, by that of a part of it. It decides
    /// when to stop and nothing else.
    double reconstruction_time() {
        constexpr int kSide = 96;
        const PixelBounds all = job_.region;
        const PixelBounds part{all.x0, all.y0, std::min(all.x1, all.x0 + kSide),
                               std::min(all.y1, all.y0 + kSide)};
        const PhaseTimer timer(job_.monitor, job_.phase("reconstruction"));
        const double start = job_.monitor.elapsed();
        HybridFilm film(part);
        std::vector<Covariance2> spectrum;
        for (int y = part.y0; y < part.y1; ++y)
            for (int x = part.x0; x < part.x1; ++x) {
                const size_t to = size_t(y - part.y0) * size_t(part.width()) + size_t(x - part.x0);
                const size_t from = size_t(y - all.y0) * size_t(all.width()) + size_t(x - all.x0);
                for (size_t k = 0; k < 2; ++k) {
                    film.half[k].pixels[to] = film_.half[k].pixels[from];
                    film.half[k].feature_squares[to] = film_.half[k].feature_squares[from];
                }
                spectrum.push_back(prediction_.spectrum[from]);
            }
        reconstruct(halves_of(film), spectrum);
        return (job_.monitor.elapsed() - start) * double(size()) / double(spectrum.size());
    }

    RenderJob& job_;
    HybridFilm film_;
    std::vector<PassContext> contexts_;
    Prediction raw_prediction_, prediction_;
    std::optional<HybridImage> image_;  // of the film as it is
    std::vector<float> density_;        // what the last plan asked for, samples per pixel
    ErrorGoal goal_;
};

}  // namespace

void render_hybrid(RenderJob& job) {
    HybridRender render(job);
    render.trace();
    render.deliver();
}

HybridSamples trace_hybrid(RenderJob& job) {
    HybridRender render(job);
    render.trace();
    return std::move(render).samples();
}

}  // namespace covtrace
