// The program `covtrace`: parses the command line, runs a subcommand, turns errors into exit codes.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <iostream>
#include <system_error>

#include "cli/commands.h"
#include "cli/failure.h"
#include "cli/main_stack.h"
#include "cli/message.h"
#include "cli/other_names.h"
#include "core/error.h"
#include "render/version.h"
#include "scene/names.h"

namespace {

/// Opens standard streams that are closed: the next file to be opened would take their number, and
/// their messages.
void fill_standard_streams() {
    int descriptor = 0;
    while (descriptor >= 0 && descriptor <= STDERR_FILENO) descriptor = ::open("/dev/null", O_RDWR);
    if (descriptor >= 0) ::close(descriptor);
}

/// Throws Error(io) where text for standard output has not arrived.
void require_written_output() {
    if (std::fflush(stdout) != 0 || std::ferror(stdout) || !std::cout.flush())
        throw covtrace::Error(
            covtrace::ErrorKind::io,
            std::string("cannot write to standard output: ") + std::strerror(errno));
}

bool is_option(const std::string& argument) {
    return argument.size() > 1 && argument.front() == '-';
}

std::vector<std::string> names_of_commands(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* c : app.get_subcommands(nullptr)) names.push_back(c->get_name());
    return names;
}

/// Says that a word in the place of a command is none.
std::string explain_command(const CLI::App& app, const std::string& word) {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(word, ignored))
        return covtrace::path_in_quotes(word) +
               " is no command; 'covtrace render FILE' renders a scene";
    return "unknown command " + covtrace::in_quotes(word) +
           covtrace::did_you_mean(word, names_of_commands(app));
}

/// The reason why the command line is wrong; CLI11 itself does not name a command that it does not
/// know, and takes the value of an option that it does not know for the next argument.
std::string explain(const CLI::App& app, const CLI::ParseError& e) {
    using covtrace::did_you_mean, covtrace::in_quotes;
    const std::vector<std::string> before = app.remaining();  // the command
    if (!before.empty() && !is_option(before.front())) return explain_command(app, before.front());
    const std::vector<CLI::App*> commands = app.get_subcommands();
    const CLI::App& command = commands.empty() ? app : *commands.front();
    const std::vector<std::string> unknown = command.remaining();
    const auto option = std::find_if(unknown.begin(), unknown.end(), is_option);
    std::vector<std::string> known;
    if (option != unknown.end()) {
        for (const CLI::Option* o : command.get_options())
            for (const std::string& name : o->get_lnames()) known.push_back("--" + name);
        const auto other = covtrace::cli::known_by_another_name(*option, known);
        return "unknown option " + in_quotes(*option) +
               (other ? "; did you mean " + in_quotes(*other) + "?" : did_you_mean(*option, known));
    }
    return e.what();
}

/// The arguments, where `help COMMAND` is `COMMAND --help` and `help` alone is `--help`; the last
/// one comes first, as CLI11 takes them. A word that is no command stays, to be explained.
std::vector<std::string> arguments_reversed(const CLI::App& app, int argc, char** argv) {
    std::vector<std::string> all(argv + std::min(argc, 1), argv + argc);
    if (!all.empty() && all.front() == "help") {
        all.erase(all.begin());
        all.resize(std::min<size_t>(all.size(), 1));
        if (all == std::vector<std::string>{"help"}) all.clear();
        const std::vector<std::string> commands = names_of_commands(app);
        if (all.empty() || std::find(commands.begin(), commands.end(), all[0]) != commands.end())
            all.emplace_back("--help");
    }
    std::reverse(all.begin(), all.end());
    return all;
}

int run(int argc, char** argv) {
    covtrace::cli::Invocation invocation;
    invocation.start = std::chrono::steady_clock::now();
    for (int i = 0; i < argc; ++i) invocation.command_line += (i ? " " : "") + std::string(argv[i]);

    CLI::App app("A path tracer that predicts the samples and the filter of every pixel.",
                 "covtrace");
    app.set_version_flag("--version", "covtrace " + std::string(covtrace::kVersion) + " (" +
                                          std::string(covtrace::kCommit) + ")");
    app.require_subcommand(1);
    app.get_formatter()->column_width(31);
    // The last one of an option given twice holds, so that scripts and aliases can be added to.
    // Commands inherit this; lists take all (take_all).
    app.option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
    covtrace::cli::add_render(app, invocation);
    covtrace::cli::add_merge(app, invocation);
    covtrace::cli::add_denoise(app, invocation);
    covtrace::cli::add_compare(app, invocation);
    covtrace::cli::add_measure(app, invocation);
    covtrace::cli::add_inspect(app, invocation);
    covtrace::cli::add_info(app, invocation);
    covtrace::cli::add_reproduce(app, invocation);
    covtrace::cli::add_completion(app, invocation);
    // The footer comes after the commands, which would inherit it.
    app.footer(
        "Examples:\n"
        "  covtrace render scene.pbrt -o image.exr --png image.png --spp 32\n"
        "  covtrace compare image.exr reference.exr --report compare.html\n"
        "  covtrace inspect image.exr --pixel 120,45\n"
        "'covtrace COMMAND --help' tells a command's options, 'man covtrace' tells more.");
    try {
        app.parse(arguments_reversed(app, argc, argv));
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0) {
            app.exit(e);  // prints the help or the version
            require_written_output();
            return 0;
        }
        covtrace::cli::say("covtrace: {}\nRun 'covtrace --help' or 'covtrace COMMAND --help'.\n",
                           explain(app, e));
        return covtrace::cli::kUsageExitCode;
    }
    const int code = invocation.action();
    require_written_output();
    return code;
}

}  // namespace

int main(int argc, char** argv) {
    fill_standard_streams();
    // Signals are ignored so that a reader that went away and a file size limit are errors of the
    // write, reported and cleaned up after.
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
    try {
        return covtrace::cli::with_large_stack([&] { return run(argc, argv); });
    } catch (...) {
        return covtrace::cli::report_failure(std::current_exception());
    }
}
