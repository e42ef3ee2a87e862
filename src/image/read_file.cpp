#include "image/read_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <fstream>
#include <new>
#include <string_view>
#include <system_error>
#include <vector>

namespace covtrace {

namespace {

[[noreturn]] void throw_unopenable(const std::filesystem::path& file, const SourceLocation& where,
                                   int error_number) {
    throw Error(
        ErrorKind::scene, where,
        "cannot open '" + file.string() + "': " + std::generic_category().message(error_number));
}

std::string first_bytes(const std::filesystem::path& file, const SourceLocation& where) {
    require_file(file, where);
    errno = 0;
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw_unopenable(file, where, errno ? errno : EIO);
    std::array<char, 16> bytes{};
    stream.read(bytes.data(), bytes.size());
    return {bytes.data(), size_t(stream.gcount())};
}

std::string lower_case_extension(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    return extension;
}

ImageFormat format_of(std::string_view bytes, const std::filesystem::path& file,
                      const SourceLocation& where) {
    using namespace std::string_view_literals;
    if (bytes.empty()) throw_unreadable(file, where, "the file is empty");
    if (bytes.starts_with("\x76\x2f\x31\x01"sv)) return ImageFormat::exr;
    if (bytes.starts_with("\x89PNG\r\n\x1a\n"sv)) return ImageFormat::png;
    if (bytes.starts_with("\xff\xd8\xff"sv)) return ImageFormat::jpeg;
    if (bytes.starts_with("#?RADIANCE"sv) || bytes.starts_with("#?RGBE"sv)) return ImageFormat::hdr;
    if (bytes.starts_with("qoif"sv)) return ImageFormat::qoi;
    if (bytes.starts_with("RIFF"sv) &&
        bytes.substr(std::min(bytes.size(), size_t{8})).starts_with("WEBP"sv))
        return ImageFormat::webp;
    if (bytes.size() > 2 && bytes[0] == 'P' &&
        "123456fF"sv.find(bytes[1]) != std::string_view::npos &&
        std::isspace(static_cast<unsigned char>(bytes[2])))
        return ImageFormat::pnm;
    if (lower_case_extension(file) == ".tga") return ImageFormat::targa;
    if (bytes.starts_with("\xabKTX"sv))
        throw_unreadable(file, where,
                         "it is a KTX texture, which is not read; expected a PNG, as "
                         "'gltf-transform ktxdecompress' makes of those of glTF");
    throw_unreadable(file, where,
                     "it is no image of a known format (EXR, PNG, JPEG, TGA, HDR, PFM, QOI, WebP)");
}

}  // namespace

void require_file(const std::filesystem::path& file, const SourceLocation& where) {
    std::error_code error;
    const auto status = std::filesystem::status(file, error);
    if (error) throw_unopenable(file, where, error.value());
    if (std::filesystem::is_directory(status)) throw_unopenable(file, where, EISDIR);
    // Pipes and devices are refused: they would block or never end.
    if (!std::filesystem::is_regular_file(status))
        throw_unreadable(file, where, "it is not a regular file");
}

ImageFormat detect_image_format(const std::filesystem::path& file, const SourceLocation& where) {
    return format_of(first_bytes(file, where), file, where);
}

namespace {

std::vector<uint8_t> read_bytes(const std::filesystem::path& file) {
    constexpr std::uintmax_t kLargestFile = std::uintmax_t(1) << 32;
    const auto size = std::filesystem::file_size(file);
    if (size > kLargestFile) throw DecodeError("the file is larger than 4 GiB");
    const MemoryReservation room(size, "the file's bytes");
    std::vector<uint8_t> bytes(size);
    std::ifstream stream(file, std::ios::binary);
    if (!stream.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(size)))
        throw DecodeError(std::generic_category().message(errno ? errno : EIO));
    return bytes;
}

PlainImage decode(Bytes bytes, ImageFormat format) {
    switch (format) {
        case ImageFormat::png:
            return decode_png(bytes);
        case ImageFormat::jpeg:
            return decode_jpeg(bytes);
        case ImageFormat::targa:
            return decode_targa(bytes);
        case ImageFormat::hdr:
            return decode_hdr(bytes);
        case ImageFormat::pnm:
            return decode_pnm(bytes);
        case ImageFormat::qoi:
            return decode_qoi(bytes);
        case ImageFormat::webp:
            return decode_webp(bytes);
        case ImageFormat::exr:
            break;
    }
    throw DecodeError("EXR is not a plain image");
}

/// Runs a decoder and turns its exceptions into errors that name the file.
template <typename Decode>
PlainImage with_name(const std::filesystem::path& file, const SourceLocation& where,
                     Decode decode_it) {
    try {
        return decode_it();
    } catch (const std::bad_alloc&) {
        throw_unreadable(file, where, "not enough memory", ErrorKind::limit);
    } catch (const Error& e) {
        throw_unreadable(file, where, e.what(), e.kind());
    } catch (const std::exception& e) {
        throw_unreadable(file, where, e.what());
    }
}

}  // namespace

PlainImage read_plain(const std::filesystem::path& file, ImageFormat format,
                      const SourceLocation& where) {
    return with_name(file, where, [&] { return decode(read_bytes(file), format); });
}

PlainImage decode_plain(std::string_view bytes, const std::filesystem::path& name,
                        const SourceLocation& where) {
    const ImageFormat format = format_of(bytes, name, where);
    const Bytes all(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
    return with_name(name, where, [&] { return decode(all, format); });
}

std::string one_line(const std::string& text) {
    constexpr size_t kLongest = 1000, kEnd = kLongest / 4;
    std::string line;
    const std::string shortened =
        text.size() <= kLongest
            ? text
            : text.substr(0, kLongest - kEnd) + " ... " + text.substr(text.size() - kEnd);
    // Unprintable bytes are replaced: names in a damaged file may hold any, a terminal and JSON may
    // not.
    for (const char c : shortened)
        if (c >= 0x20 && c <= 0x7e)
            line += c;
        else if (!line.empty() && line.back() != ' ')
            line += ' ';
    line.erase(line.find_last_not_of(" .") + 1);
    return line;
}

void throw_unreadable(const std::filesystem::path& file, const SourceLocation& where,
                      const std::string& reason, ErrorKind kind) {
    throw Error(kind, where, "cannot read '" + file.string() + "': " + one_line(reason));
}

std::string in_words(const std::filesystem::path& file, int64_t width, int64_t height) {
    return "'" + file.string() + "' of " + std::to_string(width) + "x" + std::to_string(height) +
           " pixels";
}

}  // namespace covtrace
