/// Grids of NanoVDB's files: good ones, of all kinds, and damaged ones.
#include "volume/nanovdb_grid.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <sstream>

#include "core/rng.h"

#define NANOVDB_USE_ZIP 1
#define NANOVDB_USE_BLOSC 1
#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/GridBuilder.h>
#include <nanovdb/util/IO.h>

namespace covtrace {
namespace {

constexpr float kRadius = 9;

float value_at(int x, int y, int z) {
    const float r = std::sqrt(float(x * x + y * y + z * z));
    return r < kRadius ? 1 - r / kRadius + 0.1f * float((x + 2 * y + 3 * z) & 3) : 0;
}

/// The bytes of a file with a ball around the lattice's origin, cells of 0.5, moved by (1, 2, 3),
/// and a second grid that is the ball's double.
template <class Value = float>
std::string ball_file(nanovdb::io::Codec codec = nanovdb::io::Codec::NONE) {
    // The library goes on behind the header before it writes it
    std::ostringstream out(std::string(4096, '\0'));
    std::vector<nanovdb::GridHandle<>> handles;
    for (const char* name : {"density", "temperature"}) {
        nanovdb::GridBuilder<float, Value> builder(0, nanovdb::GridClass::FogVolume);
        auto accessor = builder.getAccessor();
        const float factor = std::string(name) == "density" ? 1 : 2;
        for (int x = -10; x <= 10; ++x)
            for (int y = -10; y <= 10; ++y)
                for (int z = -10; z <= 10; ++z)
                    if (const float v = value_at(x, y, z); v > 0)
                        accessor.setValue(nanovdb::Coord(x, y, z), factor * v);
        handles.push_back(builder.getHandle(0.5, nanovdb::Vec3d(1, 2, 3), name));
    }
    nanovdb::io::writeGrids(out, handles, codec);
    return out.str();
}

TEST(NanovdbGrid, IsReadInAllKinds) {
    using nanovdb::io::Codec;
    const struct {
        const char* name;
        std::string bytes;
        float error;
    } files[] = {{"plain", ball_file(), 1e-5f},
                 {"zip", ball_file(Codec::ZIP), 1e-5f},
                 {"blosc", ball_file(Codec::BLOSC), 1e-5f},
                 {"4 bits", ball_file<nanovdb::Fp4>(), 0.06f},
                 {"8 bits", ball_file<nanovdb::Fp8>(), 0.01f},
                 {"16 bits", ball_file<nanovdb::Fp16>(), 1e-3f},
                 {"as many bits as needed", ball_file<nanovdb::FpN>(), 0.1f}};
    for (const auto& file : files) {
        SCOPED_TRACE(file.name);
        // The scene's space is twice as large as the file's
        const auto grid = read_nanovdb(file.bytes, "density", Transform::scale(0.5, 0.5, 0.5), {});
        ASSERT_TRUE(grid);
        for (const LatticePlace& p : {LatticePlace{0, 0, 0}, LatticePlace{3, -4, 5},
                                      LatticePlace{-7, 2, -1}, LatticePlace{0, -8, 0}}) {
            const Vec3 in_file{0.5f * float(p[0]) + 1, 0.5f * float(p[1]) + 2,
                               0.5f * float(p[2]) + 3};
            EXPECT_NEAR(grid->at(2 * in_file), value_at(p[0], p[1], p[2]), file.error);
        }
        EXPECT_EQ(grid->at({40, 4, 6}), 0);
        const auto hot = read_nanovdb(file.bytes, "temperature", Transform(), {});
        ASSERT_TRUE(hot);
        EXPECT_NEAR(hot->at({1, 2, 3}), 2 * value_at(0, 0, 0), 2 * file.error);
        EXPECT_FALSE(read_nanovdb(file.bytes, "velocity", Transform(), {}));
    }
}

/// Whether there is a grid in the bytes; looks along a ray.
bool read(const std::string& bytes) {
    try {
        const auto grid = read_nanovdb(bytes, "density", Transform(), {});
        if (grid) grid->column({-20, 2, 3}, {1, 0, 0}, kInfinity);
        return grid != nullptr;
    } catch (const Error& e) {
        EXPECT_TRUE(e.kind() == ErrorKind::scene || e.kind() == ErrorKind::limit);
        return false;
    }
}

/// A handle of a grid named "density" of a cube of `side` places from `first` on, all 1.
nanovdb::GridHandle<> cube(int first, int side, double cell) {
    nanovdb::GridBuilder<float> builder(0, nanovdb::GridClass::FogVolume);
    auto accessor = builder.getAccessor();
    for (int x = 0; x < side; ++x)
        for (int y = 0; y < side; ++y)
            for (int z = 0; z < side; ++z)
                accessor.setValue(nanovdb::Coord(first + x, first + y, first + z), 1.0f);
    return builder.getHandle(cell, nanovdb::Vec3d(0), "density");
}

std::string file_of(nanovdb::GridHandle<> handle) {
    std::ostringstream out(std::string(4096, '\0'));
    std::vector<nanovdb::GridHandle<>> handles;
    handles.push_back(std::move(handle));
    nanovdb::io::writeGrids(out, handles);
    return out.str();
}

TEST(NanovdbGrid, LiesExactlyFarFromItsLatticesOrigin) {
    // A cell there is smaller than the roundings of the lattice's coordinates in single precision;
    // the scene's transform brings it to its own origin
    constexpr int kFirst = 50'000'003;
    const auto grid = read_nanovdb(file_of(cube(kFirst, 16, 0.5)), "density",
                                   Transform({{{{1, 0, 0, 0.5 * kFirst},
                                                {0, 1, 0, 0.5 * kFirst},
                                                {0, 0, 1, 0.5 * kFirst},
                                                {0, 0, 0, 1}}}},
                                             {{{{1, 0, 0, -0.5 * kFirst},
                                                {0, 1, 0, -0.5 * kFirst},
                                                {0, 0, 1, -0.5 * kFirst},
                                                {0, 0, 0, 1}}}}),
                                   {});
    ASSERT_TRUE(grid);
    for (const float x : {0.0f, 0.1f, 3.7f, 7.5f}) EXPECT_NEAR(grid->at({x, 4, 4}), 1, 1e-4) << x;
    EXPECT_NEAR(grid->at({7.75f, 4, 4}), 0.5f, 1e-3);
    EXPECT_EQ(grid->at({-0.1f, 4, 4}), 0);
    EXPECT_NEAR(grid->column({-3, 4, 4}, {1, 0, 0}, kInfinity), 7.75f, 1e-3);
}

TEST(NanovdbGrid, PlacesFarApartAreReadSoon) {
    // Space between them has 64 million blocks of cells
    nanovdb::GridBuilder<float> builder(0, nanovdb::GridClass::FogVolume);
    auto accessor = builder.getAccessor();
    for (const int at : {0, 1000, 3150, 3201})
        accessor.setValue(nanovdb::Coord(at, at, at), float(1 + at % 7));
    const auto begin = std::chrono::steady_clock::now();
    const auto grid = read_nanovdb(file_of(builder.getHandle(1, nanovdb::Vec3d(0), "density")),
                                   "density", Transform(), {});
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(4));
    ASSERT_TRUE(grid);
    for (const int at : {0, 1000, 3150, 3201})
        EXPECT_EQ(grid->at(Vec3{1, 1, 1} * float(at)), float(1 + at % 7)) << at;
    EXPECT_EQ(grid->at({1000, 1000, 3150}), 0);
}

TEST(NanovdbGrid, SizesThatLeadBackOrBeyondAreRefused) {
    using nanovdb::io::Codec;
    constexpr size_t kHeader = sizeof(nanovdb::io::Header);
    const auto put = [](std::string& bytes, size_t at, auto value) {
        std::memcpy(bytes.data() + at, &value, sizeof(value));
    };
    // The parts of a file that come again, for ever
    std::string circle = file_of(cube(0, 8, 1));
    const size_t part = kHeader + sizeof(nanovdb::io::MetaData) + sizeof("density");
    put(circle, kHeader + offsetof(nanovdb::io::MetaData, fileSize), -int64_t(part));
    EXPECT_FALSE(read(circle));
    // A second grid behind the first one's end
    std::string second = file_of(cube(0, 8, 1));
    put(second, part + offsetof(nanovdb::GridData, mGridIndex), uint32_t(1));
    EXPECT_FALSE(read(second));
    // A name without an end, and none
    std::string name = file_of(cube(0, 8, 1));
    name[part - 1] = 'x';
    EXPECT_FALSE(read(name));
    put(name, kHeader + offsetof(nanovdb::io::MetaData, nameSize), uint32_t(0));
    EXPECT_FALSE(read(name));
    // Compressed values that claim to be a gigabyte
    std::string blosc = ball_file(Codec::BLOSC);
    const size_t values =
        kHeader + 2 * sizeof(nanovdb::io::MetaData) + sizeof("density") + sizeof("temperature");
    put(blosc, values + 8 + 12, uint32_t(1) << 30);
    EXPECT_FALSE(read(blosc));
}

TEST(NanovdbGrid, OtherVersionsOfTheFormatAreNamed) {
    // Before the numbers of versions had three parts the header held a 19
    std::string bytes = file_of(cube(0, 8, 1));
    const uint32_t version = 19;
    std::memcpy(bytes.data() + offsetof(nanovdb::io::Header, version), &version, sizeof version);
    try {
        read_nanovdb(bytes, "density", Transform(), {});
        FAIL();
    } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("it is of version 0.0.19 of the format; expected 32"),
                  std::string::npos)
            << e.what();
    }
}

