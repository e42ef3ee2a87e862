/// A study of a scene: rendered by our methods, by the choices of Belcour 2012, and by the plain
/// path tracer at equal time and at equal error. Shared by the experiments of a run.
#pragma once

#include <string>
#include <vector>

#include "reproduce/search.h"
#include "reproduce/section.h"

namespace covtrace::reproduce {

/// CPU seconds of the parts of a render, from the shares of its phases.
struct Breakdown {
    /// Covariance paths beyond the radiance that they deliver, occluders, spectra, plans.
    double analysis = 0;
    double spectra = 0;  ///< of the analysis, what comes before the first path: textures and lights
    double radiance = 0;  ///< all samples, those of the covariance paths too
    double reconstruction = 0;
    double total = 0;
};

struct MethodStudy {
    std::string name, label;
    Sampled ours;
    Breakdown breakdown;
    Match equal_time, equal_error;  ///< the path tracer at equal time, and at equal error
};

/// The study of the choices of Belcour 2012, beside the path tracer as the curve has it.
struct ThesisStudy {
    std::string label;
    int cap = 0;  ///< most samples of a pixel
    FilterRule filter = FilterRule::thesis;
    Timed timed;
    double error = 0, uniform_error_same_time = 0, uniform_cpu_same_error = 0;
    Breakdown breakdown;
};

struct SceneStudy {
    std::string name;
    LoadedScene* scene = nullptr;          ///< the scene, owned by the workshop
    const Reference* reference = nullptr;  ///< the reference, owned by the workshop
    std::unique_ptr<UniformCurve> curve;
    std::vector<MethodStudy> methods;  ///< covariance, the same on demand, hybrid
    std::vector<ThesisStudy> thesis;   ///< by limit of samples, with each of the three filters
};

/// The numbers that Belcour 2012, section 5.1, used: covariance paths, and limits of samples.
struct ThesisChoices {
    std::string scene;  ///< the generated scene that stands for that of Belcour 2012
    int cov_spp;
    std::vector<int> caps;
};

/// The study of a scene, made once per workshop and scene.
SceneStudy& study(Workshop& workshop, const std::string& name, const ThesisChoices& choices);

/// The table of a study. Rows: method, samples, seconds, error; the path tracer at equal time and
/// error, the ratios.
Table comparison_table(const SceneStudy& study);
/// The study's numbers, all of them.
nlohmann::json to_json(const SceneStudy& study);

/// Adds our images and the path tracer's with insets, error maps and samples, and writes the
/// viewer's page beside them.
void add_pictures(Section& section, const SceneStudy& study, Workshop& workshop,
                  const std::vector<std::array<double, 4>>& insets, const std::string& content);

}  // namespace covtrace::reproduce
