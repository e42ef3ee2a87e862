#include "render/progress.h"

#include <utility>

namespace covtrace {

Monitor::Monitor(std::function<void(const Progress&)> report, double interval,
                 Clock::time_point start)
    : report_(std::move(report)), interval_(interval), start_(start) {}

double Monitor::elapsed() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
}

void Monitor::update(std::string_view phase, double fraction, double samples_per_pixel) {
    if (!report_) return;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return;
    const double now = elapsed();
    if (last_report_ >= 0 && now - last_report_ < interval_) return;
    last_report_ = now;
    const double remaining = fraction > 0 ? now * (1 - fraction) / fraction : 0;
    report_({phase, fraction, samples_per_pixel, now, remaining});
}

}  // namespace covtrace
