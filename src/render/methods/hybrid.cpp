#include "render/methods/hybrid.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "planner/agreement.h"
#include "planner/error_goal.h"
#include "planner/even_share.h"
#include "reconstruction/hybrid.h"
#include "reconstruction/luminance.h"
#include "render/develop.h"
#include "render/methods/reconstruction_times.h"
#include "render/round.h"
#include "render/rounds.h"
#include "render/sample_knowledge.h"
#include "render/scene_analysis.h"
#include "render/timed_denoiser.h"
#include "render/unmet_emitters.h"

namespace covtrace {

namespace {

/// Samples per pixel of the pilot, both halves together.
constexpr double kPilot = 4;

class HybridRender {
  public:
    explicit HybridRender(RenderJob& job)
        : job_(job),
          s_(job.state),
          quality_(job.options.denoiser_quality.value_or(DenoiserQuality::high)) {
        for (uint32_t k = 0; k < 2; ++k) contexts_.push_back(half_context(job.context, k));
        if (job.options.denoiser)
            denoiser_.emplace(*job.options.denoiser, job.monitor, job.seconds(Phase::denoise),
                              job.seconds(Phase::reconstruction));
        if (job.options.error) unmet_ = UnmetEmitters(job.context, job.region);
        if (s_.stage != Stage::rounds) analysis_.emplace(job_);
    }

    void trace() {
        trace_rounds(job_, {[this] { return plan(); }, [this] { trace_round(); }});
    }

    /// Reconstructs the image from the samples and makes its layers.
    void deliver() {
        if (!job_.delivers()) return;
        // Time may have ended before a round was planned, and with it the quality
        if (denoiser_ && job_.options.seconds && !times_) {
            predict();
            reserve_time();
        }
        reconstruct_image(true);
        if (is_denoiser_too_slow_)
            image_->denoiser_failure = "it takes longer than the time that was left";
        const PhaseTimer timer(job_.monitor, job_.seconds(Phase::reconstruction));
        const Reconstructed known{*image_, *prediction_};
        job_.result.image = develop(s_, denoiser(), quality_, known);
    }

    HybridSamples samples() && {
        predict();
        return {std::move(s_.films), std::move(*prediction_)};
    }

  private:
    size_t size() const { return s_.pixels(); }
    /// The denoiser that is used.
    const Denoiser* denoiser() const {
        return denoiser_ && !is_denoiser_too_slow_ ? &*denoiser_ : nullptr;
    }
    HybridSettings settings() const {
        HybridSettings settings;
        settings.denoiser = denoiser();
        settings.quality = quality_;
        return settings;
    }
    double pilot() const {
        const double most = job_.options.max_spp ? double(*job_.options.max_spp) : kPilot;
        return std::min({kPilot, most, job_.target_spp.value_or(kPilot)});
    }

    /// Counts of half k that give every pixel `spp` samples of both halves together. The first
    /// kFirstBlock samples of a pixel are the first half's, as they are in the sequence: at one
    /// sample and at two all pixels together have its most even points then. Beyond both halves'
    /// first blocks odd samples go to the halves in turn, along rows and from row to row: like a
    /// checkerboard where all pixels have one.
    std::vector<uint32_t> share_between_halves(size_t k, double spp) const {
        std::vector<uint32_t> counts = job_.even_counts(spp);
        const size_t w = size_t(job_.region.width());
        size_t rows = 0;  // rows with odd samples so far
        for (size_t begin = 0; begin < counts.size(); begin += w) {
            size_t turn = rows;
            for (size_t i = begin; i < begin + w; ++i) {
                if (counts[i] <= 2 * kFirstBlock) {
                    const uint32_t first = std::min(counts[i], kFirstBlock);
                    counts[i] = k == 0 ? first : counts[i] - first;
                    continue;
                }
                const bool odd = counts[i] % 2 == 1;
                counts[i] = counts[i] / 2 + (odd && turn % 2 == k ? 1 : 0);
                turn += odd ? 1 : 0;
            }
            rows += turn > rows ? 1 : 0;
        }
        return counts;
    }

    std::vector<std::vector<uint32_t>> pilot_counts(double spp) const {
        return {share_between_halves(0, spp), share_between_halves(1, spp)};
    }

    /// Samples per pixel that a budget of time allows in the first round of the pilot; it goes on
    /// with the rest where that was less than time allows. Shards have their clocks apart, and the
    /// whole pilot each.
    double first_of_pilot() {
        const bool is_predictable = s_.covariance_spp <= 1;  // all covariances are there
        if (!job_.options.seconds || !job_.keeping.shard.is_all() || !is_predictable)
            return pilot();
        predict();
        reserve_time();
        return std::max(std::min(1.0, pilot()), job_.plan_round(pilot()));
    }

