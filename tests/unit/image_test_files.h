/// Files and images that the tests of src/image share.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>
#include <webp/encode.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "image/image.h"

namespace covtrace::test {

namespace fs = std::filesystem;

/// A new directory that is removed with all that is in it.
class TemporaryDirectory {
  public:
    TemporaryDirectory() {
        std::string name = (fs::temp_directory_path() / "covtrace-image-XXXXXX").string();
        if (!::mkdtemp(name.data())) throw std::runtime_error("no temporary directory");
        path_ = name;
    }
    ~TemporaryDirectory() { fs::remove_all(path_); }
    TemporaryDirectory(const TemporaryDirectory&) = delete;
    TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
    fs::path operator/(const std::string& name) const { return path_ / name; }
    const fs::path& path() const { return path_; }

  private:
    fs::path path_;
};

inline void write_bytes(const fs::path& file, const std::string& bytes) {
    // Some file systems write truncated files to the disk at once, which is slow.
    fs::remove(file);
    std::ofstream stream(file, std::ios::binary);
    stream.write(bytes.data(), std::streamsize(bytes.size()));
    ASSERT_TRUE(stream.good());
}

inline std::string read_bytes(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

inline std::string bytes_of(std::initializer_list<int> values) {
    std::string bytes;
    for (int v : values) bytes += char(v);
    return bytes;
}

inline std::string bytes_of_hex(std::string_view hex) {
    std::string bytes;
    for (size_t i = 0; i + 1 < hex.size(); i += 2)
        bytes += char(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
    return bytes;
}

inline std::string float_bytes(std::initializer_list<float> values, bool big_endian = false) {
    std::string bytes;
    for (float v : values)
        for (int i = 0; i < 4; ++i)
            bytes += char(std::bit_cast<uint32_t>(v) >> (big_endian ? 24 - 8 * i : 8 * i));
    return bytes;
}

/// An 8x8 grey baseline JPEG, all samples 128.
inline std::string grey_jpeg() {
    std::string tables(128, '0');
    for (size_t i = 1; i < tables.size(); i += 2) tables[i] = '1';
    return bytes_of_hex("ffd8ffdb004300" + tables +
                        "ffc0000b080008000801011100ffc40014000100000000000000000000000000000000ffc4"
                        "0014100100000000000000000000000000000000ffda0008010100003f003fffd9");
}

/// A WebP file of these values, R G B A each, from the library's encoder.
inline std::string webp_file(const std::vector<uint8_t>& rgba, int width, int height,
                             bool lossless) {
    uint8_t* bytes = nullptr;
    const size_t size = lossless
                            ? WebPEncodeLosslessRGBA(rgba.data(), width, height, 4 * width, &bytes)
                            : WebPEncodeRGBA(rgba.data(), width, height, 4 * width, 90, &bytes);
    const std::string file(reinterpret_cast<const char*>(bytes), size);
    WebPFree(bytes);
    return file;
}

/// An image of noise, any bits, also those of NaN, infinity and denormals.
inline Image random_image(const PixelBounds& data, const PixelBounds& display,
                          const std::vector<std::string>& names, uint64_t seed) {
    Image image{data, display, {}, {}};
    uint64_t state = seed;
    for (const std::string& name : names)
        for (float& v : image.add_channel(name).values) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            v = std::bit_cast<float>(uint32_t(state >> 32));
        }
    return image;
}

inline bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

/// The error that `action` throws; a failed test where it throws nothing or something else.
template <class Action>
Error error_of(Action action) {
    try {
        action();
    } catch (const Error& e) {
        return e;
    }
    ADD_FAILURE() << "no error was thrown";
    return {ErrorKind::internal, "no error was thrown"};
}

}  // namespace covtrace::test
