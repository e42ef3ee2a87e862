#include <filesystem>
#include <memory>

#include "cli/commands.h"
#include "cli/interrupts.h"
#include "cli/message.h"
#include "cli/options.h"
#include "core/parallel.h"
#include "reproduce/reproduce.h"

namespace covtrace::cli {

namespace {

namespace fs = std::filesystem;

struct ReproduceArguments {
    std::vector<std::string> names;
    std::string output, scenes;
    int threads = 0;
    bool quick = false, tiny = false, quiet = false;
};

int reproduce_results(const ReproduceArguments& a, const Invocation& invocation) {
    if (a.quick && a.tiny)
        throw Error(ErrorKind::usage, "--quick and --tiny: expected one of them");
    const ThreadLimit threads(a.threads);
    std::error_code error;
    fs::create_directories(a.output, error);
    if (!fs::is_directory(a.output, error))
        throw Error(ErrorKind::usage, "--output: cannot make the folder '" + a.output + "'");
    const auto size = a.tiny    ? reproduce::Size::tiny
                      : a.quick ? reproduce::Size::quick
                                : reproduce::Size::full;
    const InterruptGuard guard;
    reproduce::Workshop workshop(size, a.output, a.scenes, guard.flag(),
                                 [&a](const std::string& line) {
                                     if (!a.quiet) say("{}\n", line);
                                 });
    const reproduce::Outcome outcome =
        reproduce::reproduce(workshop, a.names, invocation.command_line);
    if (!a.quiet)
        say("{}: {} of {} claims hold\n", (workshop.output / "index.html").string(), outcome.held,
            outcome.claims);
    if (outcome.interrupted) return 6;
    if (outcome.failed > 0)
        throw Error(outcome.kind,
                    std::to_string(outcome.failed) +
                        " of the experiments could not be run: " + outcome.first_failure);
    return 0;
}

}  // namespace

void add_reproduce(CLI::App& app, Invocation& invocation) {
    auto a = std::make_shared<ReproduceArguments>();
    CLI::App* c = app.add_subcommand("reproduce", "Render the thesis' figures and table anew");
    c->add_option("NAME", a->names, "experiments (default: all)")->take_all()->option_text("...");
    c->add_option("-o,--output", a->output, "folder for index.html, results.json, figures/")
        ->required()
        ->option_text("DIR");
    c->add_flag("--quick", a->quick, "minutes, not hours: smaller, fewer seeds");
    c->add_flag("--tiny", a->tiny, "seconds: shows that it runs, no more");
    c->add_option("--scenes", a->scenes, "generated scenes (default: made in DIR/scenes)")
        ->check(CLI::ExistingDirectory.description(""))
        ->option_text("DIR");
    add_whole(c, "--threads", a->threads, 1, 4096, "worker threads (default: all cores)");
    c->add_flag("--quiet", a->quiet, "errors only");
    c->footer(
        "Experiments: pipeline slice sampling lens motion shininess snooker helicopter\n"
        "table voxels progressive.");
    c->callback([a, &invocation] {
        invocation.action = [a, &invocation] { return reproduce_results(*a, invocation); };
    });
}

}  // namespace covtrace::cli