    /// Covariance paths of half k. They are samples, too.
    std::vector<uint32_t> paths_of(size_t k) const {
        return share_between_halves(k, s_.covariance_spp);
    }

    bool plan() {
        switch (s_.stage) {
            case Stage::first_paths: {
                std::vector<uint32_t> first = paths_of(0);
                for (uint32_t& c : first) c = std::min(c, 1u);
                s_.plan = {std::move(first), std::vector<uint32_t>(size(), 0)};
                s_.target = std::min(1.0, s_.covariance_spp);
                return true;
            }
            case Stage::pilot:
                s_.target = first_of_pilot();
                s_.plan = pilot_counts(s_.target);
                return true;
            case Stage::rounds:
                break;
        }
        predict();
        reserve_time();
        // Go on with the pilot where a budget ended within it
        if (s_.taken < pilot()) {
            const double rest = job_.keeping.shard.is_all() ? job_.plan_round(pilot()) : pilot();
            return rest > s_.taken && job_.begin_round(rest, pilot_counts(rest));
        }
        const double target = job_.plan_round(std::min(round_end(s_.taken), enough_samples()));
        // The pilot may have given every pixel all that it is to have
        const bool is_full = job_.options.max_spp && pilot() >= double(*job_.options.max_spp);
        return target > s_.taken && !is_full && plan_samples(target);
    }

    /// Predicts the image's spectrum from the covariances, once.
    void predict() {
        if (prediction_) return;
        const PhaseTimer timer(job_.monitor, job_.seconds(Phase::plan));
        prediction_ = preintegrated(smoothed(s_.covariance()));
    }

    void trace_round() {
        image_.reset();  // the image was of fewer samples
        if (s_.stage == Stage::first_paths) {
            trace_covariance(0, s_.plan[0], {});
            return;
        }
        if (s_.stage == Stage::pilot) {
            const std::array<std::vector<uint32_t>, 2> paths{paths_of(0), paths_of(1)};
            trace_covariance(0, paths[0], {});
            // Paths of a pixel count in their order: those of the first half come before any of the
            // second.
            if (!s_.has(0, paths[0], job_.tiles())) return;
            trace_covariance(1, paths[1], paths[0]);
            if (!s_.has(1, paths[1], job_.tiles())) return;
        }
        for (size_t k = 0; k < 2; ++k) trace_radiance(k);
    }

    PassProgress reporter(Phase phase, size_t k) {
        const double step = 0.5 * (s_.target - s_.taken);
        return job_.reporter(phase, s_.taken + double(k) * step, s_.taken + double(k + 1) * step);
    }

    void trace_covariance(size_t k, std::span<const uint32_t> counts,
                          std::span<const uint32_t> earlier) {
        const PhaseTimer timer(job_.monitor, job_.seconds(Phase::covariance));
        job_.counted(job_.result.statistics.covariance,
                     covariance_pass(contexts_[k], analysis_->replay(), s_.films[k], counts,
                                     {s_.parts(), earlier, s_.weight_limit.value_or(kInfinity)},
                                     job_.monitor, reporter(Phase::covariance, k)));
        analysis_->note_memory();
    }

    void trace_radiance(size_t k) {
        const PhaseTimer timer(job_.monitor, job_.seconds(Phase::radiance));
        job_.counted(job_.result.statistics.radiance,
                     radiance_pass(contexts_[k], s_.films[k], s_.plan[k], job_.monitor,
                                   reporter(Phase::radiance, k)));
    }

    /// Knowledge from the samples of one half.
    SampleKnowledge knowledge_of(const Film& film) const {
        SampleKnowledge known = knowledge_from(film, prediction_->spectrum);
        for (size_t i = 0; i < size(); ++i)
            known.variance[i] =
                std::max(known.variance[i], unmet_.variance(i, 2.0 * film.pixels[i].count));
        return known;
    }

    /// The density for one half, as the planner makes it of what the other half knows.
    Plane density_from(const SampleKnowledge& known) const {
        Plane density(job_.region.width(), job_.region.height());
        density.values = adaptive_density(known, kHalvesPlan);
        return density;
    }

