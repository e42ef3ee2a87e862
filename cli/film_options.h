/// Options that keep a render's film, and go on from one.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "render/shard.h"

namespace covtrace::cli {

struct FilmArguments {
    std::string film;             ///< file of the final film; empty: none
    std::string checkpoint;       ///< file of the film that is kept now and then; empty: none
    std::optional<double> every;  ///< seconds between checkpoints
    std::optional<Shard> shard;
    bool resume = false;
};

/// Adds the options to a command; `arguments` must outlive the parser.
void add_film_options(CLI::App* command, FilmArguments& arguments);

/// Throws Error(usage) for options that need others. Where `film` and `checkpoint` are two
/// spellings of one name they are the same afterwards.
void check(FilmArguments& arguments);

}  // namespace covtrace::cli
