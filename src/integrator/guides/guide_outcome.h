/// The outcome of learning a guide from a scene.
#pragma once

#include <cstddef>

#include "core/enum_names.h"

namespace covtrace {

/// Whether paths are led by guides.
enum class Guides {
    automatic,  ///< by those that pay in the scene
    none        ///< by none
};

template <>
inline constexpr auto kEnumNames<Guides> = enum_names<Guides>({{Guides::automatic, "auto"},
                                                               {Guides::none, "none"}});

enum class GuideState {
    unused,   ///< switched off, nothing of its kind in the scene, or paths too long to learn from;
              ///< panes and mirrors, which need no lesson, for want of any alone
    gave_up,  ///< a trial told that it would not pay
    guides    ///< it leads paths
};

template <>
inline constexpr auto kEnumNames<GuideState> =
    enum_names<GuideState>({{GuideState::unused, "unused"},
                            {GuideState::gave_up, "gave up"},
                            {GuideState::guides, "guides"}});

struct GuideOutcome {
    GuideState state = GuideState::unused;
    double seconds = 0;  ///< wall clock that learning took
    size_t bytes = 0;    ///< memory that it holds
    /// Second moment of the light that it leads to with the guide over that without it, as a trial
    /// on paths that it was not learnt from measured it; 0 where there was none.
    double second_moment = 0;
    size_t most_probed = 0;  ///< most images of lights that a place was searched for at once
};

}  // namespace covtrace
