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
#include "render/rounds.h"
#include "render/sample_knowledge.h"
#include "render/scene_analysis.h"
#include "render/timed_denoiser.h"
#include "render/unmet_emitters.h"

namespace covtrace {

namespace {

/// Samples per pixel of the pilot, both halves together.
constexpr double kPilot = 4;
/// Least samples per pixel before an error is believed: fewer cannot tell that it is small, as
/// paths that carry much light and are rare have not been met yet.
constexpr double kLeastForError = 16;

class HybridRender {
  public:
    explicit HybridRender(RenderJob& job) : job_(job), s_(job.state) {
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
        reconstruct_image(true);
        if (is_denoiser_too_slow_)
            image_->denoiser_failure = "it takes longer than the time that was left";
        const PhaseTimer timer(job_.monitor, job_.seconds(Phase::reconstruction));
        const Reconstructed known{*image_, *prediction_};
        job_.result.image = develop(s_, denoiser(), known);
    }

    HybridSamples samples() && {
        predict();
        return {std::move(s_.films), std::move(*prediction_)};
    }

  private:
    size_t size() const { return s_.pixels(); }
    const Denoiser* denoiser() const { return denoiser_ ? &*denoiser_ : nullptr; }
    HybridSettings settings() const {
        HybridSettings settings;
        settings.denoiser = denoiser();
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

    std::vector<std::vector<uint32_t>> pilot_counts() const {
        return {share_between_halves(0, pilot()), share_between_halves(1, pilot())};
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
                s_.plan = pilot_counts();
                s_.target = pilot();
                return true;
            case Stage::rounds:
                break;
        }
        // Go on with the pilot where a budget ended within it
        if (s_.taken < pilot() && job_.begin_round(pilot(), pilot_counts())) return true;
        const bool first_here = !prediction_;
        predict();
        if (first_here && job_.options.seconds) reserve_time();
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

    /// Keeps time for the reconstruction and for writing the image. The denoiser is given up where
    /// there is too little time for a reconstruction with it.
    void reserve_time() {
        if (!job_.delivers()) return;
        // Seconds of writing over those of the reconstruction beside the denoiser: 0.28 to 0.36 at
        // 400x300, 960x540 and 1920x1080
        constexpr double kWriting = 0.35;
        const PartTime part = least_part_time();
        const double parts = double(size()) / part.pixels,
                     rest = (1 + kWriting) * part.rest * parts,
                     with_denoiser = rest + part.denoiser * parts;
        is_denoiser_too_slow_ =
            denoiser_ && with_denoiser > job_.tracing_end() - job_.monitor.elapsed();
        if (is_denoiser_too_slow_) denoiser_.reset();
        job_.reserve(is_denoiser_too_slow_ ? rest : with_denoiser);
    }

    struct PartTime {
        double pixels = 0;
        double denoiser = 0, rest = 0;  ///< seconds
    };

    /// Times the reconstruction of a part of the image, and of a large image the least of three
    /// times, as other work of the machine makes one in a few much longer. The times decide when to
    /// stop and nothing else.
    PartTime least_part_time() {
        constexpr int kTinySide = 16, kSide = 96;
        constexpr size_t kLarge = 10 * kSide * kSide;  // pixels
        if (denoiser_) time_part(kTinySide);  // to start the denoiser takes as long as a part
        PartTime least = time_part(kSide);
        for (int i = 0; i < 2 && size() >= kLarge; ++i) {
            const PartTime again = time_part(kSide);
            least.denoiser = std::min(least.denoiser, again.denoiser);
            least.rest = std::min(least.rest, again.rest);
        }
        return least;
    }

    /// Times the reconstruction of the middle of the image, at most `side` pixels wide and high.
    PartTime time_part(int side) {
        const PixelBounds all = job_.region;
        const int w = std::min(side, all.width()), h = std::min(side, all.height());
        const PixelBounds part{all.x0 + (all.width() - w) / 2, all.y0 + (all.height() - h) / 2,
                               all.x0 + (all.width() + w) / 2, all.y0 + (all.height() + h) / 2};
        const PhaseTimer timer(job_.monitor, job_.seconds(Phase::reconstruction));
        std::vector<Film> films(2, Film(part, film_parts(Method::hybrid)));
        std::vector<Covariance2> spectrum;
        for (int y = part.y0; y < part.y1; ++y)
            for (int x = part.x0; x < part.x1; ++x) {
                const size_t to = size_t(y - part.y0) * size_t(part.width()) + size_t(x - part.x0);
                const size_t from = size_t(y - all.y0) * size_t(all.width()) + size_t(x - all.x0);
                for (size_t k = 0; k < 2; ++k) {
                    films[k].pixels[to] = s_.films[k].pixels[from];
                    films[k].features[to] = s_.films[k].features[from];
                    films[k].feature_squares[to] = s_.films[k].feature_squares[from];
                }
                spectrum.push_back(prediction_->spectrum[from]);
            }
        Halves halves = halves_of(films);
        // Planes of zeros take the denoiser no time
        for (HalfBuffer& half : halves)
            for (float* v : {&half.color[0][0], &half.feature[0][0], &half.feature[3][0]})
                *v = std::max(*v, 1.0f);
        const auto denoising = [this] { return denoiser_ ? job_.seconds(Phase::denoise) : 0.0; };
        const double start = job_.monitor.elapsed(), before = denoising();
        reconstruct(std::move(halves), spectrum, settings());
        const double denoiser = denoising() - before;
        return {double(spectrum.size()), denoiser, job_.monitor.elapsed() - start - denoiser};
    }

    RenderJob& job_;
    RenderState& s_;
    std::vector<PassContext> contexts_;
    std::optional<TimedDenoiser> denoiser_;
    bool is_denoiser_too_slow_ = false;
    std::optional<SceneAnalysis> analysis_;  // there while covariance paths are traced
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
