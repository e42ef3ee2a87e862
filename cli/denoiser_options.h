/// The options that choose a denoiser, and the warnings about it.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "denoiser/find_denoiser.h"
#include "image/image.h"

namespace covtrace::cli {

struct DenoiserArguments {
    std::optional<DenoiserChoice> choice;  ///< empty: automatic
    std::string library;                   ///< file of the library; empty: looked for
    std::optional<DenoiserQuality> quality;
};

/// Adds the options to a command; `arguments` must outlive the parser.
void add_denoiser_options(CLI::App* command, DenoiserArguments& arguments);

/// Finds the denoiser that the options ask for, also in the folders that belong to the program's
/// own. Throws Error(usage) where it was asked for and cannot be used.
FoundDenoiser find(const DenoiserArguments& arguments);

/// Warns of a denoiser that was found and cannot be used.
void warn_of_unusable(const FoundDenoiser& found);
/// Whether the image is a denoiser's of fast quality.
bool is_denoised_fast(const Image& image);
/// Warns of a denoiser that failed while the image was made.
void warn_of_failed_denoiser(const Image& image);

}  // namespace covtrace::cli
