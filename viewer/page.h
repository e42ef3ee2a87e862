/// The page as it was embedded, and its pieces put together; private to this folder.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace covtrace::viewer {

/// The page with @DATA@, @SCRIPT_HASH@ and @STYLE_HASH@ to be filled in, cut into pieces, with the
/// hashes (SHA-256 in hexadecimal digits) of the inline script and the style sheet.
struct PageTemplate {
    std::span<const std::string_view> pieces;
    std::string_view script_sha256, style_sha256;
};
extern const PageTemplate kPage;

/// The text before and behind the data, with its content security policy.
struct PageFrame {
    std::string before, behind;
};
PageFrame page_frame();

}  // namespace covtrace::viewer
