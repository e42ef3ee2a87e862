/// The options that all readers of scene files share.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <vector>

namespace covtrace {

struct ReadOptions {
    /// Folders to look in for files that are not where the scene says.
    std::vector<std::filesystem::path> search_paths;
    /// Seconds at which the shutter opens and closes, for formats whose animations have a time
    /// line; pbrt's transforms say for themselves when they hold.
    std::optional<std::array<float, 2>> shutter = {};
};

}  // namespace covtrace
