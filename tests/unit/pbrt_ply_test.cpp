#include "pbrt/ply_reader.h"

#include <bit>
#include <cstring>

#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

constexpr const char* kVertex = "property float x\nproperty float y\nproperty float z\n";

std::string header(const std::string& format, int vertices, const std::string& vertex, int faces,
                   const std::string& face = "property list uchar int vertex_indices\n") {
    return "ply\nformat " + format + " 1.0\ncomment made by hand\nelement vertex " +
           std::to_string(vertices) + "\n" + vertex + "element face " + std::to_string(faces) +
           "\n" + face + "end_header\n";
}

template <typename T>
std::string bytes(T value, bool big_endian) {
    std::string raw(sizeof(T), '\0');
    std::memcpy(raw.data(), &value, sizeof(T));
    if (big_endian == (std::endian::native == std::endian::little))
        std::reverse(raw.begin(), raw.end());
    return raw;
}

PlyMesh read(const std::string& text, WarningLog* log = nullptr) {
    WarningLog none;
    return read_ply(text, "m.ply", log ? *log : none);
}
std::string error_of(const std::string& text) {
    const Failure f = failure_of([&] { read(text); });
    EXPECT_EQ(f.kind, ErrorKind::scene);
    return f.message;
}

TEST(ScenePly, ReadsAsciiWithNormalsAndUv) {
    const auto mesh = read(
        header("ascii", 3,
               std::string(kVertex) + "property float nx\nproperty float ny\nproperty float nz\n"
                                      "property double u\nproperty uchar red\nproperty double v\n",
               1) +
        "0 0 0 0 0 1 .1 255 .2\n1 0 0 0 0 1 .3 0 .4\r\n0 +1 0 0 0 1 .5 7 .6\n3 0 1 2");
    const TriangleMesh& m = *mesh.triangles;
    EXPECT_EQ(m.positions[2], (Vec3{0, 1, 0}));
    EXPECT_EQ(m.normals[1], (Vec3{0, 0, 1}));
    EXPECT_EQ(m.uvs[2], (Vec2{0.5f, 0.6f}));
    EXPECT_EQ(m.triangles.size(), 1u);
    EXPECT_EQ(mesh.quads, nullptr);
}

TEST(ScenePly, TrianglesMayHaveTangents) {
    const auto mesh = read(
        header("ascii", 3,
               std::string(kVertex) + "property float sx\nproperty float sy\nproperty float sz\n",
               1) +
        "0 0 0 1 0 0 1 0 0 0 1 0 0 1 0 0 0 1 3 0 1 2");
    ASSERT_EQ(mesh.triangles->tangents.size(), 3u);
    EXPECT_EQ(mesh.triangles->tangents[1], (Vec3{0, 1, 0}));
    EXPECT_EQ(mesh.triangles->tangents[2], (Vec3{0, 0, 1}));
}

TEST(ScenePly, ANormalThatIsNoNumberIsNone) {
    const std::string layout =
        std::string(kVertex) + "property float nx\nproperty float ny\nproperty float nz\n";
    const auto mesh =
        read(header("ascii", 3, layout, 1) + "0 0 0 nan nan nan 1 0 0 0 0 1 0 1 0 0 0 1 3 0 1 2");
    EXPECT_EQ(mesh.triangles->normals[0], Vec3{});
    EXPECT_EQ(mesh.triangles->normals[1], (Vec3{0, 0, 1}));
}

TEST(ScenePly, ReadsBothByteOrdersAndEveryNumberType) {
    for (const bool big : {false, true}) {
        std::string text =
            header(big ? "binary_big_endian" : "binary_little_endian", 4,
                   "property int16 x\nproperty float64 y\nproperty uint32 z\nproperty list ushort "
                   "short extra\n",
                   2, "property int8 flags\nproperty list uint16 uint32 vertex_index\n");
        for (int i = 0; i < 4; ++i) {
            text += bytes<int16_t>(static_cast<int16_t>(-i), big) + bytes<double>(0.25 * i, big) +
                    bytes<uint32_t>(100000u + static_cast<uint32_t>(i), big);
            text += bytes<uint16_t>(2, big) + bytes<int16_t>(5, big) + bytes<int16_t>(6, big);
        }
        text += bytes<int8_t>(1, big) + bytes<uint16_t>(3, big);
        for (uint32_t i : {0u, 1u, 2u}) text += bytes(i, big);
        text += bytes<int8_t>(1, big) + bytes<uint16_t>(3, big);
        for (uint32_t i : {1u, 3u, 2u}) text += bytes(i, big);
        const auto mesh = read(text);
        EXPECT_EQ(mesh.triangles->positions[3], (Vec3{-3, 0.75f, 100003}));
        EXPECT_EQ(mesh.triangles->triangles[1], (std::array<uint32_t, 3>{1, 3, 2}));
    }
}

