/// Options that keep a render's film, and go on from one.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "render/film_files.h"

namespace covtrace::cli {

/// Adds the options to a command; `choice` must outlive the parser.
void add_film_options(CLI::App* command, FilmChoice& choice);

/// Throws Error(usage) for options that need others. Where `film` and `checkpoint` are two
/// spellings of one name they are the same afterwards.
void check(FilmChoice& choice);

}  // namespace covtrace::cli
