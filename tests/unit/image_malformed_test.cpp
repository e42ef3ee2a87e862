// Reading a file, whatever it holds, gives an image or one Error(scene) of one line that names the
// file; nothing is printed, nothing crashes.
#include "image_reading_contract.h"
#include "image_test_files.h"

namespace covtrace {
namespace {

using namespace test;

/// One small valid file of each kind, by its extension.
std::vector<std::pair<std::string, std::string>> valid_files(const TemporaryDirectory& directory) {
    const Image image = random_image({0, 0, 9, 20}, {-1, 0, 10, 20}, {"R", "G", "B", "raw.R"}, 2);
    write_exr(image, directory / "valid.exr");
    write_png(image, directory / "valid.png");
    const std::string rle_row = bytes_of({2, 2, 0, 8, 136, 128, 136, 128, 136, 128, 136, 129});
    return {
        {"exr", read_bytes(directory / "valid.exr")},
        {"png", read_bytes(directory / "valid.png")},
        {"jpg", grey_jpeg()},
        {"hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 8\n" + rle_row + rle_row},
        {"pfm", "PF\n1 1\n-1.0\n" + float_bytes({1, 2, 3})},
        {"tga", bytes_of({0, 1, 9, 0, 0,    2, 0, 24,  0, 0,   0, 0,   3,
                          0, 1, 0, 8, 0x20, 0, 0, 255, 0, 255, 0, 130, 1})},
        {"webp", webp_file({10, 20, 30, 255, 40, 50, 60, 128}, 2, 1, true)},
        {"qoi", "qoif" + bytes_of({0, 0, 0, 3, 0, 0, 0, 1, 4, 0, 0xff, 1, 2, 3, 4, 0x6a, 0xc0})},
    };
}

TEST(Malformed, ValidFilesAreRead) {
    TemporaryDirectory directory;
    for (const auto& [extension, bytes] : valid_files(directory)) {
        const fs::path file = directory / ("a." + extension);
        write_bytes(file, bytes);
        EXPECT_NO_THROW(read_raster(file)) << extension;
    }
}

TEST(Malformed, AnExrAttributeThatClaimsMoreThanTheFileHas) {
    TemporaryDirectory directory;
    const fs::path file = directory / "a.exr";
    Image image = random_image({0, 0, 3, 2}, {0, 0, 3, 2}, {"R", "G", "B"}, 2);
    image.metadata["note"] = std::string("hello");
    write_exr(image, file);
    std::string bytes = read_bytes(file);
    const std::string head = std::string("note\0string\0", 12);
    const size_t at = bytes.find(head) + head.size();
    ASSERT_LT(at, bytes.size());
    for (const uint32_t size : {0x00001000u, 0x7fffffffu, 0x80000000u, 0xffffffffu}) {
        std::memcpy(bytes.data() + at, &size, sizeof size);
        write_bytes(file, bytes);
        EXPECT_EQ(problem_of(file), "");
        try {
            read_image(file);
            ADD_FAILURE() << "expected an error for " << size;
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find("'note' claims to be longer than the file"),
                      std::string::npos)
                << e.what();
        }
    }
}

TEST(Malformed, AnExrChannelListOfAnotherSizeThanItsAttribute) {
    TemporaryDirectory directory;
    const fs::path file = directory / "a.exr";
    write_exr(random_image({0, 0, 3, 2}, {0, 0, 3, 2}, {"R", "G", "B"}, 2), file);
    const std::string whole = read_bytes(file);
    const std::string head = std::string("channels\0chlist\0", 16);
    const size_t at = whole.find(head) + head.size();
    ASSERT_LT(at, whole.size());
    for (const int more : {-18, -1, 1, 20}) {
        std::string bytes = whole;
        bytes[at] = char(bytes[at] + more);
        write_bytes(file, bytes);
        EXPECT_EQ(problem_of(file), "");
        EXPECT_THROW(read_image(file), Error) << more;
    }
}

TEST(Malformed, EveryTruncationIsAnError) {
    TemporaryDirectory directory;
    PrintCounter printed(directory / "printed");
    for (const auto& [extension, bytes] : valid_files(directory))
        for (size_t length = 0; length < bytes.size(); ++length) {
            const fs::path file = directory / ("a." + extension);
            write_bytes(file, bytes.substr(0, length));
            ASSERT_EQ(problem_of(file), "") << extension << " of " << length << " bytes";
            // The last bytes of these formats end the file without holding pixels.
            const bool has_end_marker = extension == "png" || extension == "jpg";
            if (!has_end_marker || length + 20 < bytes.size()) {
                ASSERT_THROW(read_image(file), Error) << extension << " of " << length << " bytes";
            }
        }
    EXPECT_EQ(printed.bytes(), 0u);
}

TEST(Malformed, DamagedBytes) {
    TemporaryDirectory directory;
    PrintCounter printed(directory / "printed");
    uint64_t state = 5;
    const auto random = [&](size_t below) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        return size_t(state >> 33) % below;
    };
    for (const auto& [extension, bytes] : valid_files(directory))
        for (int i = 0; i < 400; ++i) {
            std::string damaged = bytes;
            for (size_t k = 0; k <= random(3); ++k)
                damaged[random(damaged.size())] = char(random(2) ? random(256) : 255 * random(2));
            const fs::path file = directory / ("a." + extension);
            write_bytes(file, damaged);
            ASSERT_EQ(problem_of(file), "") << extension << ", " << i;
        }
    EXPECT_EQ(printed.bytes(), 0u);
}

TEST(Malformed, ClaimsOfHugeSizesAreRefusedBeforeAllocating) {
    TemporaryDirectory directory;
    const auto expect_refused = [&](const std::string& name, const std::string& bytes) {
        write_bytes(directory / name, bytes);
        const std::string text = error_of([&] { read_image(directory / name); }).what();
        EXPECT_NE(text.find("pixels are too many"), std::string::npos) << text;
    };
    expect_refused("a.pfm", "PF\n60000 60000\n-1.0\n");
    expect_refused("a.hdr", "#?RADIANCE\n\n-Y 40000 +X 40000\n");
    expect_refused("a.tga",
                   bytes_of({0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 255, 255, 255, 255, 24, 0}));
    expect_refused("a.qoi", "qoif" + bytes_of({255, 255, 255, 255, 255, 255, 255, 255, 4, 0}));
    std::string jpeg = grey_jpeg();
    const size_t frame = jpeg.find("\xff\xc0");
    jpeg.replace(frame + 5, 4, "\xff\xdc\xff\xdc");
    expect_refused("a.jpg", jpeg);
}

TEST(Malformed, NotAnImage) {
    TemporaryDirectory directory;
    write_bytes(directory / "empty.png", "");
    write_bytes(directory / "text.png", "hello, world\n");
    EXPECT_EQ(problem_of(directory / "empty.png"), "");
    EXPECT_NE(std::string(error_of([&] { read_image(directory / "text.png"); }).what())
                  .find("it is no image of a known format"),
              std::string::npos);
    write_bytes(directory / "a.ktx2", "\xabKTX 20\xbb\r\n\x1a\n");
    EXPECT_NE(std::string(error_of([&] { read_image(directory / "a.ktx2"); }).what())
                  .find("it is a KTX texture, which is not read"),
              std::string::npos);
}

}  // namespace
}  // namespace covtrace