TEST(NanovdbGrid, ManyWaysToOneNodeAreRefused) {
    auto handle = cube(0, 8, 1);
    auto& tree = handle.grid<float>()->tree();
    auto* upper = tree.getFirstNode<2>()->data();
    auto* lower = tree.getFirstNode<1>()->data();
    for (uint32_t i = 0; i < 4096; ++i) {
        lower->mChildMask.setOn(i);
        lower->setChild(i, tree.getFirstNode<0>());
        upper->mChildMask.setOn(i);
        upper->setChild(i, tree.getFirstNode<1>());
    }
    EXPECT_FALSE(read(file_of(std::move(handle))));
}

TEST(NanovdbGrid, CellsOutOfRangeAreRefused) {
    EXPECT_TRUE(read(file_of(cube(0, 8, 1e-30))));
    EXPECT_FALSE(read(file_of(cube(0, 8, 1e-60))));
}

TEST(NanovdbGrid, DamagedFilesAreRefusedOrReadWithoutHarm) {
    const std::string good = ball_file();
    EXPECT_TRUE(read(good));
    EXPECT_FALSE(read(""));
    EXPECT_FALSE(read("Film"));
    for (size_t length = 1; length < good.size(); length += good.size() / 40)
        EXPECT_FALSE(read(good.substr(0, length))) << length;
    // Bytes of headers, of the tree and of its nodes' offsets, one at a time and several
    Rng rng(7);
    int refused = 0;
    for (int i = 0; i < 600; ++i) {
        std::string bytes = good;
        const size_t reach = i % 2 == 0 ? 4096 : bytes.size();
        for (int k = 0; k <= i % 4; ++k)
            bytes[size_t(rng.next_float() * float(reach - 1))] = char(rng.next_uint());
        refused += !read(bytes);
    }
    EXPECT_GT(refused, 10);
}

}  // namespace
}  // namespace covtrace
