#include "cli/picture_name.h"

#include "core/error.h"
#include "image/write_image.h"

namespace covtrace::cli {

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
    if (!file.has_extension() || !written_format(file)) return;
    throw Error(ErrorKind::usage, option + ": '" + file.string() +
                                      "' is the name of an image; expected one that ends in .html");
}

}  // namespace covtrace::cli
