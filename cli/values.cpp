#include "cli/values.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <string_view>
#include <vector>

namespace covtrace::cli {

namespace {

template <typename T>
bool take_number(std::string_view& text, T& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{}) return false;
    text.remove_prefix(static_cast<size_t>(end - text.data()));
    return true;
}

/// Exactly `count` numbers with `separator` between them.
template <typename T>
std::vector<T> parse_list(const std::string& text, size_t count, char separator, const char* expected) {
    std::string_view rest = text;
    std::vector<T> values(count);
    for (size_t i = 0; i < count; ++i) {
        const bool separated = i == 0 || (!rest.empty() && rest.front() == separator);
        if (separated && i > 0) rest.remove_prefix(1);
        if (!separated || !take_number(rest, values[i]))
            throw CLI::ValidationError("'" + text + "' is not " + expected);
    }
    if (!rest.empty()) throw CLI::ValidationError("'" + text + "' is not " + expected);
    return values;
}

}  // namespace

double parse_duration(const std::string& text) {
    std::string_view rest = text;
    double seconds = 0;
    bool any = false;
    while (!rest.empty()) {
        double value = 0;
        if (!take_number(rest, value) || !(value >= 0)) break;
        const char unit = rest.empty() ? 's' : rest.front();
        if (!rest.empty()) rest.remove_prefix(1);
        if (unit != 's' && unit != 'm' && unit != 'h') {
            any = false;
            break;
        }
        seconds += value * (unit == 'h' ? 3600 : (unit == 'm' ? 60 : 1));
        any = true;
    }
    if (!any || !rest.empty() || !(seconds > 0) || !(seconds < 1e9))
        throw CLI::ValidationError("'" + text + "' is not a duration such as 2.5, 45s, 3m or 1h30m");
    return seconds;
}

std::array<int, 2> parse_resolution(const std::string& text) {
    const auto v = parse_list<int>(text, 2, 'x', "a resolution such as 640x360");
    if (v[0] < 1 || v[1] < 1) throw CLI::ValidationError("'" + text + "' is not a resolution such as 640x360");
    return {v[0], v[1]};
}

PixelBounds parse_crop(const std::string& text) {
    const auto v = parse_list<int>(text, 4, ',', "a crop x0,y0,x1,y1 in pixels");
    return {v[0], v[1], v[2], v[3]};
}

std::array<float, 2> parse_pair(const std::string& text) {
    const auto v = parse_list<float>(text, 2, ',', "a pair of numbers such as 0,0.5");
    return {v[0], v[1]};
}

}  // namespace covtrace::cli
