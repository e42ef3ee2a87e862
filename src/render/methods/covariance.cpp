#include "render/methods/covariance.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "planner/density.h"
#include "reconstruction/filter_field.h"
#include "render/develop.h"
#include "render/methods/covariance_image.h"
#include "render/rounds.h"
#include "render/sample_knowledge.h"
#include "render/scene_analysis.h"

namespace covtrace {

namespace {

/// Share of the samples on demand that is spread evenly.
constexpr float kEvenShare = 0.1f;

/// Samples per pixel from which on samples tell where filters leave noise, and the factor of them
/// after which they are asked again: it costs as much as to make the image.
constexpr double kFirstVerified = 4, kVerifiedAgain = 4;

/// Name, in films and images, of the factor k of the density N = k sqrt|S| (Belcour 2012, section
/// 5.1, equation 5.3).
constexpr auto kFactorName = "covtrace:k";

class CovarianceRender {
  public:
    explicit CovarianceRender(RenderJob& job) : job_(job), s_(job.state) {
        if (s_.stage != Stage::rounds) analysis_.emplace(job);
    }

    void run() {
        trace_rounds(job_, {[this] { return plan(); }, [this] { trace(); }});
        job_.result.statistics.density_factor = factor();
        if (!job_.delivers()) return;
        job_.monitor.update(Phase::reconstruction, RenderJob::kTracingShare, s_.mean_count());
        const PhaseTimer timer(job_.monitor, job_.seconds(Phase::reconstruction));
        job_.result.image = develop(s_);
    }

  private:
    bool plan() {
        if (s_.stage != Stage::rounds) {
            // Plan covariance paths: one per pixel first, then the rest
            std::vector<uint32_t> counts = job_.even_counts(s_.covariance_spp);
            if (s_.stage == Stage::first_paths)
                for (uint32_t& c : counts) c = std::min(c, 1u);
            s_.plan = {std::move(counts)};
            s_.target = s_.stage == Stage::first_paths ? std::min(1.0, s_.covariance_spp)
                                                       : s_.covariance_spp;
            return true;
        }
        // Predict the image's spectrum, once all covariance paths are there
        if (!prediction_) {
            const PhaseTimer timer(job_.monitor, job_.seconds(Phase::plan));
            const double start = job_.monitor.elapsed();
            prediction_ = preintegrated(smoothed(merge(s_.parts())));
            // Reconstruction and writing take 17 to 24 times as long: snooker and motion at 320x180
            // and 960x540
            job_.reserve(20 * (job_.monitor.elapsed() - start));
        }
        // Choose how far the next round goes
        if (has_enough()) return false;
        const double end = round_end(s_.taken);
        // The filters are those that the whole round leads to: a budget must not change what it
        // begins with.
        const FilterSettings settings = covariance::filter_settings(end);
        std::vector<uint32_t> have(s_.pixels());
        for (size_t i = 0; i < have.size(); ++i) have[i] = s_.films[0].pixels[i].count;
        const double enough = enough_samples(settings, have);
        // The density costs as much as an image: it is made where there is time for samples, and
        // the round divides the time that is left then.
        const auto round_target = [&] { return job_.plan_round(std::min(end, enough)); };
        std::vector<float> density;
        if (round_target() > s_.taken) {
            const PhaseTimer timer(job_.monitor, job_.seconds(Phase::plan));
            density = relative_counts(settings);
        }
        const double target = round_target();
        if (target >= enough) tell_factor(settings, *job_.options.density_factor);
        if (!(target > s_.taken)) return false;
        // Share the round's samples among the pixels
        const PhaseTimer timer(job_.monitor, job_.seconds(Phase::plan));
        const int64_t total = std::llround(target * double(job_.pixels()));
        const uint32_t most = most_samples(target);
        std::vector<uint32_t> counts = job_.options.progressive
                                           ? allocate_on_demand(density, total, have, most)
                                           : allocate(density, total, have, most);
        if (!job_.begin_round(target, {std::move(counts)})) return false;
        if (target >= enough) return true;
        for (float& d : density) d *= float(target);
        s_.density = std::move(density);
        if (!has_factor()) return true;
        const auto k = density_factor(hypercube_counts(*prediction_, settings.c, settings.limits),
                                      total, have, most);
        if (k)
            tell_factor(settings, *k);
        else
            s_.metadata.erase(kFactorName);
        return true;
    }

    /// Keeps the density k N of the plan, N as in Belcour 2012, equation 5.3, and its factor k.
    void tell_factor(const FilterSettings& settings, double k) {
        s_.density = hypercube_counts(*prediction_, settings.c, settings.limits);
        for (float& d : s_.density) d *= float(k);
        s_.metadata[kFactorName] = float(k);
    }

