/// Private to this folder: which of the file's cameras, scenes, animations and variants are read.
#pragma once

#include <cstddef>
#include <optional>
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

/// A file's scene, animations and variant of materials that are read, by their indices.
struct Choice {
    int scene = -1;  ///< -1: all roots, as the file has no scenes
    std::vector<size_t> animations;
    std::optional<size_t> variant;  ///< none: the primitives' own materials
};

/// Chooses scene, animations and variant: by default the document's own scene, or the first, all
/// animations, and no variant. Tells in `log` what else the file has, and in `scene` what is not
/// the default. Throws Error(usage) as `chosen`, Error(scene) where the document names a scene that
/// it has not.
Choice choose(const Document& document, const ReadOptions& options, SceneDescription& scene,
              WarningLog& log);

/// Index of a primitive's material in a variant; its own one where no mapping names the variant.
/// Refuses mappings that are none.
int material_of(const Document& document, const tinygltf::Primitive& primitive,
                const std::optional<size_t>& variant, const std::string& place);

}  // namespace covtrace::gltf
