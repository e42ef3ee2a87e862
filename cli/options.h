/// Kinds of options that several commands have. Wrong values throw Error(usage), whose message
/// begins with the option's name.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <optional>
#include <string>

#include "cli/values.h"
#include "core/error.h"

namespace covtrace::cli {

/// One of a few names.
template <typename T>
void add_choice(CLI::App* c, const std::string& name, T& value,
                const std::map<std::string, T>& choices, const std::string& help) {
    std::string names;
    for (const auto& [choice, unused] : choices) names += (names.empty() ? "" : "|") + choice;
    const auto choose = [name, &value, choices, names](const std::string& text) {
        const auto it = choices.find(text);
        if (it == choices.end())
            throw Error(ErrorKind::usage, name + ": '" + text + "' is none of " + names);
        value = it->second;
    };
    c->add_option_function<std::string>(name, choose, help)->option_text(names);
}

/// A number above zero, not below `least` and up to `most`.
template <typename T>
void add_positive(CLI::App* c, const std::string& name, std::optional<T>& value, double most,
                  const std::string& help, double least = 0) {
    const auto parse = [name, &value, most, least](const std::string& text) {
        value = static_cast<T>(parse_positive(name, text, most, least));
    };
    c->add_option_function<std::string>(name, parse, help)->option_text("N");
}

/// A whole number in [least, most]; T may be optional. CLI11 itself would read 010 as eight.
template <typename T>
void add_whole(CLI::App* c, const std::string& name, T& value, int64_t least, int64_t most,
               const std::string& help) {
    const auto parse = [name, &value, least, most](const std::string& text) {
        value = T(parse_whole(name, text, least, most));
    };
    c->add_option_function<std::string>(name, parse, help)->option_text("N");
}

/// Of options whose text is parsed later: an unset shell variable is no value.
inline CLI::Validator not_empty() {
    const auto check = [](const std::string& text) {
        return text.empty() ? std::string("expected a value") : std::string();
    };
    return CLI::Validator(check, "");
}

}  // namespace covtrace::cli
