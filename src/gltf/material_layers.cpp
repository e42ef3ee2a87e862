/// Layers over a material: KHR_materials_iridescence, KHR_materials_sheen and
/// KHR_materials_clearcoat.
#include "gltf/material_builder.h"

namespace covtrace::gltf {
namespace {

using Channel = ImageTexture::Channel;

}  // namespace

void MaterialBuilder::read_iridescence() {
    const auto* e = extension(material_.extensions, "KHR_materials_iridescence");
    if (!e) return;
    const std::string place = in("KHR_materials_iridescence");
    const auto factor = share(*e, "iridescenceFactor", 0, place);
    if (factor == 0) return;
    ThinFilmDescription film;
    film.eta = static_cast<float>(number(document_, *e, "iridescenceIor", 1.3, 1, 1e3, place));
    film.weight = textures_.channel(use(texture_info(document_, *e, "iridescenceTexture", place)),
                                    Channel::red, factor, place + ".iridescenceTexture");
    const auto thickness = [&](const char* key, double otherwise) {
        return textures_.constant(
            static_cast<float>(number(document_, *e, key, otherwise, 0, kAny, place)));
    };
    const TextureId most = thickness("iridescenceThicknessMaximum", 400);
    const auto texture = use(texture_info(document_, *e, "iridescenceThicknessTexture", place));
    film.thickness =
        texture.index < 0
            ? most
            : textures_.mixture(thickness("iridescenceThicknessMinimum", 100), most,
                                textures_.channel(texture, Channel::green, 1,
                                                  place + ".iridescenceThicknessTexture"));
    film_ = film;
}

void MaterialBuilder::read_sheen() {
    const auto* e = extension(material_.extensions, "KHR_materials_sheen");
    if (!e) return;
    const std::string place = in("KHR_materials_sheen");
    const Rgb colour = rgb(numbers<3>(document_, *e, "sheenColorFactor", {0, 0, 0}, 0, place));
    if (is_black(colour)) return;
    const auto roughness = share(*e, "sheenRoughnessFactor", 0, place);
    sheen_ =
        SheenLayer{textures_.colour(use(texture_info(document_, *e, "sheenColorTexture", place)),
                                    colour, place + ".sheenColorTexture"),
                   squared(use(texture_info(document_, *e, "sheenRoughnessTexture", place)),
                           Channel::alpha, roughness, place + ".sheenRoughnessTexture")};
}

void MaterialBuilder::read_clearcoat() {
    const auto* e = extension(material_.extensions, "KHR_materials_clearcoat");
    if (!e) return;
    const std::string place = in("KHR_materials_clearcoat");
    const auto factor = share(*e, "clearcoatFactor", 0, place);
    if (factor == 0) return;
    const auto roughness = share(*e, "clearcoatRoughnessFactor", 0, place);
    ClearcoatLayer coat;
    coat.weight = textures_.channel(use(texture_info(document_, *e, "clearcoatTexture", place)),
                                    Channel::red, factor, place + ".clearcoatTexture");
    coat.alpha = squared(use(texture_info(document_, *e, "clearcoatRoughnessTexture", place)),
                         Channel::green, roughness, place + ".clearcoatRoughnessTexture");
    const auto normal = texture_info(document_, *e, kClearcoatNormal, place);
    if (normal.index >= 0) {
        const std::string here = place + "." + kClearcoatNormal;
        coat.normal_map = textures_.linear(use(normal), here);
        coat.normal_scale = static_cast<float>(
            number(document_, e->Get(kClearcoatNormal), "scale", 1, -kAny, kAny, here));
    }
    clearcoat_ = coat;
}

}  // namespace covtrace::gltf
