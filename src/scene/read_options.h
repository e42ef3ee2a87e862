/// The options that all readers of scene files share.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace covtrace {

struct ReadOptions {
    /// Folders to look in for files that are not where the scene says.
    std::vector<std::filesystem::path> search_paths;
    /// Seconds at which the shutter opens and closes, for formats whose animations have a time
    /// line; pbrt's transforms say for themselves when they hold.
    std::optional<std::array<float, 2>> shutter = {};
    /// One of a glTF file's cameras, scenes, animations and variants: its name or, where none is
    /// called so, its number from 0; empty: the reader's own choice. Other readers refuse them.
    std::string camera = {}, gltf_scene = {};
    std::string animation = {};  ///< "none" and "all", too
    std::string variant = {};    ///< of the materials, KHR_materials_variants
    /// Whether the shutter is that of a frame of an animation. Formats whose files are one frame
    /// each refuse it.
    bool is_frame = false;
};

}  // namespace covtrace
