/// Measures the phases of a render.
#pragma once

#include "render/progress.h"

namespace covtrace {

/// Adds the seconds that a scope took to a phase.
class PhaseTimer {
  public:
    PhaseTimer(const Monitor& monitor, double& total)
        : monitor_(monitor), total_(total), start_(monitor.elapsed()) {}
    ~PhaseTimer() { total_ += monitor_.elapsed() - start_; }
    PhaseTimer(const PhaseTimer&) = delete;
    PhaseTimer& operator=(const PhaseTimer&) = delete;

  private:
    const Monitor& monitor_;
    double& total_;
    const double start_;
};

}  // namespace covtrace
