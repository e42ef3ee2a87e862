#include "viewer/page.h"

#include <charconv>
#include <cstdint>
#include <vector>

#include "core/base64.h"
#include "core/error.h"

namespace covtrace::viewer {

namespace {

std::string base64_of_hex(std::string_view digits) {
    std::vector<uint8_t> bytes(digits.size() / 2);
    for (size_t i = 0; i < bytes.size(); ++i)
        std::from_chars(&digits[2 * i], &digits[2 * i] + 2, bytes[i], 16);
    return base64(bytes);
}

void replace(std::string& text, std::string_view mark, const std::string& by) {
    const size_t at = text.find(mark);
    if (at == std::string::npos)
        throw Error(ErrorKind::internal, "the viewer's page lacks " + std::string(mark));
    text.replace(at, mark.size(), by);
}

}  // namespace

PageFrame page_frame() {
    constexpr std::string_view kData = "@DATA@";
    std::string page;
    for (std::string_view piece : kPage.pieces) page += piece;
    replace(page, "@SCRIPT_HASH@", base64_of_hex(kPage.script_sha256));
    replace(page, "@STYLE_HASH@", base64_of_hex(kPage.style_sha256));
    const size_t at = page.find(kData);
    if (at == std::string::npos) throw Error(ErrorKind::internal, "the viewer's page lacks @DATA@");
    return {page.substr(0, at), page.substr(at + kData.size())};
}

}  // namespace covtrace::viewer
