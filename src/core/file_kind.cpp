#include "core/file_kind.h"

#include <system_error>

namespace covtrace {

std::string irregular_kind(const std::filesystem::path& file) {
    using enum std::filesystem::file_type;
    std::error_code ignored;
    switch (std::filesystem::status(file, ignored).type()) {
        case directory:
            return "a folder";
        case fifo:
            return "a named pipe";
        case socket:
            return "a socket";
        case block:
        case character:
            return "a device";
        default:
            return {};
    }
}

}  // namespace covtrace
