/// Makes materials of the directives Material and MakeNamedMaterial.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "pbrt/build_context.h"

namespace covtrace {

class TextureBuilder;

/// A material that a shape names, by name or by the directive that made it.
struct MaterialReference {
    std::string name;  ///< empty: `index` counts
    size_t index = 0;  ///< index into the unnamed materials; 0 is the default material
    SourceLocation where;
};

/// Holds the declared materials until all of the file is read, since they may be used before they
/// are declared, then builds each one once.
class MaterialBuilder {
  public:
    /// Starts with unnamed material 0, pbrt's default, a diffuse grey.
    MaterialBuilder(BuildContext& context, TextureBuilder& textures);

    /// Declares a named material, whose type its parameter "type" says. Errors: Error(scene) where
    /// the name is taken or the type is missing.
    void declare_named(std::string name, Entity entity);
    size_t declare(Entity entity);
    /// Builds all materials that were declared, used or not; textures must be built. Errors:
    /// Error(scene).
    void build_all();
    /// The material of a reference. Errors: Error(scene) where no such material is defined.
    MaterialId find(const MaterialReference& reference);

  private:
    struct Declared {
        std::string name;
        Entity entity;
        MaterialId id = -1;
        bool in_progress = false;
    };
    MaterialId build(Declared& d);
    MaterialId build_mix(Declared& d);

    BuildContext& context_;
    TextureBuilder& textures_;
    std::vector<Declared> declared_;
    std::map<std::string, size_t> by_name_;
    std::vector<size_t> unnamed_;
    int depth_ = 0;
};

}  // namespace covtrace
