// The program `covtrace`: parses the command line, runs a subcommand, turns errors into exit codes.
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <new>

#include "cli/commands.h"
#include "core/error.h"
#include "render/version.h"

namespace {

int exit_code(covtrace::ErrorKind kind) {
    using enum covtrace::ErrorKind;
    switch (kind) {
        case usage: return 2;
        case scene: return 3;
        case limit: return 4;
        case io: return 5;
        case interrupted: return 6;
        case internal: return 7;
    }
    return 7;
}

int run(int argc, char** argv) {
    covtrace::cli::Invocation invocation;
    invocation.start = std::chrono::steady_clock::now();
    for (int i = 0; i < argc; ++i) invocation.command_line += (i ? " " : "") + std::string(argv[i]);

    CLI::App app("covtrace: a path tracer that predicts how many samples and which filter every pixel needs.");
    app.set_version_flag("--version", "covtrace " + std::string(covtrace::kVersion) + " (" +
                                          std::string(covtrace::kCommit) + ")");
    app.require_subcommand(1);
    app.get_formatter()->column_width(34);
    covtrace::cli::add_render(app, invocation);
    covtrace::cli::add_compare(app, invocation);
    covtrace::cli::add_info(app, invocation);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0) return app.exit(e);
        fmt::print(stderr, "covtrace: {}\nRun 'covtrace --help' or 'covtrace COMMAND --help'.\n", e.what());
        return exit_code(covtrace::ErrorKind::usage);
    }
    return invocation.action();
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const covtrace::Error& e) {
        fmt::print(stderr, "covtrace: {}\n", e.what());
        return exit_code(e.kind());
    } catch (const std::bad_alloc&) {
        fmt::print(stderr, "covtrace: not enough memory\n");
        return exit_code(covtrace::ErrorKind::limit);
    } catch (const std::exception& e) {
        fmt::print(stderr, "covtrace: internal error: {}\n", e.what());
        return exit_code(covtrace::ErrorKind::internal);
    }
}
