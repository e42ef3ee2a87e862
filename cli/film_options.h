/// Options that keep a render's film, and go on from one.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "render/shard.h"

namespace covtrace::cli {

struct FilmArguments {
    std::string film;             ///< where the final film goes; empty: nowhere
    std::string checkpoint;       ///< likewise, now and then
    std::optional<double> every;  ///< seconds between checkpoints
    std::optional<Shard> shard;
    bool resume = false;
};

/// Adds them to the command; `arguments` must outlive the parser.
void add_film_options(CLI::App* command, FilmArguments& arguments);

/// Throws Error(usage) for options that need others. Where `film` and `checkpoint` are two
/// spellings of one name they are the same afterwards.
void check(FilmArguments& arguments);

}  // namespace covtrace::cli
