#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <csignal>
#include <limits>

#include "image/color_encoding.h"
#include "image/output_file.h"
#include "image/raster.h"
#include "image_test_files.h"

namespace covtrace {
namespace {

using namespace test;

Image noise(int size) {
    return random_image({0, 0, size, size}, {0, 0, size, size}, {"R", "G", "B"}, 11);
}

size_t file_count(const TemporaryDirectory& directory) {
    return size_t(
        std::distance(fs::directory_iterator(directory.path()), fs::directory_iterator()));
}

void expect_io_error(const Error& error, const fs::path& file, const std::string& reason) {
    EXPECT_EQ(error.kind(), ErrorKind::io);
    EXPECT_NE(std::string(error.what()).find(file.string()), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
}

TEST(Write, NamesTheReasonWhereTheTargetCannotBe) {
    TemporaryDirectory directory;
    write_bytes(directory / "file", "x");
    const Image image = noise(4);
    for (const bool png : {false, true}) {
        const auto write = [&](const fs::path& file) {
            return error_of([&] { png ? write_png(image, file) : write_exr(image, file); });
        };
        const fs::path missing = directory / "no/such/a.exr", below = directory / "file/a.exr";
        expect_io_error(write(missing), missing, "directory '" + missing.parent_path().string());
        expect_io_error(write(below), below, "Not a directory");
        expect_io_error(write(directory.path()), directory.path(), "Is a directory");
        const fs::path long_name = directory / std::string(300, 'a');
        expect_io_error(write(long_name), long_name, "File name too long");
    }
    EXPECT_EQ(file_count(directory), 1u);
}

TEST(Write, DeviceIsWrittenDirectlyAndStays) {
    const Image image = noise(4);
    expect_io_error(error_of([&] { write_exr(image, "/dev/full"); }), "/dev/full",
                    "No space left on device");
    expect_io_error(error_of([&] { write_png(image, "/dev/full"); }), "/dev/full",
                    "No space left on device");
    write_exr(image, "/dev/null");
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
    EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

/// Writes under a limit of `bytes`, in a process of its own; returns 0 where that fails cleanly.
int write_under_limit(const fs::path& file, int size, rlim_t bytes, bool png) {
    const Image image = noise(size);
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, bytes};
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0) return 2;
    try {
        png ? write_png(image, file) : write_exr(image, file);
    } catch (const Error& e) {
        const std::string text = e.what();
        const bool named = text.find(file.string()) != std::string::npos &&
                           text.find("File too large") != std::string::npos;
        return e.kind() == ErrorKind::io && named ? 0 : 3;
    } catch (...) {
        return 4;
    }
    return 5;
}

TEST(Write, ShortWriteLeavesTheOldFileWhole) {
    TemporaryDirectory directory;
    const fs::path file = directory / "a.exr";
    write_bytes(file, "the old file");
    // Small files fail at the very end, when OpenEXR's destructor completes the offsets; large ones
    // while the pixels are written.
    struct Case {
        int size;
        rlim_t limit;
        bool png;
    };
    for (const Case& c : {Case{8, 0, false},
                          {8, 100, false},
                          {8, 700, false},
                          {300, 400, false},
                          {300, 300000, false},
                          {300, 900000, false},
                          {8, 0, true},
                          {300, 5000, true}}) {
        const pid_t child = fork();
        ASSERT_GE(child, 0);
        if (child == 0) ::_exit(write_under_limit(file, c.size, c.limit, c.png));
        int status = 0;
        ASSERT_EQ(waitpid(child, &status, 0), child);
        ASSERT_TRUE(WIFEXITED(status));
        EXPECT_EQ(WEXITSTATUS(status), 0) << c.size << " pixels, limit " << c.limit;
        EXPECT_EQ(read_bytes(file), "the old file");
        EXPECT_EQ(file_count(directory), 1u);
    }
}

TEST(OutputFile, AppearsOnCommitOnly) {
    TemporaryDirectory directory;
    const fs::path file = directory / "a";
    write_bytes(file, "old");
    {
        OutputFile output(file);
        output.write("new", 3);
        EXPECT_EQ(file_count(directory), 2u);
        EXPECT_TRUE(fs::exists(file.string() + OutputFile::part_suffix()));
    }
    EXPECT_EQ(read_bytes(file), "old");
    EXPECT_EQ(file_count(directory), 1u);

    OutputFile output(file);
    output.write("0123456789", 10);
    output.seek(2);
    output.write("ab", 2);
    EXPECT_EQ(output.position(), 4u);
    EXPECT_EQ(read_bytes(file), "old");
    output.commit();
    EXPECT_EQ(read_bytes(file), "01ab456789");
    EXPECT_EQ(file_count(directory), 1u);
}

TEST(OutputFile, KeepsLinksAndPermissions) {
    TemporaryDirectory directory;
    const fs::path target = directory / "target", link = directory / "link";
    write_bytes(target, "old");
    fs::permissions(target, fs::perms::owner_read | fs::perms::owner_write);
    fs::create_symlink("target", link);
    OutputFile output(link);
    output.write("new", 3);
    output.commit();
    EXPECT_TRUE(fs::is_symlink(link));
    EXPECT_EQ(read_bytes(target), "new");
    EXPECT_EQ(fs::status(target).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST(Png, EncodesClampsAndKeepsBytes) {
    TemporaryDirectory directory;
    const fs::path file = directory / "a.png";
    Image image{{0, 0, 8, 1}, {0, 0, 8, 1}, {}, {}};
    const float inf = std::numeric_limits<float>::infinity(),
                nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<float> values = {0, 1, 0.5f, -1, 7, inf, -inf, nan};
    for (const char* name : {"R", "G", "B"}) image.add_channel(name).values = values;
    write_png(image, file);
    const RasterImage raster = read_raster(file);
    ASSERT_EQ(raster.channels, 3);
    EXPECT_TRUE(raster.is_8bit);
    // 188 is the sRGB value of half the light, from IEC 61966-2-1.
    const std::vector<int> expected = {0, 255, 188, 0, 255, 255, 0, 0};
    for (size_t i = 0; i < expected.size(); ++i)
        EXPECT_EQ(int(raster.bytes[3 * i + 1]), expected[i]) << i;

    std::vector<uint8_t> bytes(256 * 3);
    for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = uint8_t(i / 3);
    write_png_rgb8(bytes, 16, 16, file);
    const RasterImage ramp = read_raster(file);
    for (size_t i = 0; i < bytes.size(); ++i) ASSERT_EQ(ramp.bytes[i], bytes[i]);
    EXPECT_EQ(error_of([&] { write_png_rgb8(bytes, 16, 15, file); }).kind(), ErrorKind::internal);
}

TEST(ColorEncoding, IsInverseAndMatchesTheStandard) {
    for (int i = 0; i < 256; ++i) {
        const float encoded = float(i) / 255.0f;
        EXPECT_NEAR(srgb_encode(srgb_decode(encoded)), encoded, 1e-6f);
        EXPECT_EQ(srgb_encode_8bit(srgb_decode(encoded)), i);
    }
    EXPECT_FLOAT_EQ(srgb_decode(0.5f), 0.21404114f);
    EXPECT_FLOAT_EQ(srgb_encode(0.001f), 0.01292f);
    EXPECT_FLOAT_EQ(srgb_encode(1), 1);
}

}  // namespace
}  // namespace covtrace
