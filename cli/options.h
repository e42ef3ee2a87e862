/// Kinds of options that several commands have. Wrong values throw Error(usage), whose message
/// begins with the option's name.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <optional>
#include <string>

#include "cli/values.h"
#include "core/enum_names.h"
#include "core/error.h"

namespace covtrace::cli {

/// The value that has this name. Throws Error(usage) that lists all names.
template <NamedEnum Enum>
Enum choice(const std::string& option, const std::string& text) {
    if (const auto value = value_named<Enum>(text)) return *value;
    throw Error(ErrorKind::usage,
                option + ": '" + text + "' is none of " + listed_names<Enum>("|"));
}

/// Adds an option that takes one of a few names; without it the value stays empty.
template <NamedEnum Enum>
void add_choice(CLI::App* c, const std::string& name, std::optional<Enum>& value,
                const std::string& help) {
    const auto choose = [name, &value](const std::string& text) {
        value = choice<Enum>(name, text);
    };
    c->add_option_function<std::string>(name, choose, help)->option_text(listed_names<Enum>("|"));
}

/// Adds an option that takes one of a few names; without it the value keeps its default.
template <NamedEnum Enum>
void add_choice(CLI::App* c, const std::string& name, Enum& value, const std::string& help) {
    const auto choose = [name, &value](const std::string& text) {
        value = choice<Enum>(name, text);
    };
    c->add_option_function<std::string>(name, choose, help)->option_text(listed_names<Enum>("|"));
}

/// Adds an option that takes a number above zero, not below `least` and up to `most`.
template <typename T>
void add_positive(CLI::App* c, const std::string& name, std::optional<T>& value, double most,
                  const std::string& help, double least = 0) {
    const auto parse = [name, &value, most, least](const std::string& text) {
        value = static_cast<T>(parse_positive(name, text, most, least));
    };
    c->add_option_function<std::string>(name, parse, help)->option_text("N");
}

/// Adds an option that takes a whole number in [least, most]; T may be optional. CLI11 itself would
/// read 010 as eight.
template <typename T>
void add_whole(CLI::App* c, const std::string& name, T& value, int64_t least, int64_t most,
               const std::string& help) {
    const auto parse = [name, &value, least, most](const std::string& text) {
        value = T(parse_whole(name, text, least, most));
    };
    c->add_option_function<std::string>(name, parse, help)->option_text("N");
}

/// A check that refuses empty text, as of an unset shell variable, for options that are parsed
/// later.
inline CLI::Validator not_empty() {
    const auto check = [](const std::string& text) {
        return text.empty() ? std::string("expected a value") : std::string();
    };
    return CLI::Validator(check, "");
}

}  // namespace covtrace::cli
