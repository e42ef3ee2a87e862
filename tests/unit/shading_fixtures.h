/// A scene of materials, for unit tests of the shading.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <variant>

#include "shading/material.h"

namespace covtrace {

/// A scene that holds textures and materials only.
class MaterialTest : public testing::Test {
  protected:
    TextureId constant(Rgb value) {
        return add_texture(
            {.name = "", .is_spectrum = true, .value = ConstantTexture{value}, .where = {}});
    }
    TextureId constant(float value) { return constant(Rgb(value)); }
    /// A texture that is `a` where floor(u) + floor(v) is even, `b` elsewhere.
    TextureId checks(TextureId a, TextureId b) {
        CheckerboardTexture t;
        t.tex1 = a;
        t.tex2 = b;
        return add_texture({.name = "", .is_spectrum = true, .value = t, .where = {}});
    }
    template <typename M>
    MaterialId add(const M& material) {
        scene_.materials.push_back({.name = "", .value = material, .where = {}});
        return static_cast<MaterialId>(scene_.materials.size()) - 1;
    }
    /// Builds the stores; to be called when everything is added.
    void build() {
        textures_ = std::make_unique<TextureStore>(scene_);
        materials_ = std::make_unique<MaterialStore>(scene_, *textures_);
    }
    template <typename B>
    B bsdf_at(MaterialId id, Vec2 uv = {0.5f, 0.5f}) const {
        SurfaceHit hit;
        hit.uv = uv;
        const Bsdf bsdf = materials_->bsdf(id, hit, *textures_);
        EXPECT_TRUE(std::holds_alternative<B>(bsdf));
        return std::get<B>(bsdf);
    }

    SceneDescription scene_;
    std::unique_ptr<TextureStore> textures_;
    std::unique_ptr<MaterialStore> materials_;

  private:
    TextureId add_texture(TextureDescription t) {
        scene_.textures.push_back(std::move(t));
        return static_cast<TextureId>(scene_.textures.size()) - 1;
    }
};

}  // namespace covtrace
