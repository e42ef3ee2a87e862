#include "gltf/choice.h"

#include <algorithm>
#include <charconv>
#include <numeric>

#include "scene/names.h"

namespace covtrace::gltf {
namespace {

/// The numbers of those that have this name.
std::vector<size_t> named(const std::vector<Choosable>& all, const std::string& name,
                          std::string Choosable::*which) {
    std::vector<size_t> found;
    for (size_t i = 0; i < all.size(); ++i)
        if (all[i].*which == name) found.push_back(i);
    return found;
}

std::optional<size_t> number_in(const std::string& text) {
    size_t number = 0;
    const char* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, number);
    return error == std::errc() && rest == end ? std::optional(number) : std::nullopt;
}

std::vector<Choosable> scenes_of(const Document& document) {
    std::vector<Choosable> all;
    for (const tinygltf::Scene& scene : document.model.scenes) all.push_back({scene.name});
    return all;
}

int choose_scene(const Document& document, const ReadOptions& options, SceneDescription& scene,
                 WarningLog& log) {
    const std::vector<Choosable> all = scenes_of(document);
    if (options.gltf_scene.empty() && all.empty()) return -1;
    const int own = std::max(0, document.model.defaultScene);
    if (options.gltf_scene.empty()) {
        at(document, document.model.scenes, own, "scenes", "scene");
        if (all.size() > 1)
            log.add(document.place("scenes"),
                    "one of " + std::to_string(all.size()) + " scenes is read, " +
                        text_of(size_t(own), all[size_t(own)]) + "; the others are " +
                        listed_without(all, size_t(own)));
        return own;
    }
    const size_t one = chosen({"gltf_scene"}, options.gltf_scene, all, "scene");
    if (int(one) != own) scene.gltf_scene_choice = text_of(one, all[one]);
    return int(one);
}

std::vector<size_t> choose_animations(const Document& document, const ReadOptions& options,
                                      SceneDescription& scene, WarningLog& log) {
    std::vector<Choosable> all;
    for (const tinygltf::Animation& a : document.model.animations) all.push_back({a.name});
    const std::string& choice = options.animation;
    if (choice == "all") {
        std::vector<size_t> every(all.size());
        std::iota(every.begin(), every.end(), size_t{0});
        if (all.size() > 1) scene.animation_choice = choice;
        return every;
    }
    // Viewers play the first one: files hold takes that exclude each other, a walk beside a jump.
    constexpr size_t kOwn = 0;
    if (choice.empty()) {
        if (all.empty()) return {};
        if (all.size() > 1)
            log.add(document.place("animations"),
                    "the first of " + std::to_string(all.size()) + " animations is played, " +
                        text_of(kOwn, all[kOwn]) + "; the others are " + listed_without(all, kOwn));
        return {kOwn};
    }
    if (choice == "none") {
        if (!all.empty()) scene.animation_choice = choice;
        return {};
    }
    const size_t one = chosen({"animation"}, choice, all, "animation");
    if (one != kOwn) scene.animation_choice = text_of(one, all[one]);
    return {one};
}

constexpr const char* kVariants = "KHR_materials_variants";

/// An array of an extension's object. Refuses anything else under the key.
const tinygltf::Value& array_in(const Document& document, const tinygltf::Value& object,
                                const char* key, const std::string& place) {
    const tinygltf::Value& found = object.Get(key);
    if (!found.IsArray()) document.refuse(place + "." + key, "expected an array");
    return found;
}

std::vector<Choosable> variants_of(const Document& document) {
    const tinygltf::Value* e = extension(document.model.extensions, kVariants);
    if (!e) return {};
    const std::string place = std::string("extensions.") + kVariants;
    const tinygltf::Value& list = array_in(document, *e, "variants", place);
    std::vector<Choosable> all;
    for (size_t i = 0; i < list.ArrayLen(); ++i) {
        const tinygltf::Value& one = list.Get(i);
        const bool is_named = one.IsObject() && one.Get("name").IsString();
        all.push_back({is_named ? one.Get("name").Get<std::string>() : ""});
    }
    return all;
}

std::optional<size_t> choose_variant(const Document& document, const ReadOptions& options,
                                     SceneDescription& scene, WarningLog& log) {
    const std::vector<Choosable> all = variants_of(document);
    if (options.variant.empty()) {
        if (!all.empty())
            log.add(document.place(std::string("extensions.") + kVariants),
                    "the primitives' own materials are rendered; the file has the variants " +
                        listed(all));
        return {};
    }
    const size_t one = chosen({"variant"}, options.variant, all, "variant");
    scene.variant_choice = text_of(one, all[one]);
    return one;
}

}  // namespace

