/// Splits pbrt-v4 text into tokens, each with its place.
///
/// Words (directives, numbers, true, false) end at blanks, quotes and brackets; strings are in
/// double quotes on one line, with the escapes \b \f \n \r \t \\ \' \"; "#" starts a comment up to
/// the line's end.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "core/error.h"

namespace covtrace {

using SharedName = std::shared_ptr<const std::string>;

struct Token {
    enum class Kind { word, string, open_bracket, close_bracket, end };
    Kind kind = Kind::end;
    /// The token's text, without quotes, escapes decoded. Valid until the tokenizer is asked for
    /// the next one.
    std::string_view text;
    int line = 0, column = 0;  ///< from 1; columns count bytes
    SharedName const* file = nullptr;

    SourceLocation where() const { return {file ? *file : nullptr, line, column}; }
    bool is_word(std::string_view w) const { return kind == Kind::word && text == w; }
};

class Tokenizer {
  public:
    /// Begins at the start of `text`, which must outlive the tokenizer. Errors: Error(scene) where
    /// the text is UTF-16.
    Tokenizer(std::string_view text, SharedName file);
    Tokenizer(const Tokenizer&) = delete;
    Tokenizer& operator=(const Tokenizer&) = delete;
    /// Reads the next token; one of kind `end` after the last one. Errors: Error(scene) for broken
    /// strings.
    Token next();

  private:
    Token string_token(Token token);
    char decoded_escape(char c, size_t at) const;

    std::string_view text_;
    SharedName file_;
    size_t position_ = 0;
    size_t line_start_ = 0;
    int line_ = 1;
    std::string decoded_;
};

}  // namespace covtrace