TEST(ScenePly, QuadsBecomePatchesAndPolygonsFans) {
    WarningLog log;
    const auto mesh = read(header("ascii", 6, kVertex, 4) +
                               "0 0 0 1 0 0 1 1 0 0 1 0 0 2 0 -1 1 0\n"
                               "4 0 1 2 3\n3 0 1 2\n5 0 1 2 3 5\n2 0 1\n",
                           &log);
    EXPECT_EQ(mesh.quads->patches, (std::vector<std::array<uint32_t, 4>>{{0, 1, 3, 2}}));
    EXPECT_EQ(mesh.triangles->triangles,
              (std::vector<std::array<uint32_t, 3>>{{0, 1, 2}, {0, 1, 2}, {0, 2, 3}, {0, 3, 5}}));
    EXPECT_EQ(mesh.quads->positions.size(), 6u);
    EXPECT_EQ(log.take().size(), 2u);
}

TEST(ScenePly, AllNamesOfTextureCoordinatesAreKnown) {
    for (const char* pair : {"u v", "s t", "texture_u texture_v", "texture_s texture_t"}) {
        const std::string p(pair), first = p.substr(0, p.find(' ')),
                                   second = p.substr(p.find(' ') + 1);
        const auto mesh = read(
            header("ascii", 3,
                   kVertex + ("property float " + first + "\nproperty float " + second + "\n"), 1) +
            "0 0 0 .1 .2  1 0 0 .3 .4  0 1 0 .5 .6  3 0 1 2");
        EXPECT_EQ(mesh.triangles->uvs.at(1), (Vec2{0.3f, 0.4f})) << pair;
    }
}

TEST(ScenePly, OtherElementsAreSkipped) {
    const auto mesh = read(
        "ply\r\nformat ascii 1.0\r\nobj_info x\r\nelement camera 1\r\nproperty float a\r\nproperty "
        "list int float b\r\n"
        "element vertex 3\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\nelement "
        "empty 7\r\n"
        "element face 1\r\nproperty list int int vertex_indices\r\nend_header\r\n9 2 1 1\r\n0 0 "
        "0\r\n1 0 0\r\n0 1 0\r\n3 0 1 2\r\n");
    EXPECT_EQ(mesh.triangles->triangles.size(), 1u);
}

std::string small_binary() {
    std::string text = header("binary_little_endian", 3, kVertex, 2);
    for (float v : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) text += bytes(v, false);
    for (int f = 0; f < 2; ++f) {
        text += bytes<uint8_t>(3, false);
        for (int i : {0, 1, 2}) text += bytes(i, false);
    }
    return text;
}

TEST(ScenePly, TruncationAtEveryByteIsAnError) {
    const std::string binary = small_binary();
    EXPECT_NO_THROW(read(binary));
    for (size_t n = 0; n < binary.size(); ++n) EXPECT_THROW(read(binary.substr(0, n)), Error) << n;
    // A file in ascii that is cut off can be told only where it lacks a whole number.
    const std::string ascii = header("ascii", 3, kVertex, 2) + "0 0 0 1 0 0 0 1 0 3 0 1 2 3 2 1 0";
    EXPECT_NO_THROW(read(ascii));
    for (size_t n = 0; n < ascii.size(); ++n) EXPECT_THROW(read(ascii.substr(0, n)), Error) << n;
}

TEST(ScenePly, EveryChangedByteIsReadOrRefused) {
    const std::string binary = small_binary();
    for (size_t n = 0; n < binary.size(); ++n)
        for (const int value : {0x00, 0x20, 0x39, 0x7f, 0xff}) {
            std::string changed = binary;
            changed[n] = static_cast<char>(value);
            try {
                const PlyMesh m = read(changed);
                if (!m.triangles) continue;
                for (const auto& t : m.triangles->triangles)
                    for (const uint32_t i : t) EXPECT_LT(i, m.triangles->positions.size());
            } catch (const Error&) {
            }
        }
}

