/// The phases of a render, and how long each took.
#pragma once

#include <map>
#include <string>

#include "core/enum_names.h"

namespace covtrace {

enum class Phase {
    load,            ///< reads the scene's files
    build,           ///< makes the traceable scene out of the description
    grid,            ///< makes the voxel grid of occluders, for the frequency analysis
    outlines,        ///< makes the hierarchy of silhouettes, in place of the grid
    spectra,         ///< measures the spectra of the textures
    covariance,      ///< traces the paths that leave covariances
    plan,            ///< turns covariances and variances into sample counts
    radiance,        ///< traces the paths that leave radiance alone
    reconstruction,  ///< makes the image of the samples, without `denoise`
    denoise,         ///< runs the denoiser among the candidates of the reconstruction
    checkpoint,      ///< writes films in between
    write,           ///< writes the image
    done             ///< all files are written
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

/// Seconds of the wall clock by phase. A phase that did not take place is missing.
using PhaseSeconds = std::map<Phase, double>;

/// Seconds by the names of the phases, for JSON and Python.
inline std::map<std::string, double> named(const PhaseSeconds& seconds) {
    std::map<std::string, double> by_name;
    for (const auto& [phase, value] : seconds) by_name.emplace(name_of(phase), value);
    return by_name;
}

}  // namespace covtrace
