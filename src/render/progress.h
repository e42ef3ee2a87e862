/// How a render tells what it is doing, and how it is told to stop.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <string_view>

namespace covtrace {

struct Progress {
    std::string_view phase;  ///< "covariance", "radiance", "reconstruction"
    double fraction = 0;     ///< of the whole render, in [0, 1); 1 only when the image is ready
    double samples_per_pixel = 0;  ///< taken so far
    double elapsed = 0;            ///< seconds
    double remaining = 0;          ///< estimated seconds
};

/// Shared by a session and its caller; all members may be used from any thread.
class Monitor {
  public:
    using Clock = std::chrono::steady_clock;
    /// `report` is called at most every `interval` seconds, by one thread at a time.
    explicit Monitor(std::function<void(const Progress&)> report = {}, double interval = 0.1,
                     Clock::time_point start = Clock::now());

    /// Asks the render to stop soon with a usable image.
    void cancel() { cancelled_ = true; }
    bool cancelled() const { return cancelled_; }
    double elapsed() const;
    /// Reports, unless the last report is too fresh or another thread is reporting.
    void update(std::string_view phase, double fraction, double samples_per_pixel);

  private:
    std::function<void(const Progress&)> report_;
    const double interval_;
    const Clock::time_point start_;
    std::atomic<bool> cancelled_{false};
    std::mutex mutex_;
    double last_report_ = -1;
};

}  // namespace covtrace
