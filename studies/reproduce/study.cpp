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
    b.delivered = delivered;
    b.reconstruction = phase(Phase::reconstruction);
    b.total = timed.cpu;
    return b;
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

/// The choices of Belcour 2012, section 5.1, with so many samples beside the covariance paths.
RenderOptions thesis_options(const Workshop& workshop, const ThesisChoices& choices, double spp,
                             int cap, FilterRule filter) {
    RenderOptions o;
    o.method = Method::covariance;
    o.spp = spp + choices.cov_spp;
    o.cov_spp = choices.cov_spp;
    o.max_spp = cap;
    o.density = DensityRule::thesis;
    o.filter = filter;
    o.occlusion = Occlusion::voxels;
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

void add_variant(Workshop& workshop, SceneStudy& s, const std::string& name,
                 const std::string& label, const RenderOptions& options) {
    workshop.tell(s.name + ": " + label);
    VariantStudy v{name, label, options, workshop.render(*s.scene, options), 0, 0, 0, {}};
    v.error = s.reference->error(v.timed.result.image);
    v.breakdown = breakdown_of(v.timed, s);
    v.uniform_error_same_time = interpolated_error(*s.curve, s.curve->spp_in(v.timed.cpu));
    v.uniform_cpu_same_error = s.curve->spp_for(v.error) * s.curve->cpu_per_spp();
    s.variants.push_back(std::move(v));
}

/// The filters of the text, printed and described, and ours, without what the samples say and with
/// it.
void add_variants(Workshop& workshop, SceneStudy& s, const ThesisChoices& choices) {
    RenderOptions alone;
    alone.method = Method::covariance;
    alone.spp = workshop.settings.spp;
    alone.density = DensityRule::tempered;
    alone.filter = FilterRule::predicted;
    alone.seed = workshop.settings.seeds.front();
    add_variant(workshop, s, "predicted", "covariance, predicted filters alone", alone);
    const auto add = [&](const std::string& name, const std::string& label, double spp, int cap,
                         FilterRule filter) {
        add_variant(workshop, s, name, fmt::format("thesis' choices, at most {}, {}", cap, label),
                    thesis_options(workshop, choices, spp, cap, filter));
    };
    const double spp = workshop.settings.spp;
    add("thesis_printed", "equation 5.7 as printed", spp, choices.cap, FilterRule::thesis);
    add("thesis_matched", "c = 1", spp, choices.cap, FilterRule::matched);
    add("thesis_predicted", "our predicted filters alone", spp, choices.cap, FilterRule::predicted);
    add("thesis_verified", "our filters", spp, choices.cap, FilterRule::verified);
    if (!choices.budget_cap) return;
    const double budget = workshop.settings.thesis_spp;
    const int cap = *choices.budget_cap;
    add("budget_matched", "c = 1, the thesis' budget", budget, cap, FilterRule::matched);
    add("budget_predicted", "our predicted filters alone, the thesis' budget", budget, cap,
        FilterRule::predicted);
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
        add_variants(workshop, s, choices);
        return s;
    });
}

const VariantStudy& SceneStudy::variant(const std::string& wanted) const {
    for (const VariantStudy& v : variants)
        if (v.name == wanted) return v;
    throw Error(ErrorKind::internal, "a study without the variant " + wanted);
}

std::string time_of_same_error(const SceneStudy& s, const VariantStudy& v) {
    return std::isfinite(v.uniform_cpu_same_error)
               ? fmt::format("{:.2f} s (from the rounds)", v.uniform_cpu_same_error)
               : fmt::format("more than {:.0f} samples", s.curve->points().back().spp);
}

Table comparison_table(const SceneStudy& s) {
    Table t;
    t.caption = fmt::format(
        "Trimmed relMSE and CPU seconds. The first three rows: means over the seeds, ratios the "
        "path tracer over ours, geometric mean over the seeds with the least and the most. The "
        "others: the first seed. From the rounds: on the path tracer's curve of the first seed, "
        "between its rounds or along its last two. The reference's own error is {:.5f}.",
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
    for (const VariantStudy& v : s.variants) {
        const bool reached = std::isfinite(v.uniform_cpu_same_error);
        t.rows.push_back(
            {v.label, fmt::format("{:.1f}", v.timed.result.statistics.samples_per_pixel),
             fmt::format("{:.2f}", v.timed.cpu), fmt::format("{:.5f}", v.error),
             fmt::format("{:.5f} (from the rounds)", v.uniform_error_same_time),
             fmt::format("{:.2f}", v.uniform_error_same_time / v.error), time_of_same_error(s, v),
             reached ? fmt::format("{:.2f}", v.uniform_cpu_same_error / v.timed.cpu) : ""});
        t.commands.push_back(v.timed.command);
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
                    {"delivered", b.delivered},
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
    for (const VariantStudy& v : s.variants)
        j["variants"][v.name] = {
            {"label", v.label},
            {"filter", name_of(v.options.filter)},
            {"k", optional_number(v.timed.result.statistics.density_factor)},
            {"cpu", v.timed.cpu},
            {"error", v.error},
            {"spp", v.timed.result.statistics.samples_per_pixel},
            {"uniform_error_same_time", v.uniform_error_same_time},
            {"uniform_cpu_same_error",
             std::isfinite(v.uniform_cpu_same_error) ? json(v.uniform_cpu_same_error) : json()},
            {"breakdown", parts(v.breakdown)}};
    return j;
}

}  // namespace covtrace::reproduce
