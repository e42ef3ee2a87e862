/// Messages on standard error. A message that cannot be written (a closed terminal, a full disk
/// behind a redirection) is lost; it must not end a render.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <utility>

#include "core/error.h"

namespace covtrace::cli {

/// Writes a message as it is: the caller ends its lines.
template <typename... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
    const std::string text = fmt::format(format, std::forward<Args>(args)...);
    std::fwrite(text.data(), 1, text.size(), stderr);
}

/// The text of a warning, behind its place.
inline std::string to_text(const Warning& w) {
    const std::string where = w.where.to_string();
    return where.empty() ? w.text : where + ": " + w.text;
}

inline void print_warnings(const Warnings& warnings) {
    for (const Warning& w : warnings) say("warning: {}\n", to_text(w));
}

}  // namespace covtrace::cli
