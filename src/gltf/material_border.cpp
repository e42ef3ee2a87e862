/// Reflectance of a material's border: its index, KHR_materials_specular,
/// KHR_materials_pbrSpecularGlossiness, and KHR_materials_anisotropy.
#include <algorithm>
#include <cmath>
#include <limits>

#include "gltf/material_builder.h"

namespace covtrace::gltf {
namespace {

using Channel = ImageTexture::Channel;

/// Refractive index that stands for all larger ones: its border reflects 99.6 % at the normal, and
/// what is below it keeps more than rounding errors of the rest.
constexpr float kLargestIndex = 1000;
/// Amplitude that the border of that index reflects at the normal.
constexpr float kLargestRoot = (kLargestIndex - 1) / (kLargestIndex + 1);

float reflectance_of(float eta) {
    const float root = (eta - 1) / (eta + 1);
    return root * root;
}

}  // namespace

void MaterialBuilder::read_index() {
    const auto* e = extension(material_.extensions, "KHR_materials_ior");
    if (!e) return;
    const std::string place = in("KHR_materials_ior");
    constexpr double kLargest = std::numeric_limits<double>::max();
    double ior = number(document_, *e, "ior", 1.5, 0, kLargest, place);
    if (ior > 0) ior = nearest(document_, ior, 1, kLargest, place + ".ior", log_);
    // An ior of 0 stands for a border that reflects everything, as it does in the limit of large
    // ones.
    border_.eta =
        ior > 0 ? static_cast<float>(std::min(ior, double(kLargestIndex))) : kLargestIndex;
    border_.mean_eta = border_.eta;
}

void MaterialBuilder::read_specular() {
    const auto* e = extension(material_.extensions, "KHR_materials_specular");
    if (!e) return;
    const std::string place = in("KHR_materials_specular");
    const auto factor = share(*e, "specularFactor", 1, place);
    const Rgb tint = rgb(numbers<3>(document_, *e, "specularColorFactor", {1, 1, 1}, 0, place));
    const auto weight = use(texture_info(document_, *e, "specularTexture", place));
    const auto colour = use(texture_info(document_, *e, "specularColorTexture", place));
    const float mean = factor * (tint.r + tint.g + tint.b) / 3;
    const float root = std::min(std::sqrt(reflectance_of(border_.eta) * mean), kLargestRoot);
    border_.mean_eta = (1 + root) / (1 - root);
    if (border_.eta == 1) return;  // there is no border that could be tinted
    if (factor != 1 || weight.index >= 0)
        border_.weight =
            textures_.channel(weight, Channel::alpha, factor, place + ".specularTexture");
    if (tint != Rgb(1) || colour.index >= 0)
        border_.normal_reflectance = textures_.colour(colour, reflectance_of(border_.eta) * tint,
                                                      place + ".specularColorTexture");
}

const tinygltf::Value* MaterialBuilder::specular_glossiness() const {
    return extension(material_.extensions, kSpecularGlossiness);
}

void MaterialBuilder::read_specular_glossiness() {
    const tinygltf::Value& e = *specular_glossiness();
    const std::string place = in(kSpecularGlossiness);
    const auto specular = numbers<3>(document_, e, "specularFactor", {1, 1, 1}, 0, place);
    const auto glossiness = share(e, "glossinessFactor", 1, place);
    const auto texture = use(texture_info(document_, e, "specularGlossinessTexture", place));
    const std::string here = place + ".specularGlossinessTexture";
    border_.normal_reflectance = textures_.colour(texture, rgb(specular), here);
    border_.dims_base = true;
    const TextureId roughness =
        textures_.inverted_channel(texture, Channel::alpha, glossiness, here);
    widths_.u = widths_.v = textures_.product(roughness, roughness, false);
}

void MaterialBuilder::read_anisotropy() {
    const auto* e = extension(material_.extensions, "KHR_materials_anisotropy");
    if (!e) return;
    const std::string place = in("KHR_materials_anisotropy");
    const auto strength = share(*e, "anisotropyStrength", 0, place);
    if (strength == 0) return;
    const auto texture = use(texture_info(document_, *e, "anisotropyTexture", place));
    const std::string here = place + ".anisotropyTexture";
    tangent_rotation_ = static_cast<float>(std::remainder(
        number(document_, *e, "anisotropyRotation", 0, -kAny, kAny, place), 2 * M_PI));
    tangent_direction_ = textures_.linear(texture, here);
    // The width across stays, the one along grows to 1 with the square of the strength.
    const TextureId share = textures_.channel(texture, Channel::blue, strength, here);
    widths_.u =
        textures_.mixture(widths_.v, textures_.constant(1), textures_.product(share, share, false));
}

}  // namespace covtrace::gltf
