/// Names of an enum's values, in one table beside the enum. The command line, Python, films and
/// messages read the same table.
///
///     enum class Shape { round, flat };
///     template <>
///     inline constexpr auto kEnumNames<Shape> =
///         enum_names<Shape>({{Shape::round, "round"}, {Shape::flat, "flat"}});
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace covtrace {

template <typename Enum>
struct EnumName {
    Enum value;
    std::string_view name;
};

template <typename Enum, size_t N>
constexpr std::array<EnumName<Enum>, N> enum_names(const EnumName<Enum> (&names)[N]) {
    return std::to_array(names);
}

/// Every value of an enum once, in the order that help texts list.
template <typename Enum>
inline constexpr auto kEnumNames = nullptr;

template <typename Enum>
concept NamedEnum = requires {
    kEnumNames<Enum>.size();
};

/// The name of a value that the table has.
template <NamedEnum Enum>
constexpr std::string_view name_of(Enum value) {
    for (const auto& [listed, name] : kEnumNames<Enum>)
        if (listed == value) return name;
    return {};
}

/// Whether two texts are the same but for capital letters of ASCII: people write "AgX".
constexpr bool is_same_name(std::string_view a, std::string_view b) {
    const auto small = [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; };
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [small](char x, char y) { return small(x) == small(y); });
}

/// The value of a name; none where the table does not have it.
template <NamedEnum Enum>
constexpr std::optional<Enum> value_named(std::string_view text) {
    for (const auto& [value, name] : kEnumNames<Enum>)
        if (is_same_name(name, text)) return value;
    return std::nullopt;
}

/// All names, each between `quote`s, with `separator` between them: "uniform|covariance|hybrid".
template <NamedEnum Enum>
std::string listed_names(std::string_view separator, std::string_view quote = "") {
    std::string all;
    for (const auto& [value, name] : kEnumNames<Enum>)
        all.append(all.empty() ? "" : separator).append(quote).append(name).append(quote);
    return all;
}

}  // namespace covtrace
