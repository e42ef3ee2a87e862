/// Private to this folder: which of the file's cameras, scenes and animations are read.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "gltf/document.h"
#include "scene/read_options.h"
#include "scene/scene_description.h"

namespace covtrace::gltf {

/// The names of something that can be chosen. `other` is a second name that it answers to.
struct Choosable {
    std::string name, other = {};
};

/// Text such as `2 "Side"`, or `2` where it has no name.
std::string text_of(size_t number, const Choosable& one);

/// The texts of all, "0 "Front", 1, 2 "Side"".
std::string listed(const std::vector<Choosable>& all);

/// The texts of all but one.
std::string listed_without(const std::vector<Choosable>& all, size_t one);

/// The number of the one that `choice` means: by its name, else by its other name, else by its
/// number from 0. Throws Error(usage), which lists all, for anything else and for names that
/// several have. `what`: "camera", for messages.
size_t chosen(OptionName option, const std::string& choice, const std::vector<Choosable>& all,
              const std::string& what);

/// A file's scene and animations that are read, by their indices.
struct Choice {
    int scene = -1;  ///< -1: all roots, as the file has no scenes
    std::vector<size_t> animations;
};

/// Chooses the scene and the animations: by default the document's own scene, or the first, and all
/// animations. Tells in `log` what else the file has, and in `scene` what is not the default.
/// Throws Error(usage) as `chosen`, Error(scene) where the document names a scene that it has not.
Choice choose(const Document& document, const ReadOptions& options, SceneDescription& scene,
              WarningLog& log);

}  // namespace covtrace::gltf
