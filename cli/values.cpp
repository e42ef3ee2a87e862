#include "cli/values.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <system_error>
#include <vector>

#include "core/enum_names.h"
#include "core/error.h"

namespace covtrace::cli {

namespace {

template <typename T>
bool take_number(std::string_view& text, T& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{}) return false;
    text.remove_prefix(static_cast<size_t>(end - text.data()));
    return true;
}

char small_letter(char c) {
    return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
}

[[noreturn]] void refuse(const std::string& option, const std::string& text,
                         const std::string& expected) {
    throw Error(ErrorKind::usage, option + ": '" + text + "' is not " + expected);
}

/// Exactly N numbers with `separator` between them; empty for any other text.
template <typename T, size_t N>
std::optional<std::array<T, N>> list_of(std::string_view rest, char separator) {
    std::array<T, N> values{};
    for (size_t i = 0; i < N; ++i) {
        const bool separated = i == 0 || (!rest.empty() && small_letter(rest.front()) == separator);
        if (separated && i > 0) rest.remove_prefix(1);
        if (!separated || !take_number(rest, values[i])) return std::nullopt;
    }
    return rest.empty() ? std::optional(values) : std::nullopt;
}

/// Reads exactly N numbers with `separator` between them.
template <typename T, size_t N>
std::array<T, N> parse_list(const std::string& option, const std::string& text, char separator,
                            const char* expected) {
    const auto values = list_of<T, N>(text, separator);
    if (!values) refuse(option, text, expected);
    return *values;
}

}  // namespace

double parse_duration(const std::string& option, const std::string& text) {
    constexpr auto kExpected = "a duration such as 2.5, 45s, 3m or 1h30m";
    std::string_view rest = text;
    double seconds = 0;
    if (!take_number(rest, seconds) || !rest.empty()) {
        // Without a unit only a single number is clear: "1h30" could mean minutes or seconds.
        rest = text;
        seconds = 0;
        do {
            double value = 0;
            if (!take_number(rest, value) || !(value >= 0) || rest.empty())
                refuse(option, text, kExpected);
            const char unit = small_letter(rest.front());
            rest.remove_prefix(1);
            if (unit != 's' && unit != 'm' && unit != 'h') refuse(option, text, kExpected);
            seconds += value * (unit == 'h' ? 3600 : (unit == 'm' ? 60 : 1));
        } while (!rest.empty());
    }
    if (!(seconds > 0) || !(seconds < 1e9)) refuse(option, text, kExpected);
    return seconds;
}

std::array<int, 2> parse_resolution(const std::string& option, const std::string& text) {
    constexpr auto kExpected = "a resolution such as 640x360";
    const auto v = parse_list<int, 2>(option, text, 'x', kExpected);
    if (v[0] < 1 || v[1] < 1) refuse(option, text, kExpected);
    return v;
}

PixelBounds parse_crop(const std::string& option, const std::string& text) {
    constexpr auto kExpected = "a crop x0,y0,x1,y1 in pixels with x0 < x1 and y0 < y1";
    const auto v = parse_list<int, 4>(option, text, ',', kExpected);
    const PixelBounds crop{v[0], v[1], v[2], v[3]};
    if (crop.empty()) refuse(option, text, kExpected);
    return crop;
}

std::array<int, 2> parse_pixel(const std::string& option, const std::string& text) {
    return parse_list<int, 2>(option, text, ',', "a pixel x,y such as 320,180");
}

std::array<float, 2> parse_interval(const std::string& option, const std::string& text) {
    constexpr auto kExpected = "a begin and a later end such as 0,0.5";
    const auto v = parse_list<float, 2>(option, text, ',', kExpected);
    if (!std::isfinite(v[0]) || !std::isfinite(v[1]) || !(v[0] < v[1]))
        refuse(option, text, kExpected);
    return v;
}

std::array<std::string, 2> parse_address(const std::string& option, const std::string& text) {
    constexpr auto kExpected = "an address such as localhost:14158";
    std::string host = text, port = "14158";
    const size_t colon = text.rfind(':');
    const bool bracketed = text.starts_with('[');
    const size_t closing = text.rfind(']');
    if (colon != std::string::npos && (!bracketed || colon > closing)) {
        host = text.substr(0, colon);
        port = text.substr(colon + 1);
    }
    if (bracketed) {
        if (closing == std::string::npos || !host.ends_with(']')) refuse(option, text, kExpected);
        host = host.substr(1, host.size() - 2);
    }
    std::string_view digits = port;
    int number = 0;
    const bool is_port =
        take_number(digits, number) && digits.empty() && number > 0 && number < 65536;
    if (host.empty() || (!bracketed && host.find(':') != std::string::npos) || !is_port)
        refuse(option, text, kExpected);
    return {host, port};
}

