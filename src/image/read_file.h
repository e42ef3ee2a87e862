/// Private to this folder: from a path to pixels. All functions throw Error(scene) with the place
/// `where` and one line that names the file; Error(limit) where memory does not suffice.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "image/image.h"
#include "image/plain_image.h"

namespace covtrace {

/// Kinds of files by their first bytes; Targa has no signature and goes by the file's name.
enum class ImageFormat { exr, png, jpeg, targa, hdr, pnm, qoi, webp };

/// Throws where the file is not there, or is a folder, a pipe or a device.
void require_file(const std::filesystem::path& file, const SourceLocation& where);

/// Opens the file and looks at its first bytes.
ImageFormat detect_image_format(const std::filesystem::path& file, const SourceLocation& where);

/// Reads a file of any format but EXR.
PlainImage read_plain(const std::filesystem::path& file, ImageFormat format,
                      const SourceLocation& where);

/// Decodes a file in memory, which messages call `name`, of any format but EXR.
PlainImage decode_plain(std::string_view bytes, const std::filesystem::path& name,
                        const SourceLocation& where);

/// Chooses among the names of an EXR's channels: returns those that are wanted, in any order.
using ChannelChoice = std::function<std::vector<std::string>(const std::vector<std::string>&)>;

/// Reads all parts of an EXR, their channels in the order of the file. Channels that are not chosen
/// have a name and no values.
Image read_exr(const std::filesystem::path& file, const SourceLocation& where,
               const ChannelChoice& choose = {});

/// A library's message on one line of ASCII, without its full stop. Of more than 1000 bytes it has
/// the beginning and the end, with ' ... ' between: what is wrong may stand in either.
std::string one_line(const std::string& text);

/// Throws "cannot read 'file': reason", the reason on one line of ASCII. Error(limit) for limits.
[[noreturn]] void throw_unreadable(const std::filesystem::path& file, const SourceLocation& where,
                                   const std::string& reason, ErrorKind kind = ErrorKind::scene);

/// Text such as "'file' of 3x2 pixels", for what is made of an image.
std::string in_words(const std::filesystem::path& file, int64_t width, int64_t height);

}  // namespace covtrace
