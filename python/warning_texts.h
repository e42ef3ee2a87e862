/// Warnings as Python tells them: one text each, which begins with the place.
#pragma once

#include <string>
#include <vector>

#include "core/error.h"

namespace covtrace::python {

inline std::string text_of(const Warning& w) {
    const std::string where = w.where.to_string();
    return where.empty() ? w.text : where + ": " + w.text;
}

inline std::vector<std::string> texts_of(const Warnings& warnings) {
    std::vector<std::string> texts;
    for (const Warning& w : warnings) texts.push_back(text_of(w));
    return texts;
}

}  // namespace covtrace::python
