/// Errors and warnings. Libraries throw `Error` while loading and collect `Warning`s; they never
/// print or exit.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace covtrace {

/// A place in a text file; line and column count from 1, 0 means unknown.
struct SourceLocation {
    std::shared_ptr<const std::string> file;
    int line = 0;
    int column = 0;
    /// "file:line:column", without the parts that are unknown; empty where there is no file.
    std::string to_string() const;
};

/// Kinds of errors; the command line maps each to one exit code (docs/reference/exit-codes.md).
enum class ErrorKind {
    usage,        ///< exit code 2
    scene,        ///< exit code 3: the scene or an input that it names is wrong or missing
    limit,        ///< exit code 4: memory or size
    io,           ///< exit code 5: reading or writing failed in the middle
    interrupted,  ///< exit code 6
    internal      ///< exit code 7
};

/// An option as its field is called, "max_spp". Front ends spell it in their own way.
struct OptionName {
    std::string_view field;
};

class Error : public std::runtime_error {
  public:
    Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
    /// Makes an error whose message is prefixed with the location.
    Error(ErrorKind kind, const SourceLocation& where, const std::string& message);
    /// An option's value is refused; what() begins with "max_spp: ".
    Error(ErrorKind kind, OptionName option, const std::string& message);
    ErrorKind kind() const { return kind_; }
    /// The field of the option that is refused; empty where no option is at fault.
    const std::string& option() const { return option_; }

  private:
    ErrorKind kind_;
    std::string option_;
};

struct Warning {
    SourceLocation where;
    std::string text;
};
using Warnings = std::vector<Warning>;

}  // namespace covtrace
