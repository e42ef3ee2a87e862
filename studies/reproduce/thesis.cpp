#include "reproduce/thesis.h"

#include <fmt/format.h>

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
        std::string thesis_paths;
        if (!study.thesis.empty())
            thesis_paths =
                fmt::format("; with the thesis' {} paths and its grid {:.1f} %",
                            study.thesis[0].timed.result.statistics.covariance.samples /
                                uint64_t(study.scene->resolution[0] * study.scene->resolution[1]),
                            share(study.thesis[0].breakdown.analysis, study.thesis[0].breakdown));
        // Spectra of textures take the same time at any size, and the reconstruction the same at
        // any number of samples: of a small image with few samples they are more.
        const auto verdict = [&](bool holds) {
            return workshop.size == Size::full ? std::optional(holds) : std::nullopt;
        };
        section.claims.push_back(
            {study.name + "_analysis_share",
             "analysis (recording, replay, occluders; beyond the radiance "
             "that its paths deliver) of "
             "the total",
             "10 % (2 min 36 s of 25 min, its paths' radiance included)",
             at_full_size("at most 15 % with the default number of paths", workshop),
             fmt::format("{:.1f} %{}", analysis, thesis_paths), analysis, verdict(analysis <= 15),
             m.ours.first.command + " --stats FILE.json"});
        section.claims.push_back(
            {study.name + "_reconstruction_share", "reconstruction of the total",
             "1.1 % (16 s of 25 min)", at_full_size("at most 2 %", workshop),
             fmt::format("{:.2f} %", reconstruction), reconstruction, verdict(reconstruction <= 2),
             m.ours.first.command + " --stats FILE.json"});
    }
}

}  // namespace covtrace::reproduce
