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

std::vector<std::string> row(const std::string& scene, const std::string& label, const Breakdown& b,
                             double same_error) {
    return {
        scene,
        label,
        fmt::format("{} ({:.1f} %)", seconds(b.analysis), 100 * b.analysis / b.total),
        seconds(b.radiance),
        fmt::format("{} ({:.1f} %)", seconds(b.reconstruction), 100 * b.reconstruction / b.total),
        seconds(b.total),
        std::isfinite(same_error) && same_error > 0 ? seconds(same_error) : "not reached",
        std::isfinite(same_error) && same_error > 0 ? fmt::format("{:.2f}", same_error / b.total)
                                                    : ""};
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
        "CPU seconds, the scene being loaded. Analysis: what the covariance paths cost beyond the "
        "radiance that they deliver, the occluders and the spectra; radiance: all samples.";
    t.columns = {"scene",
                 "method",
                 "analysis",
                 "radiance",
                 "reconstruction",
                 "total",
                 "path tracer, same error",
                 "ratio"};
    t.rows = {
        {"snooker", "thesis", "156 (10.4 %)", "1328", "16 (1.1 %)", "1500", "8700", "5.8"},
        {"helicopter", "thesis", "120 (6.9 %)", "1604", "16 (0.9 %)", "1740", "not given", ""}};
    for (const auto& [name, choices] :
         {std::pair{"snooker", kSnookerChoices}, std::pair{"helicopter", kHelicopterChoices}}) {
        const SceneStudy& study = covtrace::reproduce::study(workshop, name, choices);
        for (const MethodStudy& m : study.methods) {
            t.rows.push_back(
                row(name, m.label, m.breakdown,
                    m.equal_error.found ? m.equal_error.uniform.mean_cpu() : INFINITY));
            t.commands.push_back(m.ours.first.command + " --stats FILE.json");
            if (m.equal_error.found) t.commands.push_back(m.equal_error.uniform.first.command);
        }
        for (const ThesisStudy& c : study.thesis) {
            t.rows.push_back(row(name, c.label, c.breakdown, c.uniform_cpu_same_error));
            t.commands.push_back(c.timed.command + " --stats FILE.json");
        }
        s.notes.push_back(fmt::format(
            "{}: not in these times are {:.2f} s to load the scene, on both sides. {:.2f} s of the "
            "analysis are for spectra of textures and environment, whatever the image's size.",
            name, study.scene->load_cpu, study.methods.front().breakdown.spectra));
        s.data[name] = to_json(study);
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
