// Files of measured BRDFs: what they hold, and what damage does.
#include "pbrt/brdf_file.h"

#include <cstring>
#include <vector>

#include "colour/spectrum.h"
#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

template <typename T>
std::string bytes(T value) {
    std::string raw(sizeof(T), '\0');
    std::memcpy(raw.data(), &value, sizeof(T));
    return raw;
}

struct Field {
    std::string name;
    uint8_t type;
    std::vector<uint64_t> shape;
    std::string data;
};
constexpr uint8_t kByte = 1, kFloat = 10;

Field floats(const std::string& name, std::vector<uint64_t> shape, const std::vector<float>& v) {
    std::string data;
    for (const float x : v) data += bytes(x);
    return {name, kFloat, std::move(shape), data};
}

/// A tensor file: its header, then the data of all fields.
std::string tensor(const std::vector<Field>& fields) {
    size_t size = 12 + 2 + 4;
    for (const Field& f : fields) size += 2 + f.name.size() + 2 + 1 + 8 + 8 * f.shape.size();
    std::string header = std::string("tensor_file\0", 12) + bytes(uint8_t(1)) + bytes(uint8_t(0)) +
                         bytes(uint32_t(fields.size()));
    std::string data;
    for (const Field& f : fields) {
        header += bytes(uint16_t(f.name.size())) + f.name + bytes(uint16_t(f.shape.size())) +
                  bytes(f.type) + bytes(uint64_t(size + data.size()));
        for (const uint64_t s : f.shape) header += bytes(s);
        data += f.data;
    }
    return header + data;
}

/// Fields of one azimuth, two angles, three wavelengths and tables of 2 x 2 nodes.
std::vector<Field> small_brdf() {
    std::vector<float> spectra;
    for (int direction = 0; direction < 2; ++direction)
        for (const float value : {0.2f, 0.5f, 0.8f})
            for (int i = 0; i < 4; ++i) spectra.push_back(value + float(direction));
    return {floats("phi_i", {1}, {0}),
            floats("theta_i", {2}, {0, 1.5f}),
            floats("wavelengths", {3}, {400, 550, 700}),
            floats("ndf", {2, 2}, {1, 2, 3, 4}),
            floats("sigma", {2, 2}, {5, 6, 7, 8}),
            floats("vndf", {1, 2, 2, 2}, {1, 1, 1, 1, 2, 2, 2, 2}),
            floats("luminance", {1, 2, 2, 2}, {1, 1, 1, 1, 1, 1, 1, 1}),
            floats("spectra", {1, 2, 3, 2, 2}, spectra),
            {"jacobian", kByte, {1}, std::string(1, '\1')},
            {"description", kByte, {3}, "abc"}};
}

Field& field(std::vector<Field>& fields, const std::string& name) {
    return *std::find_if(fields.begin(), fields.end(),
                         [&](const Field& f) { return f.name == name; });
}

auto read(const std::string& file) {
    return read_brdf(file, "paint.bsdf", {});
}
std::string error_of(const std::vector<Field>& fields) {
    const Failure f = failure_of([&] { read(tensor(fields)); });
    EXPECT_EQ(f.kind, ErrorKind::scene);
    return f.message;
}

TEST(BrdfFile, HoldsItsTablesAndTheColoursOfItsSpectra) {
    const auto brdf = read(tensor(small_brdf()));
    EXPECT_TRUE(brdf->is_isotropic());
    EXPECT_EQ(brdf->theta, (std::vector<float>{0, 1.5f}));
    EXPECT_EQ(brdf->normals.values, (std::vector<float>{1, 2, 3, 4}));
    EXPECT_EQ(brdf->areas.values, (std::vector<float>{5, 6, 7, 8}));
    EXPECT_EQ(brdf->visible_normals.values.size(), 8u);
    ASSERT_EQ(brdf->colours.values.size(), 8u);
    Spectrum s{{400, 550, 700}, {0.2f, 0.5f, 0.8f}, true};
    const Rgb expected = reflectance_colour(s);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(brdf->colours.values[0][c], expected[c], 3e-3f);
        EXPECT_NEAR(brdf->colours.values[7][c], expected[c] + 1, 3e-3f);
    }
    EXPECT_GT(expected.r, expected.b + 0.2f);
}

