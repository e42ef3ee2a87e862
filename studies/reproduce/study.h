/// A study of a scene: rendered by our methods, by variants of one of them down to the choices of
/// Belcour 2012, and by the plain path tracer at equal time and at equal error. Shared by the
/// experiments of a run.
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
    double radiance = 0;   ///< all samples, those of the covariance paths too
    double delivered = 0;  ///< of the radiance, what the covariance paths deliver
    double reconstruction = 0;
    double total = 0;
};

struct MethodStudy {
    std::string name, label;
    Sampled ours;
    Breakdown breakdown;
    Match equal_time, equal_error;  ///< the path tracer at equal time, and at equal error
};

/// A render with other choices than those of `covariance`, with the first seed, beside the path
/// tracer as the curve has it.
struct VariantStudy {
    std::string name;   ///< key in results.json
    std::string label;  ///< name in tables
    RenderOptions options;
    Timed timed;
    double error = 0, uniform_error_same_time = 0;
    double uniform_cpu_same_error = 0;  ///< infinite where the curve does not reach it
    Breakdown breakdown;
};

struct SceneStudy {
    std::string name;
    LoadedScene* scene = nullptr;          ///< the scene, owned by the workshop
    const Reference* reference = nullptr;  ///< the reference, owned by the workshop
    std::unique_ptr<UniformCurve> curve;
    std::vector<MethodStudy> methods;    ///< covariance, the same on demand, hybrid
    std::vector<VariantStudy> variants;  ///< from `covariance` towards Belcour 2012

    /// The variant of this name. Throws Error(internal) where there is none.
    const VariantStudy& variant(const std::string& name) const;
};

/// The numbers that Belcour 2012, section 5.1, used.
struct ThesisChoices {
    std::string scene;  ///< the generated scene that stands for that of Belcour 2012
    int cov_spp;        ///< covariance paths per pixel
    int cap;            ///< most samples of a pixel
    /// Most samples of a pixel in the render with the budget of `Settings::thesis_spp`; none where
    /// that budget is not known.
    std::optional<int> budget_cap;
};

/// The study of a scene, made once per workshop and scene.
SceneStudy& study(Workshop& workshop, const std::string& name, const ThesisChoices& choices);

/// The path tracer's seconds at the error of a variant, in words.
std::string time_of_same_error(const SceneStudy& study, const VariantStudy& variant);

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
