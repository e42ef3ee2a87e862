#include "render/progress.h"

#include <utility>

namespace covtrace {

Monitor::Monitor(std::function<void(const Progress&)> report, double interval,
                 Clock::time_point start)
    : report_(std::move(report)), interval_(interval), start_(start) {}

double Monitor::elapsed() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
}

/// Remaining seconds, from the speed since the first report: the time before it (reading the scene)
/// comes only once.
double Monitor::remaining(double now, double fraction) {
    constexpr double kLeast = 0.01;  // share of the render before which the estimate is a guess
    if (begin_fraction_ < 0) {
        begin_ = now;
        begin_fraction_ = fraction;
    }
    const double done = fraction - begin_fraction_;
    return done >= kLeast ? (now - begin_) * (1 - fraction) / done : kUnknown;
}

void Monitor::update(Phase phase, double fraction, double samples_per_pixel) {
    if (!report_) return;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return;
    const double now = elapsed();
    // The first report of a phase may be its only one for long
    if (last_report_ >= 0 && now - last_report_ < interval_ && phase == last_phase_) return;
    last_report_ = now;
    last_phase_ = phase;
    report_({phase, fraction, samples_per_pixel, now, remaining(now, fraction), error_});
}

}  // namespace covtrace