double parse_positive(const std::string& option, const std::string& text, double most,
                      double least) {
    std::string_view rest = text;
    double value = 0;
    if (!take_number(rest, value) || !rest.empty() || !(value > 0) || !(value >= least) ||
        !(value <= most))
        refuse(option, text,
               least > 0 ? fmt::format("a number from {:.10g} to {:.10g}", least, most)
                         : fmt::format("a number above 0 and up to {:.10g}", most));
    return value;
}

int64_t parse_whole(const std::string& option, const std::string& text, int64_t least,
                    int64_t most) {
    std::string_view rest = text;
    int64_t value = 0;
    if (!take_number(rest, value) || !rest.empty() || value < least || value > most)
        refuse(option, text, fmt::format("a whole number from {} to {}", least, most));
    return value;
}

double parse_paths(const std::string& option, const std::string& text) {
    constexpr double kMost = 1 << 20;
    std::string_view rest = text;
    double value = 0;
    if (!take_number(rest, value) || !rest.empty() || !(value > 0) || !(value <= kMost) ||
        (value > 1 && value != std::floor(value)))
        refuse(option, text,
               fmt::format("a whole number from 1 to {:.0f}, or a part of one", kMost));
    return value;
}

size_t parse_size(const std::string& option, const std::string& text) {
    constexpr auto kExpected = "a size in bytes such as 500M or 2G";
    constexpr std::string_view kUnits = "kmgt";
    std::string_view rest = text;
    double bytes = 0;
    if (!take_number(rest, bytes)) refuse(option, text, kExpected);
    if (!rest.empty()) {
        const size_t unit = kUnits.find(small_letter(rest.front()));
        const bool is_whole = rest.size() == 1 || is_same_name(rest.substr(1), "b") ||
                              is_same_name(rest.substr(1), "ib");
        if (!is_whole || unit == std::string_view::npos) refuse(option, text, kExpected);
        bytes = std::ldexp(bytes, 10 * (int(unit) + 1));
    }
    if (!(bytes >= 0) || !(bytes < 1e18)) refuse(option, text, kExpected);
    return size_t(bytes);
}

bool names_camera(const std::string& text) {
    std::istringstream words(text);
    std::string first, second;
    words >> first >> second;
    const bool is_word = first == "eye" || first == "target" || first == "fov" || first == "up";
    return !first.empty() && !(is_word && !second.empty());
}

CameraOverride parse_camera(const std::string& option, const std::string& text) {
    constexpr auto kExpected =
        "a camera such as 'eye 0,1,6 target 0,0,0 fov 40', with 'up 0,0,1' where that is up";
    std::istringstream words(text);
    std::map<std::string, std::vector<float>> values;
    for (std::string name, value; words >> name;) {
        const bool is_number = name == "fov";
        if (!is_number && name != "eye" && name != "target" && name != "up")
            refuse(option, text, kExpected);
        if (!(words >> value) || values.count(name)) refuse(option, text, kExpected);
        const auto number = list_of<float, 1>(value, ',');
        const auto vector = list_of<float, 3>(value, ',');
        if (is_number ? !number : !vector) refuse(option, text, kExpected);
        auto& list = values[name];
        list = is_number ? std::vector{(*number)[0]} : std::vector(vector->begin(), vector->end());
        for (const float v : list)
            if (!std::isfinite(v)) refuse(option, text, kExpected);
    }
    for (const char* name : {"eye", "target", "fov"})
        if (!values.count(name))
            refuse(option, text, fmt::format("{}; '{}' is missing", kExpected, name));
    const auto vector = [&](const char* name) {
        const std::vector<float>& v = values.at(name);
        return Vec3{v[0], v[1], v[2]};
    };
    CameraOverride camera{vector("eye"), vector("target"), values.at("fov")[0], {}};
    if (values.count("up")) camera.up = vector("up");
    if (!(camera.fov >= CameraOverride::kLeastFov && camera.fov < 180))
        refuse(option, text,
               fmt::format("a camera whose fov is from {} degrees to below 180",
                           CameraOverride::kLeastFov));
    return camera;
}

