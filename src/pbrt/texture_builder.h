/// Makes textures of Texture directives and of values given inline.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "pbrt/build_context.h"
#include "pbrt/current_transform.h"

namespace covtrace {

/// Holds the declared textures until all of the file is read, since they may be used before they
/// are declared, then builds each one once.
class TextureBuilder {
  public:
    explicit TextureBuilder(BuildContext& context) : context_(context) {}

    /// Declares a texture. Errors: Error(scene) where the name is taken.
    void declare(std::string name, bool is_spectrum, Entity entity,
                 const CurrentTransform& texture_to_world);
    /// Builds all textures that were declared, used or not. Errors: Error(scene).
    void build_all();

    TextureId constant(Rgb value, bool is_spectrum);
    /// The texture of a spectrum parameter (texture, rgb, spectrum, blackbody); `otherwise` where
    /// it is missing. Reflectances above 1 are cut to 1 with a warning.
    TextureId reflectance(ParameterList& p, std::string_view name, Rgb otherwise);
    /// The texture of a spectrum parameter as `reflectance` makes it, but without a limit.
    TextureId unbounded(ParameterList& p, std::string_view name, Rgb otherwise);
    /// The texture of a reflectance; -1 where the parameter is missing.
    TextureId reflectance_or_none(ParameterList& p, std::string_view name);
    /// The texture of a float parameter (texture, float).
    TextureId grey(ParameterList& p, std::string_view name, float otherwise);
    TextureId grey_or_none(ParameterList& p, std::string_view name);
    /// The texture of a roughness, as `grey_or_none` makes it. Values below 0 are cut to 0 with a
    /// warning.
    TextureId roughness_or_none(ParameterList& p, std::string_view name);
    TextureId roughness(ParameterList& p, std::string_view name, float otherwise);
    TextureId grey_of(const Parameter& p);
    /// The spectrum texture that a parameter names.
    TextureId coloured(const Parameter& p) { return named(p, true); }
    /// A value that stands for the whole texture where a single one is needed.
    Rgb mean(TextureId id);

  private:
    Rgb mean_of_parts(size_t texture) const;
    struct Declared {
        std::string name;
        bool is_spectrum = true;
        Entity entity;
        CurrentTransform texture_to_world;
        TextureId id = -1;
        bool in_progress = false;
    };

    TextureId named(const Parameter& p, bool is_spectrum);
    /// The texture of a name that a parameter gives, in quotes, at a place.
    TextureId named(const std::string& name, std::string_view parameter,
                    const SourceLocation& where, bool is_spectrum);
    TextureId build(Declared& d);
    TextureId spectrum_or_none(ParameterList& p, std::string_view name, bool is_reflectance);
    TextureId part(Declared& d, std::string_view name, float otherwise);
    /// The value of a bilerp texture at one of its corners.
    Rgb corner(Declared& d, std::string_view name, float otherwise);
    CheckerboardTexture checkerboard(Declared& d);
    MixTexture direction_mix(Declared& d);
    FacingTexture facing(Declared& d);
    TextureId stand_in(Declared& d);
    TextureId add(Declared& d, decltype(TextureDescription::value) value);
    std::vector<std::string> names(bool is_spectrum) const;

    BuildContext& context_;
    std::vector<Declared> declared_;
    std::map<std::pair<bool, std::string>, size_t> by_name_;
    std::map<std::tuple<bool, float, float, float>, TextureId> constants_;
    int depth_ = 0;
    std::vector<Rgb> means_;  ///< means of the scene's first textures
};

}  // namespace covtrace
