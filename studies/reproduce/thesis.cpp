#include "reproduce/thesis.h"

#include <fmt/format.h>

#include <cmath>

namespace covtrace::reproduce {

namespace {

/// A demand that is made of the full size, in words.
std::string at_full_size(const std::string& demand, const Workshop& workshop) {
    return workshop.size == Size::full ? demand : demand + " at the full size";
}

std::string at_least(double least, const Workshop& workshop) {
    return at_full_size(fmt::format("at least {:g}", least), workshop);
}

}  // namespace

std::string study_counts(const Workshop& workshop) {
    return fmt::format(
        "our three methods at {:g} samples a pixel and the path tracer beside them with the seeds "
        "{}, the other rows and the parts of times with the first; reference of 2 x {:g}",
        workshop.settings.spp, text_of(workshop.settings.seeds), workshop.settings.reference_spp);
}

void add_equal_error_claims(Section& section, const SceneStudy& study,
                            const std::map<std::string, double>& least, const std::string& thesis,
                            const Workshop& workshop) {
    for (const MethodStudy& m : study.methods) {
        const auto required = least.find(m.name);
        if (required == least.end()) continue;
        Claim c;
        c.name = study.name + "_equal_error_" + m.name;
        c.statement = fmt::format("{}: the path tracer's time over that of {}, at equal error",
                                  study.name, m.name);
        c.thesis = thesis;
        c.required = at_least(required->second, workshop);
        c.command = reproduce_command(workshop, study.name);
        const bool is_measured = m.ours.mean_error() > 0;
        const std::string error = fmt::format("; error {:.5f}", m.ours.mean_error());
        if (m.equal_error.found) {
            const Spread r = ratios(m.equal_error.uniform.cpu, m.ours.cpu);
            c.value = r.mean;
            c.found = r.text() + " times" + error +
                      fmt::format("; errors equal within {:.1f} %",
                                  100 * std::abs(m.equal_error.mismatch));
        } else {
            c.value = 0;
            c.found =
                is_measured
                    ? fmt::format("more than {:g} samples are not enough for the path tracer{}",
                                  workshop.settings.most_spp, error)
                    : "not to be told: its error is below the noise of the reference";
        }
        if (workshop.size == Size::full && is_measured)
            c.holds = !m.equal_error.found || c.value >= required->second;
        section.claims.push_back(std::move(c));
    }
}

void add_printed_ratio_claim(Section& section, const SceneStudy& study, const Workshop& workshop) {
    constexpr double kPrinted = 5.8;
    const VariantStudy& v = study.variant("budget_matched");
    const double ratio = v.uniform_cpu_same_error / v.timed.cpu;
    Claim c;
    c.name = study.name + "_thesis_choices";
    c.statement = fmt::format(
        "{}: the path tracer's time over that of the thesis' choices with c = 1 and its budget, at "
        "equal error",
        study.name);
    c.thesis = "5.8 times (2 h 25 min over 25 min)";
    c.required = fmt::format("at least {:g}, as printed", kPrinted);
    c.found = std::isfinite(ratio)
                  ? fmt::format("{:.2f} times; error {:.5f}, of which more samples take nothing",
                                ratio, v.error)
                  : fmt::format("{}; error {:.5f}", time_of_same_error(study, v), v.error);
    c.value = std::isfinite(ratio) ? ratio : 0;
    if (workshop.size != Size::tiny) c.holds = !std::isfinite(ratio) || ratio >= kPrinted;
    c.command = v.timed.command;
    section.claims.push_back(std::move(c));
}

void add_equal_time_claims(Section& section, const SceneStudy& study,
                           const std::map<std::string, double>& least, const Workshop& workshop) {
    for (const MethodStudy& m : study.methods) {
        const auto required = least.find(m.name);
        if (required == least.end()) continue;
        const Spread r = ratios(m.equal_time.uniform.error, m.ours.error);
        Claim c;
        c.name = study.name + "_equal_time_" + m.name;
        c.statement = fmt::format("{}: the path tracer's error over that of {}, in equal time",
                                  study.name, m.name);
        c.thesis = "shown, without figures";
        c.required = at_least(required->second, workshop);
        c.command = reproduce_command(workshop, study.name);
        c.value = r.mean;
        c.found =
            r.text() + " times" +
            fmt::format("; times equal within {:.1f} %", 100 * std::abs(m.equal_time.mismatch));
        if (workshop.size == Size::full) c.holds = r.mean >= required->second;
        section.claims.push_back(std::move(c));
    }
}

void add_share_claims(Section& section, const SceneStudy& study, const Workshop& workshop) {
    const auto share = [](double part, const Breakdown& b) { return 100 * part / b.total; };
    for (const MethodStudy& m : study.methods) {
        if (m.name != "covariance") continue;
        const double analysis = share(m.breakdown.analysis, m.breakdown);
        const double reconstruction = share(m.breakdown.reconstruction, m.breakdown);
        const VariantStudy& thesis = study.variant("thesis_matched");
        std::string thesis_paths =
            fmt::format("; with the thesis' {:g} paths and its grid {:.1f} % of {:.0f} samples",
                        *thesis.options.cov_spp, share(thesis.breakdown.analysis, thesis.breakdown),
                        thesis.timed.result.statistics.samples_per_pixel);
        for (const VariantStudy& v : study.variants)
            if (v.name == "budget_matched")
                thesis_paths += fmt::format(
                    ", {:.1f} % of {:.0f}; with the radiance of these paths {:.1f} and {:.1f} %",
                    share(v.breakdown.analysis, v.breakdown),
                    v.timed.result.statistics.samples_per_pixel,
                    share(thesis.breakdown.analysis + thesis.breakdown.delivered, thesis.breakdown),
                    share(v.breakdown.analysis + v.breakdown.delivered, v.breakdown));
        // Spectra of textures take the same time at any size, and the reconstruction the same at
        // any number of samples: of a small image with few samples they are more.
        const auto verdict = [&](bool holds) {
            return workshop.size == Size::full ? std::optional(holds) : std::nullopt;
        };
        section.claims.push_back(
            {study.name + "_analysis_share",
             "analysis (recording, replay, occluders, plan; beyond the radiance "
             "that its paths deliver) of "
             "the total",
             "10 % (2 min 36 s of 25 min, its paths' radiance included)",
             at_full_size("at most 15 % with the default number of paths", workshop),
             fmt::format("{:.1f} %{}", analysis, thesis_paths), analysis, verdict(analysis <= 15),
             m.ours.first.command + " --stats FILE.json"});
        section.claims.push_back(
            {study.name + "_reconstruction_share", "reconstruction of the total",
             "1.1 % (16 s of 25 min)",
             at_full_size("at most 2 %, where 4 and 5 % were measured by hand and are expected",
                          workshop),
             fmt::format("{:.2f} %", reconstruction), reconstruction, verdict(reconstruction <= 2),
             m.ours.first.command + " --stats FILE.json"});
    }
}

}  // namespace covtrace::reproduce
