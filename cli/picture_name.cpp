#include "cli/picture_name.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "core/error.h"
#include "image/write_image.h"

namespace covtrace::cli {

namespace {

/// Whether a file has the name of an image, of any format that is written or read.
bool is_image_name(const std::filesystem::path& file) {
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    constexpr std::array<std::string_view, 7> kRead{".jpg", ".jpeg", ".tga", ".qoi",
                                                    ".ppm", ".pgm",  ".webp"};
    return !ending.empty() &&
           (written_format(file) || std::find(kRead.begin(), kRead.end(), ending) != kRead.end());
}

}  // namespace

void require_image_name(const std::string& option, const std::filesystem::path& file,
                        const LayerSelection& layers) {
    if (file.empty()) return;
    const auto format = written_format(file);
    if (!format)
        throw Error(ErrorKind::usage, option + ": '" + file.string() + "' " + kExpectedImageName);
    if (*format != WrittenFormat::exr && !layers.names.empty())
        throw Error(ErrorKind::usage, option + ": '" + file.string() + "' cannot hold the layer '" +
                                          layers.names.front() +
                                          "'; expected a name that ends in .exr");
}

void require_picture_name(const std::string& option, const std::filesystem::path& file) {
    if (file.empty() || !file.has_extension() || written_format(file) == WrittenFormat::png) return;
    throw Error(ErrorKind::usage, option + ": '" + file.string() +
                                      "' is the name of another format; expected one that ends in "
                                      ".png (--output writes others)");
}

void require_report_name(const std::string& option, const std::filesystem::path& file) {
    if (!is_image_name(file)) return;
    throw Error(ErrorKind::usage, option + ": '" + file.string() +
                                      "' is the name of an image; expected one that ends in .html");
}

}  // namespace covtrace::cli
