// Outlines of cartoons: dark shells, inside out, around what they outline.
#include "gltf_fixtures.h"

namespace covtrace::test {
namespace {

const std::vector<float> kCorners = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0,
                                     0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1};

/// The triangles of a box, their fronts outside.
std::vector<uint16_t> box_triangles() {
    const std::vector<std::array<uint16_t, 4>> sides = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                                        {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    std::vector<uint16_t> indices;
    for (const auto& s : sides) indices.insert(indices.end(), {s[0], s[1], s[2], s[0], s[2], s[3]});
    return indices;
}

std::vector<uint16_t> inside_out(std::vector<uint16_t> indices) {
    for (size_t i = 0; i < indices.size(); i += 3) std::swap(indices[i], indices[i + 1]);
    return indices;
}

/// A file with one mesh of these triangles and this material.
GltfFile shell(const std::vector<uint16_t>& indices, const json& material) {
    GltfFile file;
    const int positions = file.add_floats(kCorners, "VEC3", 3);
    const int corners = file.add<uint16_t>(indices, 5123, "SCALAR", 1);
    file.root["materials"] = json::array({material});
    file.root["meshes"] = {
        {{"primitives",
          {{{"attributes", {{"POSITION", positions}}}, {"indices", corners}, {"material", 0}}}}}};
    file.add_node({{"mesh", 0}});
    return file;
}

json coloured(double grey) {
    return {{"pbrMetallicRoughness", {{"baseColorFactor", {grey, grey, grey, 1}}}}};
}

bool is_outline(const GltfFile& file) {
    const SceneDescription scene = read(file);
    const MaterialId material = scene.shapes.at(0).material;
    const bool is_unlit = std::holds_alternative<UnlitMaterial>(
        scene.materials.at(static_cast<size_t>(material)).value);
    EXPECT_EQ(is_unlit, contains(all_warnings(scene), "is an outline"));
    return is_unlit;
}

TEST(GltfOutlines, AreDarkShellsThatAreInsideOut) {
    const std::vector<uint16_t> box = box_triangles(), shell_of_box = inside_out(box);
    EXPECT_TRUE(is_outline(shell(shell_of_box, coloured(0.01))));
    EXPECT_FALSE(is_outline(shell(box, coloured(0.01))));
    EXPECT_FALSE(is_outline(shell(shell_of_box, coloured(0.5)))) << "a room seen from outside";
    EXPECT_FALSE(is_outline(shell(shell_of_box, json::object()))) << "white by default";
    json both = coloured(0.01);
    both["doubleSided"] = true;
    EXPECT_FALSE(is_outline(shell(shell_of_box, both)));
    json shining = coloured(0.01);
    shining["emissiveFactor"] = {0, 1, 0};
    EXPECT_FALSE(is_outline(shell(shell_of_box, shining)));
    json blended = coloured(0.01);
    blended["alphaMode"] = "BLEND";
    EXPECT_FALSE(is_outline(shell(shell_of_box, blended)));
}

TEST(GltfOutlines, MayLackALittleAndNotMuch) {
    std::vector<uint16_t> open = inside_out(box_triangles());
    open.resize(open.size() - 6);
    EXPECT_TRUE(is_outline(shell(open, coloured(0.01)))) << "the side that it stands on";
    open.erase(open.begin(), open.begin() + 6);
    EXPECT_FALSE(is_outline(shell(open, coloured(0.01)))) << "two sides of six that meet";
    // A card of two squares back to back encloses nothing, whichever way it is turned.
    const std::vector<uint16_t> card = {0, 1, 3, 0, 3, 2, 0, 3, 1, 0, 2, 3};
    EXPECT_FALSE(is_outline(shell(card, coloured(0.01))));
    EXPECT_FALSE(is_outline(shell(inside_out(card), coloured(0.01))));
}

TEST(GltfOutlines, AreNoSheetsThatFaceEachOther) {
    // Two squares apart, as the underside of a seat and the top of what is below: they have no area
    // in the mean and a negative volume, and enclose little.
    const std::vector<uint16_t> box = inside_out(box_triangles());
    const std::vector<uint16_t> sheets(box.begin(), box.begin() + 12);
    EXPECT_FALSE(is_outline(shell(sheets, coloured(0.01))));
}

TEST(GltfOutlines, AreOutlinesOnMirroredNodes) {
    GltfFile file = shell(inside_out(box_triangles()), coloured(0.01));
    file.root["nodes"][0]["scale"] = {-1, 1, 1};
    EXPECT_TRUE(is_outline(file)) << "mirroring turns the fronts along";
}

}  // namespace
}  // namespace covtrace::test
