#include "shading/material_layers.h"

#include <algorithm>
#include <type_traits>

#include "bsdf/models.h"
#include "shading/material_inputs.h"

namespace covtrace {

namespace {

/// Values of the layers' textures at one place; `fallback` where the file gives none.
struct LayerTextures {
    const TextureStore& textures;
    const TexturePoint& at;
    float number(TextureId id, float fallback) const {
        return id < 0 ? fallback : textures.eval_float(id, at);
    }
    Rgb colour(TextureId id) const { return id < 0 ? Rgb(1) : textures.eval(id, at); }
};

SheenLobe make_sheen(const SheenLayer& layer, const LayerTextures& v, const SheenTable* table) {
    return {share(v.colour(layer.colour)),
            std::clamp(v.number(layer.alpha, 0), SheenTable::kLeastAlpha, 1.0f), table};
}

ClearcoatLobe make_coat(const ClearcoatLayer& layer, const LayerTextures& v,
                        const CoatTable* border) {
    const float alpha = v.number(layer.alpha, 0);
    return {clamp01(v.number(layer.weight, 1)),
            ggx_alphas(alpha, alpha, false).x,
            {0, 0, 1},
            border,
            share(v.colour(layer.tint))};
}

}  // namespace

bool has_layers(const MaterialDescription& m) {
    return (m.sheen || m.clearcoat) && !m.mix &&
           (std::holds_alternative<DiffuseMaterial>(m.value) ||
            std::holds_alternative<ConductorMaterial>(m.value) ||
            std::holds_alternative<DielectricMaterial>(m.value) ||
            std::holds_alternative<CoatedDiffuseMaterial>(m.value) ||
            std::holds_alternative<ThinDielectricMaterial>(m.value));
}

void put_under_layers(Bsdf& bsdf, const MaterialDescription& m, const TextureStore& textures,
                      const TexturePoint& at, const MaterialTables& tables) {
    if (!has_layers(m)) return;
    LayeredBsdf layered;
    std::visit(
        [&](const auto& b) {
            if constexpr (std::is_assignable_v<decltype(layered.base)&, std::decay_t<decltype(b)>>)
                layered.base = b;
        },
        bsdf);
    const LayerTextures values{textures, at};
    if (m.sheen) layered.sheen = make_sheen(*m.sheen, values, tables.sheen);
    if (m.clearcoat) layered.coat = make_coat(*m.clearcoat, values, tables.clearcoat);
    bsdf = layered;
}

Rgb emission_share(const MaterialDescription& m, const TextureStore& textures,
                   const TexturePoint& at, const MaterialTables& tables, float cosine) {
    const LayerTextures values{textures, at};
    return layer_transmission(
        m.sheen ? make_sheen(*m.sheen, values, tables.sheen) : SheenLobe{},
        m.clearcoat ? make_coat(*m.clearcoat, values, tables.clearcoat) : ClearcoatLobe{}, cosine);
}

}  // namespace covtrace
