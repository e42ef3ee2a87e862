#include "reproduce/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "reproduce/statistics.h"

namespace covtrace::reproduce {

namespace {

RenderOptions uniform_options(double spp, uint64_t seed) {
    RenderOptions options;
    options.method = Method::uniform;
    options.spp = spp;
    options.seed = seed;
    return options;
}

constexpr double kTolerance = 0.05;
constexpr int kCorrections = 3;

}  // namespace

UniformCurve::UniformCurve(Workshop& workshop, LoadedScene& scene, const Reference& reference,
                           double spp, double error, double most_spp) {
    double looked = 0;  // CPU seconds spent on looking
    const double start = cpu_seconds();
    workshop.tell(scene.name + ": the path tracer, round by round");
    workshop.render(scene, uniform_options(most_spp, workshop.settings.seeds.front()),
                    [&](Monitor& monitor, Image image) {
                        const double now = cpu_seconds();
                        const auto& counts = image.find("samples.Y")->values;
                        const double taken = std::accumulate(counts.begin(), counts.end(), 0.0) /
                                             double(counts.size());
                        points_.push_back({taken, now - start - looked, reference.error(image)});
                        looked += cpu_seconds() - now;
                        if (taken >= spp && points_.back().error < error) monitor.cancel();
                    });
    cpu_per_spp_ = points_.back().cpu / points_.back().spp;
}

double UniformCurve::spp_in(double cpu) const {
    return cpu / cpu_per_spp_;
}

double UniformCurve::spp_for(double error) const {
    for (size_t i = 0; i < points_.size(); ++i) {
        if (points_[i].error > error) continue;
        if (i == 0) return points_[0].spp * points_[0].error / error;
        const Point &a = points_[i - 1], &b = points_[i];
        if (!(b.error > 0)) return b.spp;
        const double t = std::log(a.error / error) / std::log(a.error / b.error);
        return a.spp * std::pow(b.spp / a.spp, t);
    }
    return std::numeric_limits<double>::infinity();
}

double Sampled::mean_error() const {
    return mean(error);
}
double Sampled::mean_cpu() const {
    return mean(cpu);
}
double Sampled::mean_spp() const {
    return mean(spp);
}

Sampled sample(Workshop& workshop, LoadedScene& scene, const Reference& reference,
               RenderOptions options) {
    Sampled s;
    for (const uint64_t seed : workshop.settings.seeds) {
        options.seed = seed;
        Timed timed = workshop.render(scene, options);
        s.error.push_back(reference.error(timed.result.image));
        s.cpu.push_back(timed.cpu);
        s.spp.push_back(timed.result.statistics.samples_per_pixel);
        if (seed == workshop.settings.seeds.front()) s.first = std::move(timed);
    }
    return s;
}

Match match_time(Workshop& workshop, LoadedScene& scene, const Reference& reference,
                 const UniformCurve& curve, double cpu) {
    Match m;
    m.found = true;
    m.spp = std::max(curve.spp_in(cpu), 1.0 / 16);
    for (int k = 0; k < kCorrections; ++k) {
        m.uniform = sample(workshop, scene, reference, uniform_options(m.spp, 0));
        m.mismatch = m.uniform.mean_cpu() / cpu - 1;
        if (std::abs(m.mismatch) <= kTolerance || k + 1 == kCorrections) break;
        m.spp = std::max(m.spp / (1 + m.mismatch), 1.0 / 16);
    }
    return m;
}

Match match_error(Workshop& workshop, LoadedScene& scene, const Reference& reference,
                  const UniformCurve& curve, double error) {
    Match m;
    m.spp = curve.spp_for(error);
    m.found = std::isfinite(m.spp) && error > 0;
    if (!m.found) return m;
    for (int k = 0; k < kCorrections; ++k) {
        m.uniform = sample(workshop, scene, reference, uniform_options(m.spp, 0));
        m.mismatch = m.uniform.mean_error() / error - 1;
        if (std::abs(m.mismatch) <= kTolerance || k + 1 == kCorrections) break;
        // The error of a mean of n samples falls as 1/n.
        m.spp = std::min(m.spp * (1 + m.mismatch), workshop.settings.most_spp);
    }
    return m;
}

Spread ratios(const std::vector<double>& numerators, const std::vector<double>& denominators) {
    Spread s{0, std::numeric_limits<double>::infinity(), 0};
    double logs = 0;
    const size_t n = std::min(numerators.size(), denominators.size());
    for (size_t i = 0; i < n; ++i) {
        const double r = numerators[i] / denominators[i];
        logs += std::log(r);
        s.least = std::min(s.least, r);
        s.most = std::max(s.most, r);
    }
    s.mean = n > 0 ? std::exp(logs / double(n)) : 0;
    return s;
}

std::string Spread::text() const {
    return fmt::format("{:.2f} ({:.2f} to {:.2f})", mean, least, most);
}

}  // namespace covtrace::reproduce
