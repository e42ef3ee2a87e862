/// The phases of a render, and how long each took.
#pragma once

#include <map>
#include <string>

#include "core/enum_names.h"

namespace covtrace {

enum class Phase {
    load,            ///< reads the scene's files
    build,           ///< makes of the description what rays are traced in
    grid,            ///< voxels of what occludes, for the frequency analysis
    outlines,        ///< silhouettes in a hierarchy, in place of the grid
    spectra,         ///< of the textures
    covariance,      ///< paths that leave covariances
    plan,            ///< covariances and variances to sample counts
    radiance,        ///< paths that leave radiance alone
    reconstruction,  ///< samples to the image, without `denoise`
    denoise,         ///< the denoiser among the candidates of the reconstruction
    checkpoint,      ///< writes films in between
    write,           ///< writes the image
    done             ///< all files are there
};

template <>
inline constexpr auto kEnumNames<Phase> = enum_names<Phase>({{Phase::load, "load"},
                                                             {Phase::build, "build"},
                                                             {Phase::grid, "grid"},
                                                             {Phase::outlines, "outlines"},
                                                             {Phase::spectra, "spectra"},
                                                             {Phase::covariance, "covariance"},
                                                             {Phase::plan, "plan"},
                                                             {Phase::radiance, "radiance"},
                                                             {Phase::reconstruction,
                                                              "reconstruction"},
                                                             {Phase::denoise, "denoise"},
                                                             {Phase::checkpoint, "checkpoint"},
                                                             {Phase::write, "write"},
                                                             {Phase::done, "done"}});

/// Seconds of the wall clock. A phase that did not take place is missing.
using PhaseSeconds = std::map<Phase, double>;

/// The same by name, for JSON and Python.
inline std::map<std::string, double> named(const PhaseSeconds& seconds) {
    std::map<std::string, double> by_name;
    for (const auto& [phase, value] : seconds) by_name.emplace(name_of(phase), value);
    return by_name;
}

}  // namespace covtrace
