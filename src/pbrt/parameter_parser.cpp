#include "pbrt/parameter_parser.h"

#include <array>
#include <utility>

#include "pbrt/token_stream.h"
#include "pbrt/version_three.h"
#include "scene/names.h"

namespace covtrace {

namespace {

constexpr std::array<std::pair<std::string_view, ParameterType>, 16> kTypes{{
    {"float", ParameterType::floats},
    {"integer", ParameterType::integer},
    {"bool", ParameterType::boolean},
    {"string", ParameterType::string},
    {"point2", ParameterType::point2},
    {"vector2", ParameterType::vector2},
    {"point3", ParameterType::point3},
    {"point", ParameterType::point3},
    {"vector3", ParameterType::vector3},
    {"vector", ParameterType::vector3},
    {"normal", ParameterType::normal3},
    {"normal3", ParameterType::normal3},
    {"rgb", ParameterType::rgb},
    {"blackbody", ParameterType::blackbody},
    {"spectrum", ParameterType::spectrum},
    {"texture", ParameterType::texture},
}};

ParameterType type_named(std::string_view name, const SourceLocation& where) {
    for (const auto& [known, type] : kTypes)
        if (name == known) return type;
    if (name == "color" || name == "xyz")
        throw version_three_error(where, "the parameter type " + in_quotes(name));
    std::vector<std::string> known;
    for (const auto& [n, type] : kTypes) known.emplace_back(n);
    throw Error(ErrorKind::scene, where, unknown_name("parameter type", name, known));
}

/// Splits a declaration "type name", with any blanks around the words, into type and name.
Parameter declaration(const Token& token, ColourSpace colour_space) {
    constexpr std::string_view blanks = " \t";
    const auto word = [&](std::string_view& rest) {
        rest.remove_prefix(std::min(rest.find_first_not_of(blanks), rest.size()));
        const std::string_view w = rest.substr(0, rest.find_first_of(blanks));
        rest.remove_prefix(w.size());
        return w;
    };
    std::string_view rest = token.text;
    const std::string_view type = word(rest), name = word(rest);
    if (name.empty())
        throw Error(ErrorKind::scene, token.where(),
                    "parameter declaration " + in_quotes(token.text) +
                        " is incomplete; expected \"type name\"");
    Parameter p;
    p.where = token.where();
    p.type = type_named(type, p.where);
    p.name = name;
    p.colour_space = colour_space;
    return p;
}

[[noreturn]] void wrong_value(const Parameter& p, const Token& value, std::string_view expected) {
    throw Error(ErrorKind::scene, value.where(),
                "value " + in_quotes(value.text) + " of parameter " + in_quotes(p.name) +
                    "; expected " + std::string(expected));
}

void add_value(Parameter& p, const Token& value) {
    const bool is_string = value.kind == Token::Kind::string;
    switch (p.type) {
        case ParameterType::boolean:
            if (value.text != "true" && value.text != "false")
                wrong_value(p, value, "true or false");
            p.integers.push_back(value.text == "true");
            return;
        case ParameterType::string:
        case ParameterType::texture:
            if (!is_string) wrong_value(p, value, "a quoted string");
            p.strings.emplace_back(value.text);
            return;
        case ParameterType::integer:
            if (is_string) wrong_value(p, value, "an integer");
            p.integers.push_back(parse_integer(value));
            return;
        case ParameterType::spectrum:
            if (is_string && p.numbers.empty()) {
                p.strings.emplace_back(value.text);
                return;
            }
            if (!p.strings.empty()) wrong_value(p, value, "one name only");
            [[fallthrough]];
        default:
            if (is_string) wrong_value(p, value, "a number");
            p.numbers.push_back(parse_float(value));
    }
}

}  // namespace

std::vector<Parameter> parse_parameters(TokenStream& tokens, ColourSpace colour_space) {
    std::vector<Parameter> all;
    while (tokens.peek().kind == Token::Kind::string) {
        Parameter p = declaration(tokens.next(), colour_space);
        Token value = tokens.next();
        if (value.kind == Token::Kind::open_bracket) {
            for (value = tokens.next(); value.kind != Token::Kind::close_bracket;
                 value = tokens.next()) {
                if (value.kind == Token::Kind::end || value.kind == Token::Kind::open_bracket)
                    throw Error(ErrorKind::scene, value.where(),
                                "the values of parameter " + in_quotes(p.name) + " that begin at " +
                                    p.where.to_string() + " have no closing bracket");
                add_value(p, value);
            }
        } else if (value.kind == Token::Kind::end || value.kind == Token::Kind::close_bracket) {
            throw Error(ErrorKind::scene, value.where(),
                        "parameter " + in_quotes(p.name) + " has no value");
        } else {
            add_value(p, value);
        }
        if (p.numbers.empty() && p.integers.empty() && p.strings.empty())
            throw Error(ErrorKind::scene, p.where,
                        "parameter " + in_quotes(p.name) + " has no value");
        all.push_back(std::move(p));
    }
    return all;
}

}  // namespace covtrace
