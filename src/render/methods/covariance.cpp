#include "render/methods/covariance.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "planner/density.h"
#include "reconstruction/filter_field.h"
#include "render/develop.h"
#include "render/rounds.h"
#include "render/sample_knowledge.h"
#include "render/scene_occluders.h"

namespace covtrace {

namespace {

/// Of the samples on demand, spread evenly.
constexpr float kEvenShare = 0.1f;

/// What films and images call the factor of the thesis' density.
constexpr auto kFactorName = "covtrace:k";

class CovarianceRender {
  public:
    explicit CovarianceRender(RenderJob& job) : job_(job), s_(job.state) {
        if (s_.stage == Stage::rounds) return;
        {
            const PhaseTimer timer(job.monitor, job.seconds(Phase::spectra));
            job.scene.prepare_spectra(job.options.texture_bandwidth);
        }
        occluders_.emplace(job);
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
            std::vector<uint32_t> counts = job_.even_counts(s_.covariance_spp);
            if (s_.stage == Stage::first_paths)
                for (uint32_t& c : counts) c = std::min(c, 1u);
            s_.plan = {std::move(counts)};
            s_.target = s_.stage == Stage::first_paths ? std::min(1.0, s_.covariance_spp)
                                                       : s_.covariance_spp;
            return true;
        }
        if (!prediction_) {
            const PhaseTimer timer(job_.monitor, job_.seconds(Phase::plan));
            const double start = job_.monitor.elapsed();
            prediction_ = preintegrated(smoothed(merge(s_.parts())));
            job_.reserve(6 * (job_.monitor.elapsed() - start));
        }
        if (has_enough()) return false;
        const double end = round_end(s_.taken);
        // The filters that the whole round leads to: a budget must not change what it begins with.
        const FilterSettings settings = covariance::filter_settings(end);
        std::vector<uint32_t> have(s_.pixels());
        for (size_t i = 0; i < have.size(); ++i) have[i] = s_.films[0].pixels[i].count;
        const double enough = enough_samples(settings, have);
        const double target = job_.plan_round(std::min(end, enough));
        if (target >= enough) tell_factor(settings, *job_.options.density_factor);
        if (!(target > s_.taken)) return false;
        const PhaseTimer timer(job_.monitor, job_.seconds(Phase::plan));
        std::vector<float> density = relative_counts(settings);
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

    /// Keeps what the thesis' density asks for, and by which factor.
    void tell_factor(const FilterSettings& settings, double k) {
        s_.density = hypercube_counts(*prediction_, settings.c, settings.limits);
        for (float& d : s_.density) d *= float(k);
        s_.metadata[kFactorName] = float(k);
    }

    /// Whether counts are multiples of the thesis' N.
    bool has_factor() const {
        return job_.options.density == DensityRule::thesis && !job_.options.progressive;
    }

    uint32_t most_samples(double target) const {
        return uint32_t(std::clamp(job_.most_samples(target), 1.0, 4e9));
    }

    /// Whether the last plan had the factor that was asked for. Counts are whole, so that another
    /// one would find pixels that lack a part of a sample.
    bool has_enough() const {
        constexpr double kRounding = 1e-5;  // of the factor in single precision, and of the total
        const auto k = factor();
        return job_.options.density_factor && k &&
               *k >= *job_.options.density_factor * (1 - kRounding);
    }

    /// Of the last plan.
    std::optional<double> factor() const {
        const auto k = s_.metadata.find(kFactorName);
        if (k == s_.metadata.end()) return std::nullopt;
        const float* value = std::get_if<float>(&k->second);  // films may have been changed
        return value ? std::optional(double(*value)) : std::nullopt;
    }

    /// The average at which every pixel has the count that the factor which was asked for gives it.
    double enough_samples(const FilterSettings& settings, std::span<const uint32_t> have) {
        if (!job_.options.density_factor) return kInfinity;
        // The limit does not depend on the average where there is a factor.
        job_.enough = mean_count(hypercube_counts(*prediction_, settings.c, settings.limits),
                                 *job_.options.density_factor, have, most_samples(0));
        return *job_.enough;
    }

    std::vector<float> relative_counts(const FilterSettings& settings) const {
        const DensityRule rule = job_.options.density;
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
        if (radiance)
            job_.counted(statistics.radiance, radiance_pass(job_.context, s_.films[0], s_.plan[0],
                                                            job_.monitor, progress));
        else
            job_.counted(statistics.covariance,
                         covariance_pass(job_.context, occluders_->view(),
                                         job_.options.brdf_covariance, s_.films[0], s_.plan[0],
                                         {s_.parts(), {}, s_.weight_limit.value_or(kInfinity)},
                                         job_.monitor, progress));
    }

    RenderJob& job_;
    RenderState& s_;
    std::optional<SceneOccluders> occluders_;  // while covariance paths are traced
    std::optional<Prediction> prediction_;     // from their end on
};

}  // namespace

void render_covariance(RenderJob& job) {
    CovarianceRender(job).run();
}

}  // namespace covtrace
