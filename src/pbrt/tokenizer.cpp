#include "pbrt/tokenizer.h"

#include <array>

#include "scene/names.h"

namespace covtrace {

namespace {

constexpr bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

constexpr std::array<bool, 256> word_ends() {
    std::array<bool, 256> ends{};
    for (const char c : {' ', '\t', '\r', '\n', '"', '[', ']'})
        ends[static_cast<unsigned char>(c)] = true;
    return ends;
}
constexpr std::array<bool, 256> kWordEnds = word_ends();

}  // namespace

Tokenizer::Tokenizer(std::string_view text, SharedName file) : text_(text), file_(std::move(file)) {
    if (text_.starts_with("\xef\xbb\xbf")) {
        position_ = line_start_ = 3;
    } else if (text_.starts_with("\xff\xfe") || text_.starts_with("\xfe\xff")) {
        throw Error(ErrorKind::scene, {file_, 1, 1},
                    "the file is UTF-16; expected UTF-8 or ASCII text");
    }
}

Token Tokenizer::next() {
    for (; position_ < text_.size(); ++position_) {
        const char c = text_[position_];
        if (c == '\n') {
            ++line_;
            line_start_ = position_ + 1;
        } else if (c == '#') {
            while (position_ + 1 < text_.size() && text_[position_ + 1] != '\n') ++position_;
        } else if (!is_blank(c)) {
            break;
        }
    }
    Token token;
    token.file = &file_;
    token.line = line_;
    token.column = static_cast<int>(position_ - line_start_) + 1;
    if (position_ == text_.size()) return token;

    const char c = text_[position_];
    if (c == '"') return string_token(token);
    const size_t start = position_++;
    if (c == '[' || c == ']') {
        token.kind = c == '[' ? Token::Kind::open_bracket : Token::Kind::close_bracket;
    } else {
        token.kind = Token::Kind::word;
        while (position_ < text_.size() && !kWordEnds[static_cast<unsigned char>(text_[position_])])
            ++position_;
    }
    token.text = text_.substr(start, position_ - start);
    return token;
}

Token Tokenizer::string_token(Token token) {
    token.kind = Token::Kind::string;
    const size_t start = ++position_;
    bool escaped = false;
    for (; position_ < text_.size(); ++position_) {
        const char c = text_[position_];
        if (c == '"') {
            const size_t end = position_++;
            token.text = text_.substr(start, end - start);
            if (!escaped) return token;
            decoded_.clear();
            for (size_t i = start; i < end; ++i) {
                const bool is_escape = text_[i] == '\\';
                decoded_ += is_escape ? decoded_escape(text_[i + 1], i) : text_[i];
                i += is_escape;
            }
            token.text = decoded_;
            return token;
        }
        if (c == '\n') break;
        if (c == '\\') {
            escaped = true;
            ++position_;
        }
    }
    throw Error(ErrorKind::scene, token.where(),
                "unterminated string " + in_quotes(text_.substr(start, position_ - start)) +
                    "; expected a closing quote on the same line");
}

char Tokenizer::decoded_escape(char c, size_t at) const {
    switch (c) {
        case 'b':
            return '\b';
        case 'f':
            return '\f';
        case 'n':
            return '\n';
        case 'r':
            return '\r';
        case 't':
            return '\t';
        case '\\':
        case '\'':
        case '"':
            return c;
        default:
            throw Error(ErrorKind::scene, {file_, line_, static_cast<int>(at - line_start_) + 1},
                        "unknown escape " + in_quotes(std::string("\\") + c) +
                            " in a string; write \\\\ for a backslash, or / in file names");
    }
}

}  // namespace covtrace
