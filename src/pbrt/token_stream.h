/// The tokens of a file and of all files it includes, as one sequence.
///
/// `Include "file"` is replaced by the file's tokens wherever it stands, also in the middle of a
/// parameter list, and a list may go on after the end of the included file.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pbrt/tokenizer.h"

namespace covtrace {

class SceneFiles;

/// Files that are being read, from the main file inwards; guards against endless inclusion.
using OpenFiles = std::vector<std::filesystem::path>;

class TokenStream {
  public:
    static constexpr size_t kDeepestInclude = 64;

    /// Reads from memory; messages call the text `name`.
    TokenStream(std::string text, std::string name, SceneFiles& files, OpenFiles outer = {});
    /// Opens a file that `outer` names at `where`.
    TokenStream(const std::string& file, const SourceLocation& where, SceneFiles& files,
                const OpenFiles& outer);

    /// The next token; its text is valid until the next call. Errors: Error(scene) from files and
    /// tokens.
    Token next();
    /// Looks at the next token, which stays the next one.
    const Token& peek();
    /// Reads a string; throws an error that names what was expected where the next token is none.
    std::string expect_string(std::string_view what);
    /// Reads a finite number; throws an error where the next token is none.
    double expect_number(std::string_view what);
    void expect(Token::Kind kind, std::string_view what);

    const OpenFiles& open_files() const { return open_files_; }

  private:
    struct Source {
        std::string text;
        Tokenizer tokens;
        Source(std::string t, SharedName name)
            : text(std::move(t)), tokens(text, std::move(name)) {}
    };
    void open(const std::string& file, const SourceLocation& where);
    Token raw_next();

    SceneFiles& files_;
    OpenFiles open_files_;
    std::vector<std::unique_ptr<Source>> sources_;
    /// The last source that ended: tokens may still point into it.
    std::unique_ptr<Source> ended_;
    std::optional<Token> peeked_;
};

/// A finite number written as pbrt allows (an optional sign, decimals, exponent).
/// Errors: Error(scene) at the token.
double parse_number(const Token& token);
float parse_float(const Token& token);
int parse_integer(const Token& token);

}  // namespace covtrace
