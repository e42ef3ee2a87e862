/// Wording of messages about names: printable excerpts, lists, and guesses at what was meant.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace covtrace {

/// The text in double quotes, shortened, with bytes that are not printable replaced.
std::string in_quotes(std::string_view text);
/// "a, b, c"; at most a dozen.
std::string listed(const std::vector<std::string>& names);
/// `; did you mean "x" or "y"?` for candidates close to `name`, else empty.
std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates);
/// `unknown shape "teapot"; expected one of sphere, disk; did you mean …?`
std::string unknown_name(std::string_view what, std::string_view name,
                         const std::vector<std::string>& known);

}  // namespace covtrace