EnvironmentOverride parse_environment(const std::string& option, const std::string& text) {
    std::optional<std::array<float, 3>> colour = list_of<float, 3>(text, ',');
    if (const auto grey = list_of<float, 1>(text, ','))
        colour = {(*grey)[0], (*grey)[0], (*grey)[0]};
    if (colour) {
        for (const float c : *colour)
            if (!(c >= 0) || !std::isfinite(c))
                refuse(option, text, "a colour r,g,b of numbers that are at least 0");
        return {{}, {(*colour)[0], (*colour)[1], (*colour)[2]}};
    }
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(text, ignored))
        refuse(option, text, "the name of a file that is there, a colour r,g,b or a number");
    return {text, Rgb(1)};
}

LampDescription parse_lamp(const std::string& option, const std::string& text) {
    constexpr auto kExpected =
        "a lamp such as 'camera' or '0,2.5,1', with 'power 40', 'radius 0.1' or 'colour 1,0.9,0.8' "
        "after it";
    constexpr float kLeast = 1e-37f, kMost = 1e20f;
    const auto expect = [&](bool is_right) {
        if (!is_right) refuse(option, text, kExpected);
    };
    const auto vector = [&](const std::string& value, float least) {
        const auto v = list_of<float, 3>(value, ',');
        expect(v && std::all_of(v->begin(), v->end(),
                                [&](float c) { return c >= least && c <= kMost; }));
        return *v;
    };
    std::string small = text;
    for (char& c : small) c = small_letter(c);
    std::istringstream words(small);
    std::string place;
    words >> place;
    LampDescription lamp;
    if (place != "camera") {
        const auto v = vector(place, -kMost);
        lamp.at = Vec3{v[0], v[1], v[2]};
    }
    std::set<std::string> given;
    for (std::string name, value; words >> name;) {
        expect(bool(words >> value) && given.insert(name).second);
        if (name == "colour") {
            const auto v = vector(value, 0);
            lamp.colour = {v[0], v[1], v[2]};
            expect(luminance(lamp.colour) > 1e-6f);
            continue;
        }
        const auto number = list_of<float, 1>(value, ',');
        expect(number && (*number)[0] >= kLeast && (*number)[0] <= kMost);
        expect(name == "power" || (name == "radius" && lamp.at));
        if (name == "power")
            lamp.power = (*number)[0];
        else
            lamp.radius = (*number)[0];
    }
    return lamp;
}

float parse_degrees(const std::string& option, const std::string& text) {
    constexpr auto kExpected = "an angle in degrees such as 90 or -22.5";
    const float degrees = parse_list<float, 1>(option, text, ',', kExpected)[0];
    if (!std::isfinite(degrees)) refuse(option, text, kExpected);
    return degrees;
}

float parse_number(const std::string& option, const std::string& text, float least, float most) {
    const bool has_plus = text.size() > 1 && text[0] == '+' && text[1] != '-';
    const auto value = list_of<float, 1>(std::string_view(text).substr(has_plus ? 1 : 0), ',');
    if (!value || !((*value)[0] >= least && (*value)[0] <= most))
        refuse(option, text, fmt::format("a number from {:.10g} to {:.10g}", least, most));
    return (*value)[0];
}

Shard parse_shard(const std::string& option, const std::string& text) {
    constexpr auto kExpected = "a share k/n with 1 <= k <= n, such as 2/8";
    constexpr int kMost = 1 << 20;
    const auto v = parse_list<int, 2>(option, text, '/', kExpected);
    if (v[0] < 1 || v[1] < v[0] || v[1] > kMost) refuse(option, text, kExpected);
    return {v[0] - 1, v[1]};
}

DebugPixel parse_sample(const std::string& option, const std::string& text) {
    constexpr auto kExpected = "a pixel and its sample x,y,sample such as 320,180,0";
    const auto v = parse_list<int64_t, 3>(option, text, ',', kExpected);
    constexpr int64_t kMost = int64_t{1} << 24;
    const auto is_far = [](int64_t c) { return c < -kMost || c > kMost; };
    if (is_far(v[0]) || is_far(v[1]) || v[2] < 0) refuse(option, text, kExpected);
    return {int(v[0]), int(v[1]), uint64_t(v[2])};
}

uint64_t parse_seed(const std::string& option, const std::string& text) {
    std::string_view rest = text;
    uint64_t value = 0;
    if (!take_number(rest, value) || !rest.empty())
        refuse(option, text, "a whole number from 0 to 2^64 - 1");
    return value;
}

}  // namespace covtrace::cli
