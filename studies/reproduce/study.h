/// A scene rendered by our methods, by the thesis' choices, and by the plain path tracer at equal
/// time and at equal error. Shared by the experiments of a run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reproduce/search.h"
#include "reproduce/section.h"

namespace covtrace::reproduce {

/// CPU seconds of the parts of a render, from the shares of its phases.
struct Breakdown {
    double analysis = 0;  ///< covariance paths beyond the radiance that they deliver, occluders
    double radiance = 0;  ///< all samples, those of the covariance paths too
    double reconstruction = 0;
    double total = 0;
};

struct MethodStudy {
    std::string name, label;
    Sampled ours;
    Breakdown breakdown;
    std::optional<double> bias_floor;  ///< error of the same filters on an image without noise
    Match equal_time, equal_error;     ///< the path tracer
};

/// What the thesis' own choices give, beside the path tracer as the curve has it.
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
    LoadedScene* scene = nullptr;          ///< the workshop's
    const Reference* reference = nullptr;  ///< likewise
    std::unique_ptr<UniformCurve> curve;
    std::vector<MethodStudy> methods;  ///< covariance, hybrid
    std::vector<ThesisStudy> thesis;   ///< by limit of samples, with each of the three filters
};

/// What the thesis used.
struct ThesisChoices {
    int cov_spp;
    std::vector<int> caps;
};

/// Made once per workshop and scene.
SceneStudy& study(Workshop& workshop, const std::string& name, const ThesisChoices& choices);

/// Rows: method, samples, seconds, error; the path tracer at equal time and error, the ratios.
Table comparison_table(const SceneStudy& study);
/// Every number of the study.
nlohmann::json to_json(const SceneStudy& study);

/// Ours and the path tracer with insets, error maps and samples; the viewer's page beside them.
void add_pictures(Section& section, const SceneStudy& study, Workshop& workshop,
                  const std::vector<std::array<double, 4>>& insets, const std::string& content);

}  // namespace covtrace::reproduce
