/// The subcommands of the program. Each adds itself to the parser and leaves its action to be run.
#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <functional>
#include <string>

namespace covtrace::cli {

/// The chosen command; it returns the exit code (docs/reference/exit-codes.md).
using Action = std::function<int()>;

struct Invocation {
    /// Start of the process, from which --time counts.
    std::chrono::steady_clock::time_point start;
    std::string command_line;  ///< the whole command line, for the image's metadata
    Action action;
};

void add_render(CLI::App& app, Invocation& invocation);
void add_merge(CLI::App& app, Invocation& invocation);
void add_denoise(CLI::App& app, Invocation& invocation);
void add_compare(CLI::App& app, Invocation& invocation);
void add_measure(CLI::App& app, Invocation& invocation);
void add_inspect(CLI::App& app, Invocation& invocation);
void add_info(CLI::App& app, Invocation& invocation);
void add_reproduce(CLI::App& app, Invocation& invocation);
void add_completion(CLI::App& app, Invocation& invocation);

}  // namespace covtrace::cli