TEST(ScenePly, ErrorsSayWhatIsWrongAndWhere) {
    const auto fails = [](const std::string& text, const std::string& expected) {
        const std::string error = error_of(text);
        EXPECT_EQ(error.substr(0, expected.size()), expected);
    };
    fails("plx\n", "m.ply:1:1: not a PLY file; expected a first line \"ply\"");
    fails("ply\nformat ascii 1.0\n", "m.ply:3:1: the PLY file ends in its header; expected");
    fails("ply\nformat ascii 1.0\nelement", "m.ply:3:8: the PLY file ends in its header");
    fails("ply\nend_header\n",
          "m.ply:2:1: the header of the PLY file ends without a line \"format");
    fails("ply\nformat asci 1.0\n", "m.ply:2:8: unknown PLY format \"asci\"");
    fails("ply\nformat ascii  1.1\n", "m.ply:2:15: expected \"format\", its name, and version");
    fails("ply\n nonsense\n", "m.ply:2:2: unknown line \" nonsense\"");
    fails("ply\nproperty float x\n", "m.ply:2:1: a property stands before the first element");
    fails("ply\nelement vertex x\n", "m.ply:2:16: expected \"element\", its name, and a count");
    fails("ply\nelement vertex -1\n", "m.ply:2:16: expected \"element\"");
    fails("ply\nelement vertex 1\nproperty flaot x\n",
          "m.ply:3:10: unknown number type \"flaot\"; expected one of char, uchar");
    fails("ply\nelement face 1\nproperty list float int a\n",
          "m.ply:3:15: the length of a list is \"float\"; expected an integer type");
    fails("ply\nformat ascii 1.0\nelement face 0\nproperty list int int vertex_index\nend_header\n",
          "m.ply:5:1: the header of the PLY file ends without an element");

    const std::string three = "0 0 0 1 0 0 0 1 0 ", mesh = header("ascii", 3, kVertex, 1);
    fails(header("ascii", 3, "property float x\n", 1) + three,
          "m.ply:4:1: the vertices of the PLY file have no position; expected x, y and z");
    fails(header("ascii", 3, kVertex, 1, "property int a\n") + three + "1",
          "m.ply:8:1: the faces of the PLY file have no list; expected \"vertex_indices\"");
    fails(mesh + three + "3 0 3 1", "m.ply:11:23: a face has the vertex index 3, which is out of");
    fails(mesh + three + "3 0 1 -1", "m.ply:11:25: a face has an index that is not a whole number");
    fails(mesh + "0 0 0\n1 0 x\n0 1 0\n3 0 1 2", "m.ply:12:5: expected a number, found \"x\"");
    fails(mesh + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2", "m.ply:12:3: a vertex has a number that is not");
    fails(mesh + three + "\n\t-3 0 1 2", "m.ply:12:2: the length of a list");
    fails(mesh + three + "1e300 0 1 2", "m.ply:11:19: the PLY file is truncated: a list is longer");
    fails(mesh + three + "3 0  1\n", "m.ply:12:1: the PLY file is truncated: it ends before");
    // Binary data has no lines.
    fails(
        header("binary_little_endian", 1, kVertex, 1, "property list uint uint vertex_indices\n") +
            std::string(12, '\0') + bytes<uint32_t>(3, false) + bytes<uint32_t>(0, false) +
            bytes<uint32_t>(0, false) + bytes<uint32_t>(7, false),
        "m.ply: a face has the vertex index 7");
}

TEST(ScenePly, AbsurdCountsAreRefusedBeforeAllocating) {
    const std::string huge =
        "ply\nformat binary_little_endian 1.0\nelement vertex 18446744073709551615\n" +
        std::string(kVertex) +
        "element face 1\nproperty list uint uint vertex_indices\nend_header\n";
    EXPECT_TRUE(
        contains(error_of(huge), "m.ply:3:1: the PLY file is truncated or its header is wrong"));
    const std::string beyond =
        "ply\nformat ascii 1.0\nelement vertex 99999999999999999999\n" + std::string(kVertex) +
        "element face 0\nproperty list uint uint vertex_indices\nend_header\n0 0 0\n";
    EXPECT_TRUE(
        contains(error_of(beyond), "m.ply:3:16: expected \"element\", its name, and a count"));
    std::string list =
        header("binary_little_endian", 1, kVertex, 1, "property list uint uint vertex_indices\n");
    list += std::string(12, '\0') + bytes<uint32_t>(0xfffffff0u, false);
    EXPECT_TRUE(contains(error_of(list), "a list is longer than the rest of the file"));
}

}  // namespace
}  // namespace covtrace::test
