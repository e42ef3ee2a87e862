#include "pbrt/tokenizer.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "pbrt/token_stream.h"

namespace covtrace {
namespace {

struct Copy {
    Token::Kind kind;
    std::string text;
    int line, column;
    bool operator==(const Copy&) const = default;
};

std::vector<Copy> tokens_of(std::string_view text) {
    Tokenizer t(text, std::make_shared<const std::string>("t.pbrt"));
    std::vector<Copy> all;
    for (Token k = t.next(); k.kind != Token::Kind::end; k = t.next())
        all.push_back({k.kind, std::string(k.text), k.line, k.column});
    return all;
}

constexpr auto word = Token::Kind::word;
constexpr auto string = Token::Kind::string;
constexpr auto open_bracket = Token::Kind::open_bracket;
constexpr auto close_bracket = Token::Kind::close_bracket;

TEST(SceneTokenizer, GivesEveryTokenItsPlace) {
    const auto t =
        tokens_of("Shape \"sphere\"\n  \"float radius\" [ 2.5 ]# end\r\n\n\tScale 1 2 3");
    const std::vector<Copy> expected{
        {word, "Shape", 1, 1},      {string, "sphere", 1, 7}, {string, "float radius", 2, 3},
        {open_bracket, "[", 2, 18}, {word, "2.5", 2, 20},     {close_bracket, "]", 2, 24},
        {word, "Scale", 4, 2},      {word, "1", 4, 8},        {word, "2", 4, 10},
        {word, "3", 4, 12}};
    EXPECT_EQ(t, expected);
}

TEST(SceneTokenizer, NeedsNoBlanksBetweenTokens) {
    const auto t = tokens_of("\"a\"[1\"b\"]x");
    const std::vector<Copy> expected{{string, "a", 1, 1},        {open_bracket, "[", 1, 4},
                                     {word, "1", 1, 5},          {string, "b", 1, 6},
                                     {close_bracket, "]", 1, 9}, {word, "x", 1, 10}};
    EXPECT_EQ(t, expected);
}

TEST(SceneTokenizer, DecodesEscapes) {
    const auto t = tokens_of(R"("a\\b\"c\n\t\'" "plain")");
    ASSERT_EQ(t.size(), 2u);
    EXPECT_EQ(t[0].text, "a\\b\"c\n\t'");
    EXPECT_EQ(t[1].text, "plain");
}

TEST(SceneTokenizer, KeepsCommentCharactersInStrings) {
    const auto t = tokens_of("\"a#b\" # \"not this\n\"c\"");
    ASSERT_EQ(t.size(), 2u);
    EXPECT_EQ(t[0].text, "a#b");
    EXPECT_EQ(t[1].text, "c");
}

TEST(SceneTokenizer, SkipsTheByteOrderMark) {
    const auto t = tokens_of("\xef\xbb\xbfWorldBegin");
    ASSERT_EQ(t.size(), 1u);
    EXPECT_EQ(t[0], (Copy{word, "WorldBegin", 1, 1}));
}

std::string error_of(std::string_view text) {
    try {
        tokens_of(text);
    } catch (const Error& e) {
        return e.what();
    }
    return "no error";
}

TEST(SceneTokenizer, RefusesBrokenStringsWithTheirPlace) {
    EXPECT_TRUE(
        error_of("\n \"open\nnext\"").starts_with("t.pbrt:2:2: unterminated string \"open\""));
    EXPECT_TRUE(error_of("\"ends").starts_with("t.pbrt:1:1: unterminated string"));
    EXPECT_TRUE(error_of("\"ends\\").starts_with("t.pbrt:1:1: unterminated string"));
    EXPECT_TRUE(error_of("x \"a\\q\"").starts_with("t.pbrt:1:5: unknown escape \"\\q\""));
    EXPECT_TRUE(error_of("\xff\xfeW").starts_with("t.pbrt:1:1: the file is UTF-16"));
}

float number(std::string_view text) {
    Tokenizer t(text, std::make_shared<const std::string>("t.pbrt"));
    return parse_float(t.next());
}

TEST(SceneTokenizer, ReadsNumbersAsPbrtWritesThem) {
    EXPECT_EQ(number("1"), 1.0f);
    EXPECT_EQ(number("+2.5"), 2.5f);
    EXPECT_EQ(number("-.5"), -0.5f);
    EXPECT_EQ(number("3."), 3.0f);
    EXPECT_EQ(number("4.37114e-8"), 4.37114e-8f);
    EXPECT_EQ(number("1E3"), 1000.0f);
    EXPECT_EQ(number("-0"), 0.0f);
    EXPECT_EQ(number("1e-60"), 0.0f);
}

TEST(SceneTokenizer, RefusesWhatIsNoFiniteNumber) {
    for (const char* text : {"nan", "inf", "-inf", "infinity", "1e60", "1x", "0x10", "--1", "+-1",
                             "1,5", "", "\"1\"", "[", "-", "+", "e5", "1e", "true"})
        EXPECT_THROW(number(text), Error) << text;
}

TEST(SceneTokenizer, RefusesIntegersThatAreNone) {
    for (const char* text : {"1.5", "3000000000", "1e3", "x", "", "\"1\""}) {
        Tokenizer t(text, nullptr);
        EXPECT_THROW(parse_integer(t.next()), Error) << text;
    }
    Tokenizer t("-2147483648 +7", nullptr);
    EXPECT_EQ(parse_integer(t.next()), -2147483647 - 1);
    EXPECT_EQ(parse_integer(t.next()), 7);
}

}  // namespace
}  // namespace covtrace
