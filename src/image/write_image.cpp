#include "image/write_image.h"

#include <algorithm>
#include <cctype>
#include <string>

#include "image/root_colour.h"

namespace covtrace {

RootColour root_colour(const Image& image, const std::filesystem::path& file) {
    const RootColour colour{{image.find("R"), image.find("G"), image.find("B")}, false};
    if (colour.channels[0] && colour.channels[1] && colour.channels[2]) return colour;
    const Channel* grey = image.find("Y");
    if (!grey)
        throw Error(ErrorKind::internal,
                    "cannot write '" + file.string() + "': the image has no channels R, G, B");
    return {{grey, grey, grey}, true};
}

std::optional<WrittenFormat> written_format(const std::filesystem::path& file) {
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    if (ending.empty() || ending == ".exr") return WrittenFormat::exr;
    if (ending == ".png") return WrittenFormat::png;
    if (ending == ".pfm") return WrittenFormat::pfm;
    if (ending == ".hdr") return WrittenFormat::hdr;
    return std::nullopt;
}

void write_image(const Image& image, const std::filesystem::path& file, int threads,
                 const DisplayOptions& display) {
    const auto format = written_format(file);
    if (!format) throw Error(ErrorKind::usage, "'" + file.string() + "' " + kExpectedImageName);
    switch (*format) {
        case WrittenFormat::exr:
            return write_exr(image, file, threads);
        case WrittenFormat::png:
            return write_png(image, file, display);
        case WrittenFormat::pfm:
            return write_pfm(image, file);
        case WrittenFormat::hdr:
            return write_hdr(image, file);
    }
}

}  // namespace covtrace