std::string text_of(size_t index, const Choosable& one) {
    const std::string& name = one.name.empty() ? one.other : one.name;
    return std::to_string(index) + (name.empty() ? "" : " " + in_quotes(name));
}

std::string listed(const std::vector<Choosable>& all) {
    return listed_without(all, all.size());
}

std::string listed_without(const std::vector<Choosable>& all, size_t one) {
    std::vector<std::string> texts;
    for (size_t i = 0; i < all.size(); ++i)
        if (i != one) texts.push_back(text_of(i, all[i]));
    return covtrace::listed(texts);
}

size_t chosen(OptionName option, const std::string& choice, const std::vector<Choosable>& all,
              const std::string& what) {
    for (const auto which : {&Choosable::name, &Choosable::other}) {
        const std::vector<size_t> found = named(all, choice, which);
        if (found.size() == 1) return found[0];
        if (found.empty()) continue;
        std::vector<std::string> numbers;
        for (const size_t i : found) numbers.push_back(std::to_string(i));
        throw Error(ErrorKind::usage, option,
                    in_quotes(choice) + " is the name of several, " + covtrace::listed(numbers) +
                        "; expected one of these numbers");
    }
    const auto number = number_in(choice);
    if (number && *number < all.size()) return *number;
    std::vector<std::string> names;
    for (const Choosable& one : all)
        for (const std::string* name : {&one.name, &one.other})
            if (!name->empty()) names.push_back(*name);
    // A number alone would be read as how many there are.
    const char* unnamed = !names.empty() || all.empty() ? ""
                          : all.size() == 1             ? "number "
                                                        : "numbers ";
    throw Error(ErrorKind::usage, option,
                "there is no " + what + " " + in_quotes(choice) + "; the file has " + unnamed +
                    (all.empty() ? "none" : listed(all)) +
                    (number ? "" : did_you_mean(choice, names)));
}

Choice choose(const Document& document, const ReadOptions& options, SceneDescription& scene,
              WarningLog& log) {
    return {choose_scene(document, options, scene, log),
            choose_animations(document, options, scene, log),
            choose_variant(document, options, scene, log)};
}

int material_of(const Document& document, const tinygltf::Primitive& primitive,
                const std::optional<size_t>& variant, const std::string& place) {
    const tinygltf::Value* e = extension(primitive.extensions, kVariants);
    if (!variant || !e) return primitive.material;
    const std::string here = place + ".extensions." + kVariants;
    const tinygltf::Value& mappings = array_in(document, *e, "mappings", here);
    for (size_t i = 0; i < mappings.ArrayLen(); ++i) {
        const tinygltf::Value& mapping = mappings.Get(i);
        const std::string there = here + "." + element("mappings", i);
        if (!mapping.IsObject()) document.refuse(there, "expected an object");
        const tinygltf::Value& variants = array_in(document, mapping, "variants", there);
        for (size_t k = 0; k < variants.ArrayLen(); ++k)
            if (variants.Get(k).IsNumber() &&
                variants.Get(k).GetNumberAsDouble() == static_cast<double>(*variant))
                return static_cast<int>(
                    number(document, mapping, "material", primitive.material, -1, 1 << 30, there));
    }
    return primitive.material;
}

}  // namespace covtrace::gltf
