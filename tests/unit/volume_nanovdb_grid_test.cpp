/// Grids of NanoVDB's files: good ones, of all kinds, and damaged ones.
#include "volume/nanovdb_grid.h"

#include <gtest/gtest.h>

#include <cmath>
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

TEST(NanovdbGrid, DamagedFilesAreRefusedOrReadWithoutHarm) {
    const std::string good = ball_file();
    const auto read = [](const std::string& bytes) {
        try {
            const auto grid = read_nanovdb(bytes, "density", Transform(), {});
            if (grid) grid->column({-20, 2, 3}, {1, 0, 0}, kInfinity);
            return grid != nullptr;
        } catch (const Error& e) {
            EXPECT_TRUE(e.kind() == ErrorKind::scene || e.kind() == ErrorKind::limit);
            return false;
        }
    };
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
