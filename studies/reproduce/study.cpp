#include "reproduce/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace covtrace::reproduce {

namespace {

Breakdown breakdown_of(const Timed& timed, const SceneStudy& study) {
    const auto& seconds = timed.result.statistics.seconds;
    // Phases are measured by the clock; their shares of the render's CPU time are taken alike.
    const double rate = timed.cpu / timed.wall;
    const auto phase = [&](Phase which) {
        const auto found = seconds.find(which);
        return found == seconds.end() ? 0.0 : rate * found->second;
    };
    const double pixels = double(study.scene->resolution[0]) * study.scene->resolution[1];
    const double delivered =
        study.curve->cpu_per_spp() / pixels * double(timed.result.statistics.covariance.samples);
    Breakdown b;
    b.spectra = phase(Phase::spectra);
    b.analysis = phase(Phase::covariance) - delivered + phase(Phase::grid) +
                 phase(Phase::outlines) + b.spectra + phase(Phase::plan);
    b.radiance = phase(Phase::radiance) + delivered;
    b.reconstruction = phase(Phase::reconstruction);
    b.total = timed.cpu;
    return b;
}

/// The filters that are compared: Belcour 2012, section 5.1, prints one and describes another; the
/// last is ours.
constexpr std::array kFilters{FilterRule::thesis, FilterRule::matched, FilterRule::verified};

std::string label_of(FilterRule filter) {
    return filter == FilterRule::thesis    ? "equation 5.7 as printed"
           : filter == FilterRule::matched ? "matched filter, c = 1"
                                           : "verified filter";
}

/// A method of ours under its name, and whether samples go where earlier ones left noise.
struct MethodChoice {
    const char* name;
    Method method;
    bool progressive;
};
constexpr std::array kMethods{MethodChoice{"covariance", Method::covariance, false},
                              MethodChoice{"covariance on demand", Method::covariance, true},
                              MethodChoice{"hybrid", Method::hybrid, false}};

RenderOptions thesis_options(const Workshop& workshop, const ThesisChoices& choices, int cap,
                             FilterRule filter) {
    RenderOptions o;
    o.method = Method::covariance;
    o.spp = workshop.settings.spp + choices.cov_spp;
    o.cov_spp = choices.cov_spp;
    o.max_spp = cap;
    o.density = DensityRule::thesis;
    o.filter = filter;
    o.occlusion = Occlusion::grid;
    o.brdf_covariance = BrdfCovariance::global;
    o.seed = workshop.settings.seeds.front();
    return o;
}

double interpolated_error(const UniformCurve& curve, double spp) {
    const auto& points = curve.points();
    for (size_t i = 1; i < points.size(); ++i) {
        if (points[i].spp < spp && i + 1 < points.size()) continue;
        const auto &a = points[i - 1], &b = points[i];
        const double t = std::log(spp / a.spp) / std::log(b.spp / a.spp);
        return a.error * std::pow(std::max(b.error, 1e-9) / a.error, t);
    }
    return points.back().error;
}

ThesisStudy thesis_study(Workshop& workshop, const SceneStudy& s, const ThesisChoices& choices,
                         int cap, FilterRule filter) {
    ThesisStudy t;
    t.label = fmt::format("thesis' choices, at most {}, {}", cap, label_of(filter));
    workshop.tell(s.name + ": " + t.label);
    t.cap = cap;
    t.filter = filter;
    t.timed = workshop.render(*s.scene, thesis_options(workshop, choices, cap, filter));
    t.error = s.reference->error(t.timed.result.image);
    t.breakdown = breakdown_of(t.timed, s);
    t.uniform_error_same_time = interpolated_error(*s.curve, s.curve->spp_in(t.timed.cpu));
    t.uniform_cpu_same_error = s.curve->spp_for(t.error) * s.curve->cpu_per_spp();
    return t;
}

}  // namespace

SceneStudy& study(Workshop& workshop, const std::string& name, const ThesisChoices& choices) {
    return workshop.shared<SceneStudy>("study " + name, [&] {
        SceneStudy s;
        s.name = name;
        s.scene = &shared_scene(workshop, choices.scene);
        s.reference = &shared_reference(workshop, choices.scene);
        for (const auto& [label, method, progressive] : kMethods) {
            MethodStudy m;
            m.name = m.label = label;
            workshop.tell(fmt::format("{}: {}", name, m.name));
            RenderOptions options;
            options.method = method;
            options.progressive = progressive;
            options.spp = workshop.settings.spp;
            m.ours = sample(workshop, *s.scene, *s.reference, options);
            s.methods.push_back(std::move(m));
        }
        double least_error = s.methods[0].ours.mean_error();
        for (const MethodStudy& m : s.methods)
            least_error = std::min(least_error, m.ours.mean_error());
        s.curve = std::make_unique<UniformCurve>(workshop, *s.scene, *s.reference,
                                                 workshop.settings.thesis_uniform_spp, least_error,
                                                 workshop.settings.most_spp);
        for (MethodStudy& m : s.methods) {
            workshop.tell(
                fmt::format("{}: the path tracer at the time and the error of {}", name, m.name));
            m.breakdown = breakdown_of(m.ours.first, s);
            m.equal_time =
                match_time(workshop, *s.scene, *s.reference, *s.curve, m.ours.mean_cpu());
            m.equal_error =
                match_error(workshop, *s.scene, *s.reference, *s.curve, m.ours.mean_error());
        }
        for (const int cap : choices.caps)
            for (const FilterRule filter : kFilters)
                s.thesis.push_back(thesis_study(workshop, s, choices, cap, filter));
        return s;
    });
}

