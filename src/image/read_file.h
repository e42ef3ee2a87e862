/// Private to this folder: from a path to pixels. All functions throw Error(scene) with the place
/// `where` and one line that names the file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/error.h"
#include "image/image.h"
#include "image/plain_image.h"

namespace covtrace {

/// Kinds of files by their first bytes; Targa has no signature and goes by the file's name.
enum class ImageFormat { exr, png, jpeg, targa, hdr, pnm, qoi };

/// Opens the file and looks at its first bytes.
ImageFormat detect_image_format(const std::filesystem::path& file, const SourceLocation& where);

/// Every format but EXR.
PlainImage read_plain(const std::filesystem::path& file, ImageFormat format,
                      const SourceLocation& where);

/// The same of a file in memory, which messages call `name`.
PlainImage decode_plain(std::string_view bytes, const std::filesystem::path& name,
                        const SourceLocation& where);

/// All parts of an EXR, their channels in the order of the file.
Image read_exr(const std::filesystem::path& file, const SourceLocation& where);

/// "cannot read 'file': reason", the reason on one line of ASCII.
[[noreturn]] void throw_unreadable(const std::filesystem::path& file, const SourceLocation& where,
                                   const std::string& reason);

}  // namespace covtrace