TEST(BrdfFile, OthersAreRefused) {
    const auto with = [](const std::string& name, auto change) {
        std::vector<Field> fields = small_brdf();
        change(field(fields, name));
        return error_of(fields);
    };
    EXPECT_TRUE(contains(with("ndf", [](Field& f) { f.name = "pdf"; }), "no field \"ndf\""));
    EXPECT_TRUE(contains(with("sigma", [](Field& f) { f.type = 9; }), "field \"sigma\""));
    EXPECT_TRUE(contains(with("vndf",
                              [](Field& f) {
                                  f.shape = {2, 1, 2, 2};
                              }),
                         "a table for each direction"));
    EXPECT_TRUE(contains(with("theta_i", [](Field& f) { std::swap(f.data[3], f.data[7]); }),
                         "do not increase"));
    EXPECT_TRUE(contains(with("jacobian", [](Field& f) { f.data[0] = 0; }), "jacobian"));
    EXPECT_TRUE(contains(with("luminance",
                              [](Field& f) {
                                  f.shape = {1, 2, 1, 4};
                              }),
                         "at least 2 by 2"));
    EXPECT_TRUE(contains(with("spectra", [](Field& f) { f.shape = {1, 2, 3, 1, 4}; }), "spectra"));
    const float nan = std::nanf("");
    EXPECT_TRUE(contains(with("ndf", [&](Field& f) { std::memcpy(f.data.data(), &nan, 4); }),
                         "not finite"));
    std::vector<Field> half = small_brdf();
    field(half, "phi_i") = floats("phi_i", {3}, {0, 1, kPi});
    EXPECT_TRUE(contains(error_of(half), "a part of all azimuths"));
    EXPECT_TRUE(contains(failure_of([] { read("no tensor, but long enough"); }).message,
                         "paint.bsdf\": it is no tensor file"));
}

TEST(BrdfFile, DamageIsAnErrorAndNothingElse) {
    const std::string whole = tensor(small_brdf());
    const auto survives = [](const std::string& file) {
        try {
            read(file);
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), ErrorKind::scene) << e.what();
        }
    };
    for (size_t length = 0; length < whole.size(); ++length) survives(whole.substr(0, length));
    for (size_t i = 0; i < whole.size(); ++i)
        for (const char value : {'\0', '\1', '\x7f', '\xff'}) {
            std::string damaged = whole;
            damaged[i] = value;
            survives(damaged);
        }
}

TEST(BrdfFile, IsReadOnceForAllMaterialsThatNameIt) {
    const TemporaryFolder folder;
    folder.write("paint.bsdf", tensor(small_brdf()));
    const auto scene = read_pbrt(folder.write("scene.pbrt", R"(WorldBegin
Material "measured" "string filename" "paint.bsdf"
Shape "sphere"
AttributeBegin
Material "measured" "string filename" "paint.bsdf"
Shape "disk"
AttributeEnd
)"));
    EXPECT_TRUE(scene.warnings.size() <= 1) << warnings_of(scene);  // it has no lights
    std::vector<const BrdfTensor*> tensors;
    for (const MaterialDescription& m : scene.materials)
        if (const auto* measured = std::get_if<MeasuredMaterial>(&m.value))
            tensors.push_back(measured->brdf.get());
    ASSERT_EQ(tensors.size(), 2u);
    EXPECT_EQ(tensors[0], tensors[1]);
    EXPECT_TRUE(contains(world_error("Material \"measured\"\nShape \"sphere\""), "has no file"));
}

}  // namespace
}  // namespace covtrace::test