    /// Whether counts are multiples of the N of Belcour 2012, equation 5.3, so that there is a
    /// factor.
    bool has_factor() const {
        return job_.options.density == DensityRule::thesis && !job_.options.progressive;
    }

    uint32_t most_samples(double target) const {
        return uint32_t(std::clamp(job_.most_samples(target), 1.0, 4e9));
    }

    /// Whether the last plan had the factor that was asked for. Counts are whole numbers, so that
    /// another plan would find pixels that lack a part of a sample.
    bool has_enough() const {
        // Rounding of the factor in single precision, and of the total.
        constexpr double kRounding = 1e-5;
        const auto k = factor();
        return job_.options.density_factor && k &&
               *k >= *job_.options.density_factor * (1 - kRounding);
    }

    /// The factor k of the last plan; none before the first one.
    std::optional<double> factor() const {
        const auto k = s_.metadata.find(kFactorName);
        if (k == s_.metadata.end()) return std::nullopt;
        // A changed film may hold another type.
        const float* value = std::get_if<float>(&k->second);
        return value ? std::optional(double(*value)) : std::nullopt;
    }

    /// The average count at which every pixel has the samples that the factor which was asked for
    /// gives it.
    double enough_samples(const FilterSettings& settings, std::span<const uint32_t> have) {
        if (!job_.options.density_factor) return kInfinity;
        // The limit of 0 stands for any average: where there is a factor, the limit does not depend
        // on it.
        job_.enough = mean_count(hypercube_counts(*prediction_, settings.c, settings.limits),
                                 *job_.options.density_factor, have, most_samples(0));
        return *job_.enough;
    }

    /// Whether the last plan's density was made of samples and holds still. It is made again where
    /// `taken` is 4, 16, 64 and so on exactly: `taken` is the end of a round as planned, not the
    /// mean of counts, every round ends at the next power of two at the latest, and powers of two
    /// are exact. After a round that a budget ended between them the last density holds.
    bool has_verified_density() const {
        double again = kFirstVerified;
        while (again < s_.taken) again *= kVerifiedAgain;
        return !s_.density.empty() && again != s_.taken;
    }

    /// The density of the noise that the filters leave.
    std::vector<float> verified_density(const FilterSettings& settings) const {
        if (has_verified_density()) return scaled_to_mean_one(s_.density);
        const FilteredImage image = covariance_image(s_, covariance_filters(s_));
        const Plane none(s_.region.width(), s_.region.height());
        FilteredKnowledge known{none, none, none};
        for (size_t i = 0; i < none.size(); ++i) {
            known.brightness[i] = luminance(image.color[i]);
            known.variance[i] = image.variance[i];
            known.count[i] = float(s_.films[0].pixels[i].count);
        }
        std::vector<float> density = density_of_noise_left(
            known, relative_density(*prediction_, predicted_rule(DensityRule::verified), settings.c,
                                    settings.limits));
        spread_evenly(density, kEvenShare);
        return density;
    }

    std::vector<float> relative_counts(const FilterSettings& settings) const {
        if (job_.options.density == DensityRule::verified && s_.taken >= kFirstVerified)
            return verified_density(settings);
        const covariance::DensityRule rule = predicted_rule(job_.options.density);
        if (!job_.options.progressive)
            return relative_density(*prediction_, rule, settings.c, settings.limits);
        SampleKnowledge known = knowledge_from(s_.films[0], prediction_->spectrum);
        known.emphasis = emphasis(*prediction_, rule, settings.c, settings.limits);
        std::vector<float> density = adaptive_density(known, kOwnPlan);
        spread_evenly(density, kEvenShare);
        return density;
    }

    void trace() {
        const bool radiance = s_.stage == Stage::rounds;
        const Phase phase = radiance ? Phase::radiance : Phase::covariance;
        const PhaseTimer timer(job_.monitor, job_.seconds(phase));
        const PassProgress progress = job_.reporter(phase, s_.taken, s_.target);
        auto& statistics = job_.result.statistics;
        if (radiance) {
            job_.counted(statistics.radiance, radiance_pass(job_.context, s_.films[0], s_.plan[0],
                                                            job_.monitor, progress));
            return;
        }
        job_.counted(statistics.covariance,
                     covariance_pass(job_.context, analysis_->replay(), s_.films[0], s_.plan[0],
                                     {s_.parts(), {}, s_.weight_limit.value_or(kInfinity)},
                                     job_.monitor, progress));
        analysis_->note_memory();
    }

    RenderJob& job_;
    RenderState& s_;
    std::optional<SceneAnalysis> analysis_;  // there while covariance paths are traced
    std::optional<Prediction> prediction_;   // there from the end of the covariance paths on
};

}  // namespace

void render_covariance(RenderJob& job) {
    CovarianceRender(job).run();
}

}  // namespace covtrace
