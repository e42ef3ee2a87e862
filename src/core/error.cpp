#include "core/error.h"

namespace covtrace {

std::string SourceLocation::to_string() const {
    if (!file) return {};
    std::string s = *file;
    if (line > 0) s += ":" + std::to_string(line);
    if (line > 0 && column > 0) s += ":" + std::to_string(column);
    return s;
}

Error::Error(ErrorKind kind, const SourceLocation& where, const std::string& message)
    : std::runtime_error(where.file ? where.to_string() + ": " + message : message), kind_(kind) {}

Error::Error(ErrorKind kind, OptionName option, const std::string& message)
    : std::runtime_error(std::string(option.field) + ": " + message),
      kind_(kind),
      option_(option.field) {}

}  // namespace covtrace
