#include "gltf/instancing.h"

#include <optional>

#include "gltf/accessor.h"
#include "gltf/animation.h"

namespace covtrace::gltf {
namespace {

constexpr const char* kName = "EXT_mesh_gpu_instancing";

/// Numbers of the budget that a copy costs, so that nodes which share a list of copies cannot make
/// many of a small file.
constexpr size_t kNumbersOfACopy = 64;

/// Replaces a part of each pose by the values of an attribute, where the extension has it.
template <size_t n>
void read_attribute(const Document& document, const tinygltf::Value& attributes, const char* name,
                    const std::string& place, std::optional<std::vector<Pose>>& poses,
                    std::array<double, n> Pose::*part) {
    if (!attributes.Has(name)) return;
    const std::string here = place + "." + name;
    if (!attributes.Get(name).IsNumber())
        document.refuse(here, "expected the index of an accessor");
    const Numbers numbers = read_numbers(document, attributes.Get(name).GetNumberAsInt(), n, here);
    if (!document.numbers.spend(numbers.count(), kNumbersOfACopy))
        throw Error(ErrorKind::limit, document.place(here),
                    "the copies of meshes are too many for a file of " +
                        std::to_string(document.bytes) + " bytes");
    if (!poses) poses.emplace(numbers.count());
    if (poses->size() != numbers.count())
        document.refuse(here, "has " + std::to_string(numbers.count()) + " elements; expected " +
                                  std::to_string(poses->size()) + " as its other attributes");
    for (size_t k = 0; k < numbers.count(); ++k)
        for (size_t i = 0; i < n; ++i) ((*poses)[k].*part)[i] = double(numbers.element(k)[i]);
}

}  // namespace

std::vector<Matrix4> instance_matrices(const Document& document, size_t index) {
    const tinygltf::Node& node = document.model.nodes[index];
    const auto extension = node.extensions.find(kName);
    if (node.mesh < 0 || extension == node.extensions.end()) return {Matrix4{}};
    const std::string place = element("nodes", index) + ".extensions." + kName + ".attributes";
    const tinygltf::Value& attributes = extension->second.Get("attributes");
    std::optional<std::vector<Pose>> poses;
    read_attribute(document, attributes, "TRANSLATION", place, poses, &Pose::translation);
    read_attribute(document, attributes, "ROTATION", place, poses, &Pose::rotation);
    read_attribute(document, attributes, "SCALE", place, poses, &Pose::scale);
    if (!poses) return {Matrix4{}};
    std::vector<Matrix4> matrices;
    for (const Pose& pose : *poses) matrices.push_back(matrix_of(pose));
    return matrices;
}

}  // namespace covtrace::gltf
