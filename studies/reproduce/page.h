/// The page of results: all sections as one HTML page and one JSON file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reproduce/section.h"

namespace covtrace::reproduce {

struct PageFacts {
    std::string command;                                     ///< command that made the page
    std::string size;                                        ///< name of the size, such as "quick"
    std::vector<std::pair<std::string, std::string>> facts;  ///< version, processor, seconds …
    bool complete = false;                                   ///< false: more sections are to come
};

/// Writes the page, one file without scripts that needs no other file and no network; any text is
/// safe. Throws Error(io).
void write_page(const std::vector<Section>& sections, const PageFacts& facts,
                const std::filesystem::path& file);

/// Writes the page's numbers: object "experiments", by name, each with its "claims", "tables" and
/// "data". Throws Error(io).
void write_results(const std::vector<Section>& sections, const PageFacts& facts,
                   const std::filesystem::path& file);

/// Writes figures/NAME.png and figures/NAME.svg below `folder`. Throws Error(io).
void write_figures(const Section& section, const std::filesystem::path& folder);

}  // namespace covtrace::reproduce
