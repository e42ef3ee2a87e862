/// Progress of a render, and the way to stop it.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <limits>
#include <mutex>

#include "image/image.h"
#include "render/phase.h"

namespace covtrace {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

struct Progress {
    Phase phase{};        ///< covariance, radiance or reconstruction
    double fraction = 0;  ///< of the whole render, in [0, 1); 1 only when the image is ready
    double samples_per_pixel = 0;  ///< taken so far
    double elapsed = 0;            ///< seconds
    double remaining = kUnknown;   ///< estimated seconds; kUnknown at first
    double error = kUnknown;       ///< estimated sqrt(relMSE) after the last round; kUnknown where
                                   ///< nobody has told it
};

/// Link between a render and its caller; all members may be used from any thread.
class Monitor {
  public:
    using Clock = std::chrono::steady_clock;
    /// Makes a monitor that calls `report` at most every `interval` seconds, and where a phase
    /// begins, from one thread at a time.
    explicit Monitor(std::function<void(const Progress&)> report = {}, double interval = 0.1,
                     Clock::time_point start = Clock::now());

    /// Asks the render to stop soon with a usable image.
    void cancel() { cancelled_ = true; }
    bool cancelled() const { return cancelled_ || (interrupted && *interrupted); }
    /// Flag that cancels the render, too, once it is true; to be set before the render. Whoever
    /// raises it, such as a signal handler, need not know which render runs.
    const std::atomic<bool>* interrupted = nullptr;
    double elapsed() const;
    /// Asks passes to return early from `elapsed` seconds on, so that the film can be kept.
    void pause_at(double elapsed) { pause_at_ = elapsed; }
    bool pause_is_due() const { return elapsed() >= pause_at_; }
    /// Reports, unless the last report is too recent, of the same phase, or another thread is
    /// reporting.
    void update(Phase phase, double fraction, double samples_per_pixel);
    /// Sets the error that the following reports tell.
    void set_error(double error) { error_ = error; }
    double error() const { return error_; }

    /// Callback for the image so far, called between rounds by one thread; to be set before the
    /// render. It must not take long.
    std::function<void(Image)> watcher;
    bool watched() const { return bool(watcher); }
    void show(Image image) const { watcher(std::move(image)); }

  private:
    double remaining(double now, double fraction);

    std::function<void(const Progress&)> report_;
    const double interval_;
    const Clock::time_point start_;
    std::atomic<bool> cancelled_{false};
    std::atomic<double> error_{kUnknown};
    std::atomic<double> pause_at_{std::numeric_limits<double>::infinity()};
    std::mutex mutex_;
    double last_report_ = -1;
    Phase last_phase_{};
    double begin_ = 0, begin_fraction_ = -1;  ///< the first report of a fraction
};

}  // namespace covtrace
