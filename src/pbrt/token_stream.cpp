#include "pbrt/token_stream.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

#include "scene/names.h"
#include "scene/scene_files.h"

namespace covtrace {

namespace fs = std::filesystem;

namespace {

std::string described(const Token& t) {
    switch (t.kind) {
        case Token::Kind::string:
            return "the string " + in_quotes(t.text);
        case Token::Kind::end:
            return "the end of the file";
        default:
            return in_quotes(t.text);
    }
}

[[noreturn]] void expected(const Token& found, std::string_view what) {
    throw Error(ErrorKind::scene, found.where(),
                "expected " + std::string(what) + ", found " + described(found));
}

template <typename T>
T parse(const Token& token, std::string_view what) {
    if (token.kind != Token::Kind::word) expected(token, what);
    std::string_view digits = token.text;
    if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
    T value{};
    const auto [rest, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (rest != digits.data() + digits.size() || error == std::errc::invalid_argument)
        expected(token, what);
    if (error == std::errc::result_out_of_range) {
        if constexpr (!std::is_integral_v<T>) {
            long double wide = 0;
            std::from_chars(digits.data(), digits.data() + digits.size(), wide);
            if (std::abs(wide) < 1) return 0;
        }
        throw Error(ErrorKind::scene, token.where(),
                    "the number " + in_quotes(token.text) + " is too large");
    }
    if constexpr (!std::is_integral_v<T>)
        if (!std::isfinite(value))
            throw Error(ErrorKind::scene, token.where(),
                        in_quotes(token.text) + " is not a finite number");
    return value;
}

}  // namespace

double parse_number(const Token& token) {
    return parse<double>(token, "a number");
}
float parse_float(const Token& token) {
    return parse<float>(token, "a number");
}
int parse_integer(const Token& token) {
    return parse<int>(token, "an integer");
}

TokenStream::TokenStream(std::string text, std::string name, SceneFiles& files, OpenFiles outer)
    : files_(files), open_files_(std::move(outer)) {
    auto shared = std::make_shared<const std::string>(std::move(name));
    open_files_.emplace_back(*shared);
    sources_.push_back(std::make_unique<Source>(std::move(text), std::move(shared)));
}

TokenStream::TokenStream(const std::string& file, const SourceLocation& where, SceneFiles& files,
                         const OpenFiles& outer)
    : files_(files), open_files_(outer) {
    open(file, where);
}

void TokenStream::open(const std::string& file, const SourceLocation& where) {
    const fs::path path = files_.find(file, where);
    std::error_code ignored;
    const fs::path identity = fs::weakly_canonical(path, ignored);
    const auto is_same = [&](const fs::path& p) {
        return fs::weakly_canonical(p, ignored) == identity;
    };
    if (std::any_of(open_files_.begin(), open_files_.end(), is_same))
        throw Error(ErrorKind::scene, where, "file " + path_in_quotes(file) + " includes itself");
    if (open_files_.size() >= kDeepestInclude)
        throw Error(ErrorKind::scene, where,
                    "files are included more than " + std::to_string(kDeepestInclude) + " deep");
    std::string text = files_.read(path, where);
    open_files_.push_back(path);
    sources_.push_back(std::make_unique<Source>(
        std::move(text), std::make_shared<const std::string>(path.string())));
}

Token TokenStream::raw_next() {
    for (;;) {
        Token token = sources_.back()->tokens.next();
        if (token.kind != Token::Kind::end || sources_.size() == 1) return token;
        ended_ = std::move(sources_.back());
        sources_.pop_back();
        open_files_.pop_back();
    }
}

Token TokenStream::next() {
    if (peeked_) {
        const Token token = *peeked_;
        peeked_.reset();
        return token;
    }
    for (;;) {
        const Token token = raw_next();
        if (!token.is_word("Include")) return token;
        const Token name = raw_next();
        if (name.kind != Token::Kind::string) expected(name, "a quoted file name after Include");
        open(std::string(name.text), name.where());
    }
}

const Token& TokenStream::peek() {
    if (!peeked_) peeked_ = next();
    return *peeked_;
}

std::string TokenStream::expect_string(std::string_view what) {
    const Token token = next();
    if (token.kind != Token::Kind::string) expected(token, what);
    return std::string(token.text);
}

double TokenStream::expect_number(std::string_view what) {
    const Token token = next();
    if (token.kind != Token::Kind::word) expected(token, what);
    return parse_number(token);
}

void TokenStream::expect(Token::Kind kind, std::string_view what) {
    const Token token = next();
    if (token.kind != kind) expected(token, what);
}

}  // namespace covtrace