    bool plan_samples(double target) {
        const PhaseTimer timer(job_.monitor, job_.seconds(Phase::plan));
        const double most = std::clamp(0.5 * job_.most_samples(target), 1.0, 4e9);
        // Each half's density comes from the other half's samples
        const std::array known{knowledge_of(s_.films[1]), knowledge_of(s_.films[0])};
        std::array density{density_from(known[0]), density_from(known[1])};
        keep_what_agrees(density);
        const float share = even_share(known, s_.taken);
        for (Plane& d : density) spread_evenly(d.values, share);
        const std::vector<float> even(size(), 1.0f);
        // Share the samples of both halves among the pixels
        std::vector<std::vector<uint32_t>> counts;
        for (size_t k = 0; k < 2; ++k) {
            std::vector<uint32_t> have(size());
            for (size_t i = 0; i < have.size(); ++i) have[i] = s_.films[k].pixels[i].count;
            counts.push_back(allocate(job_.options.even_counts ? even : density[k].values,
                                      std::llround(target / 2 * double(size())), have,
                                      uint32_t(most)));
        }
        if (!job_.begin_round(target, std::move(counts))) return false;
        // Keep the mean of both densities for the layer
        s_.density.resize(size());
        for (size_t i = 0; i < size(); ++i)
            s_.density[i] = 0.5f * (density[0][i] + density[1][i]) * float(target);
        return true;
    }

    /// Reconstructs the image, unless that of these samples is there. `last`: no sample follows,
    /// and the film was kept.
    void reconstruct_image(bool last = false) {
        if (image_) return;
        predict();
        const double count = s_.mean_count();
        job_.monitor.update(Phase::reconstruction, job_.fraction(count), count);
        const PhaseTimer timer(job_.monitor, job_.seconds(Phase::reconstruction));
        Halves halves = halves_of(s_.films);
        // Features that the layers do not show, squares and rays serve weights and plans alone:
        // free them.
        if (last)
            for (Film& film : s_.films) {
                if (!job_.options.features) film.features = std::vector<PathFeatures>();
                film.feature_squares = std::vector<FeatureSquares>();
                film.rays = std::vector<uint32_t>();
            }
        image_ = reconstruct(std::move(halves), prediction_->spectrum, settings());
    }

    /// The average count at which the image will be as good as was asked for; the count that is
    /// taken already where it is so by its own estimate.
    double enough_samples() {
        if (!job_.options.error) return kInfinity;
        reconstruct_image();
        // Pixels brighter than squares can hold have no error that could be told, and are left out.
        double sum = 0, known = 0;
        const Plane brightness = luminance(image_->color);
        for (size_t i = 0; i < size(); ++i) {
            const float e = image_->relative_error[i];
            if (!std::isfinite(e)) continue;
            const double count = double(s_.films[0].pixels[i].count) + s_.films[1].pixels[i].count;
            sum += double(e) + unmet_.squared_error(i, count, brightness[i]);
            ++known;
        }
        if (known == 0) return kInfinity;
        const double error = std::sqrt(sum / known);
        job_.monitor.set_error(error);
        job_.enough =
            std::max(kLeastForError, s_.goal.samples(s_.taken, error, *job_.options.error));
        return *job_.enough;
    }

    /// Keeps time for the reconstruction, which is timed once, and for writing the image.
    void reserve_time() {
        if (!job_.options.seconds || !job_.delivers()) return;
        if (!times_)
            times_ = reconstruction_times(job_, *prediction_, denoiser_ ? &*denoiser_ : nullptr);
        job_.reserve(0);
        const double sampling = job_.target_spp && s_.seconds_spp > 0
                                    ? (*job_.target_spp - s_.taken) * s_.seconds / s_.seconds_spp
                                    : kInfinity;
        const auto quality =
            affordable_quality(*times_, job_.options.denoiser_quality,
                               job_.tracing_end() - job_.monitor.elapsed(), sampling);
        is_denoiser_too_slow_ = denoiser_ && !quality;
        quality_ = quality.value_or(quality_);
        job_.reserve(quality ? times_->denoised.at(*quality) : times_->without_denoiser);
    }

    RenderJob& job_;
    RenderState& s_;
    std::vector<PassContext> contexts_;
    std::optional<TimedDenoiser> denoiser_;
    DenoiserQuality quality_;
    bool is_denoiser_too_slow_ = false;
    std::optional<ReconstructionTimes> times_;  ///< there once time was to be kept
    std::optional<SceneAnalysis> analysis_;     // there while covariance paths are traced
    // Smoothed; there from the end of the covariance paths on.
    std::optional<Prediction> prediction_;
    std::optional<HybridImage> image_;  // image of the film as it is
    UnmetEmitters unmet_;               // filled where an error is asked for
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
