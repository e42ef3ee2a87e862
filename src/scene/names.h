/// Wording of messages about names: printable excerpts, lists, and guesses at the name that was
/// meant.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace covtrace {

/// Length in characters from which on texts are cut in messages, except for file names.
inline constexpr size_t kLongestExcerpt = 60;

/// The text in double quotes, shortened, with control characters replaced.
std::string in_quotes(std::string_view text, size_t longest = kLongestExcerpt);
std::string path_in_quotes(const std::string& path);
/// The names as a list "a, b, c"; at most a dozen.
std::string listed(const std::vector<std::string>& names);
/// Text such as `; did you mean "x" or "y"?`, for candidates close to `name`, else empty.
std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates);
/// Text such as `unknown shape "teapot"; expected one of sphere, disk; did you mean …?`.
std::string unknown_name(std::string_view what, std::string_view name,
                         const std::vector<std::string>& known);

}  // namespace covtrace
