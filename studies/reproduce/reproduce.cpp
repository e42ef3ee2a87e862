#include "reproduce/reproduce.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <thread>

#include "render/version.h"
#include "reproduce/page.h"

namespace covtrace::reproduce {

namespace {

struct Experiment {
    std::string name;
    std::string source;  ///< figure, table or section of Belcour 2012
    Section (*run)(Workshop&);
};

const std::array<Experiment, 11> kExperiments{{{"pipeline", "figure 5.1, equation 5.7", pipeline},
                                               {"slice", "figures before 5.6", slice},
                                               {"sampling", "figures before 5.6", sampling},
                                               {"lens", "figure 5.6", lens},
                                               {"motion", "figure 5.7", motion},
                                               {"shininess", "figure 5.8", shininess},
                                               {"snooker", "figures 5.9 and 5.10", snooker},
                                               {"helicopter", "figure 5.11", helicopter},
                                               {"table", "table 5.1", table},
                                               {"voxels", "figure 5.12", voxels},
                                               {"progressive", "section 5.1.3", progressive}}};

std::vector<const Experiment*> chosen(const std::vector<std::string>& names) {
    std::string known;
    for (const Experiment& e : kExperiments) known += (known.empty() ? "" : ", ") + e.name;
    for (const std::string& name : names)
        if (std::none_of(kExperiments.begin(), kExperiments.end(),
                         [&](const Experiment& e) { return e.name == name; }))
            throw Error(ErrorKind::usage, "reproduce: there is no experiment '" + name +
                                              "'; expected some of " + known);
    std::vector<const Experiment*> list;
    for (const Experiment& e : kExperiments)
        if (names.empty() || std::find(names.begin(), names.end(), e.name) != names.end())
            list.push_back(&e);
    return list;
}

PageFacts facts_of(const Workshop& workshop, const std::string& command, double wall,
                   bool complete) {
    PageFacts f;
    f.command = command;
    f.size = name_of(workshop.size);
    f.complete = complete;
    f.facts = {
        {"program", fmt::format("covtrace {} ({})", std::string(kVersion), std::string(kCommit))},
        {"processor threads", std::to_string(std::thread::hardware_concurrency())},
        {"seeds", text_of(workshop.settings.seeds)},
        {"seconds so far", fmt::format("{:.0f}, CPU {:.0f}", wall, workshop.cpu())},
        {"times",
         "CPU seconds (user and system) of the render, the scene being loaded, on both "
         "sides; ours has the analysis of the textures in it"},
        {"errors",
         "relMSE without the worst 0.1 % of the pixels, mean over both halves of our own "
         "reference of the plain path tracer, less the noise of one half"}};
    return f;
}

}  // namespace

Outcome reproduce(Workshop& workshop, const std::vector<std::string>& names,
                  const std::string& command) {
    const std::vector<const Experiment*> list = chosen(names);
    Monitor clock;
    Outcome outcome;
    std::vector<Section> sections;
    const auto write = [&](bool complete) {
        const PageFacts facts = facts_of(workshop, command, clock.elapsed(), complete);
        write_page(sections, facts, workshop.output / "index.html");
        write_results(sections, facts, workshop.output / "results.json");
    };
    for (const Experiment* e : list) {
        workshop.tell(fmt::format("{} ({})", e->name, e->source));
        const double cpu = workshop.cpu(), wall = clock.elapsed();
        Section section;
        try {
            section = e->run(workshop);
        } catch (const Error& error) {
            if (error.kind() == ErrorKind::interrupted) {
                outcome.interrupted = true;
                break;
            }
            if (error.kind() == ErrorKind::io || error.kind() == ErrorKind::internal) throw;
            section.name = e->name;
            section.title = e->name;
            section.failure = error.what();
            if (outcome.failed++ == 0) {
                outcome.first_failure = error.what();
                outcome.kind = error.kind();
            }
        }
        section.cpu = workshop.cpu() - cpu;
        section.wall = clock.elapsed() - wall;
        for (const Claim& c : section.claims) {
            outcome.claims += c.holds.has_value();
            outcome.held += c.holds.value_or(false);
        }
        write_figures(section, workshop.output);
        sections.push_back(std::move(section));
        write(e == list.back());
    }
    if (sections.empty()) write(false);
    return outcome;
}

}  // namespace covtrace::reproduce
