#include <fmt/format.h>

#include <cmath>

#include "reproduce/experiment.h"
#include "reproduce/study.h"
#include "reproduce/thesis.h"

namespace covtrace::reproduce {

namespace {

std::string seconds(double s) {
    return fmt::format("{:.2f}", s);
}

std::string share(double part, const Breakdown& b) {
    return fmt::format("{} ({:.1f} %)", seconds(part), 100 * part / b.total);
}

/// A row: `same_error` and `ratio` are those of the table of the experiment.
std::vector<std::string> row(const std::string& scene, const std::string& label, const Breakdown& b,
                             const std::string& same_error, const std::string& ratio) {
    return {scene,
            label,
            share(b.analysis, b),
            share(b.analysis + b.delivered, b),
            seconds(b.radiance),
            share(b.reconstruction, b),
            seconds(b.total),
            same_error,
            ratio};
}

std::vector<std::string> method_row(const std::string& scene, const MethodStudy& m) {
    if (!m.equal_error.found) return row(scene, m.label, m.breakdown, "not reached", "");
    const Sampled& same_error = m.equal_error.uniform;
    return row(scene, m.label, m.breakdown, seconds(same_error.mean_cpu()) + " s",
               fmt::format("{:.2f}", ratios(same_error.cpu, m.ours.cpu).mean));
}

std::vector<std::string> variant_row(const std::string& scene, const SceneStudy& study,
                                     const VariantStudy& v) {
    return row(scene, v.label, v.breakdown, time_of_same_error(study, v),
               std::isfinite(v.uniform_cpu_same_error)
                   ? fmt::format("{:.2f}", v.uniform_cpu_same_error / v.timed.cpu)
                   : "");
}

}  // namespace

Section table(Workshop& workshop) {
    Section s;
    s.name = "table";
    s.title = "table 5.1: where the time goes";
    s.thesis =
        "Table 5.1 of the thesis. Snooker: covariance 2 min 36 s, reconstruction 16 s, in all 25 "
        "min; "
        "the path tracer 2 h 25 min, 5.8 times as long. Helicopter: covariance 2 min, "
        "reconstruction "
        "16 s, in all 29 min; no time at equal quality is given.";
    Table t;
    t.caption =
        "CPU seconds of the first seed, the scene being loaded; the path tracer's time and the "
        "ratio are those of the comparisons of snooker and helicopter. Analysis: what the "
        "covariance paths cost beyond the radiance that they deliver, the occluders, the "
        "spectra and the plan of the counts; with its paths' radiance, which the thesis counts to "
        "it: that too; radiance: all samples, those of the covariance paths among them.";
    t.columns = {"scene",    "method",         "analysis", "with its paths' radiance",
                 "radiance", "reconstruction", "total",    "path tracer, same error",
                 "ratio"};
    t.rows = {{"snooker", "thesis", "", "156 (10.4 %)", "1328 and the paths'", "16 (1.1 %)", "1500",
               "8700 s", "5.8"},
              {"helicopter", "thesis", "", "120 (6.9 %)", "1604 and the paths'", "16 (0.9 %)",
               "1740", "not given", ""}};
    for (const auto& [name, choices] :
         {std::pair{"snooker", kSnookerChoices}, std::pair{"helicopter", kHelicopterChoices}}) {
        const SceneStudy& study = covtrace::reproduce::study(workshop, name, choices);
        for (const MethodStudy& m : study.methods) {
            t.rows.push_back(method_row(name, m));
            t.commands.push_back(m.ours.first.command + " --stats FILE.json");
            if (m.equal_error.found) t.commands.push_back(m.equal_error.uniform.first.command);
        }
        for (const VariantStudy& v : study.variants) {
            t.rows.push_back(variant_row(name, study, v));
            t.commands.push_back(v.timed.command + " --stats FILE.json");
        }
        s.notes.push_back(fmt::format(
            "{}: not in these times are {:.2f} s to load the scene, on both sides. {:.2f} s of the "
            "analysis are for spectra of textures and environment, whatever the image's size.",
            name, study.scene->load_cpu, study.methods.front().breakdown.spectra));
        s.data[name] = to_json(study);
        s.counts = study_counts(workshop);
        s.resolution = study.scene->resolution;
    }
    s.tables.push_back(std::move(t));
    s.notes.push_back(
        "The thesis' seconds are of a Xeon W3520 (2.66 GHz) and of other scenes: only the shares "
        "and "
        "the ratio can be compared.");
    return s;
}

}  // namespace covtrace::reproduce