Table comparison_table(const SceneStudy& s) {
    Table t;
    t.caption = fmt::format(
        "Trimmed relMSE and CPU seconds (means over the seeds; ratios are the path tracer over "
        "ours, "
        "geometric mean with the least and the most). The reference's own error is {:.5f}.",
        s.reference->own_error());
    t.columns = {"method",
                 "samples per pixel",
                 "seconds",
                 "error",
                 "path tracer, same time",
                 "ratio of errors",
                 "path tracer, same error",
                 "ratio of times"};
    for (const MethodStudy& m : s.methods) {
        const Sampled& same_time = m.equal_time.uniform;
        std::vector<std::string> row{
            m.label,
            fmt::format("{:.1f}", m.ours.mean_spp()),
            fmt::format("{:.2f}", m.ours.mean_cpu()),
            fmt::format("{:.5f}", m.ours.mean_error()),
            fmt::format("{:.5f} ({:.1f} samples, {:.2f} s)", same_time.mean_error(),
                        m.equal_time.spp, same_time.mean_cpu()),
            ratios(same_time.error, m.ours.error).text()};
        if (m.equal_error.found) {
            const Sampled& same_error = m.equal_error.uniform;
            row.push_back(fmt::format("{:.2f} s ({:.1f} samples, error {:.5f})",
                                      same_error.mean_cpu(), m.equal_error.spp,
                                      same_error.mean_error()));
            row.push_back(ratios(same_error.cpu, m.ours.cpu).text());
        } else {
            row.insert(row.end(), {"not reached", ""});
        }
        t.rows.push_back(std::move(row));
        t.commands.push_back(m.ours.first.command);
        t.commands.push_back(same_time.first.command);
        if (m.equal_error.found) t.commands.push_back(m.equal_error.uniform.first.command);
    }
    for (const ThesisStudy& c : s.thesis) {
        const bool reached = std::isfinite(c.uniform_cpu_same_error);
        t.rows.push_back(
            {c.label, fmt::format("{:.1f}", c.timed.result.statistics.samples_per_pixel),
             fmt::format("{:.2f}", c.timed.cpu), fmt::format("{:.5f}", c.error),
             fmt::format("{:.5f} (from the rounds)", c.uniform_error_same_time),
             fmt::format("{:.2f}", c.uniform_error_same_time / c.error),
             reached ? fmt::format("{:.2f} s (from the rounds)", c.uniform_cpu_same_error)
                     : "not reached",
             reached ? fmt::format("{:.2f}", c.uniform_cpu_same_error / c.timed.cpu) : ""});
        t.commands.push_back(c.timed.command);
    }
    return t;
}

nlohmann::json to_json(const SceneStudy& s) {
    using nlohmann::json;
    const auto optional_number = [](const std::optional<double>& v) {
        return v ? json(*v) : json();
    };
    const auto sampled = [](const Sampled& v) {
        return json{{"error", v.error}, {"cpu", v.cpu}, {"spp", v.spp}};
    };
    const auto parts = [](const Breakdown& b) {
        return json{{"analysis", b.analysis},
                    {"spectra", b.spectra},
                    {"radiance", b.radiance},
                    {"reconstruction", b.reconstruction},
                    {"total", b.total}};
    };
    json j = {{"reference_error", s.reference->own_error()},
              {"load_cpu", s.scene->load_cpu},
              {"uniform_cpu_per_spp", s.curve->cpu_per_spp()}};
    for (const UniformCurve::Point& p : s.curve->points())
        j["uniform"].push_back({{"spp", p.spp}, {"cpu", p.cpu}, {"error", p.error}});
    for (const MethodStudy& m : s.methods) {
        json& o = j["methods"][m.name];
        o = {{"ours", sampled(m.ours)},
             {"breakdown", parts(m.breakdown)},
             {"equal_time", sampled(m.equal_time.uniform)},
             {"equal_time_mismatch", m.equal_time.mismatch}};
        if (m.equal_error.found) {
            o["equal_error"] = sampled(m.equal_error.uniform);
            o["equal_error_mismatch"] = m.equal_error.mismatch;
        }
    }
    for (const ThesisStudy& t : s.thesis)
        j["thesis"].push_back({{"label", t.label},
                               {"cap", t.cap},
                               {"filter", name_of(t.filter)},
                               {"k", optional_number(t.timed.result.statistics.density_factor)},
                               {"cpu", t.timed.cpu},
                               {"error", t.error},
                               {"spp", t.timed.result.statistics.samples_per_pixel},
                               {"breakdown", parts(t.breakdown)}});
    return j;
}

}  // namespace covtrace::reproduce
