#include "cli/progress_line.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/message.h"

namespace covtrace::cli {

namespace {

ProgressStyle resolve(ProgressStyle style) {
    if (style != ProgressStyle::automatic) return style;
    return isatty(fileno(stderr)) ? ProgressStyle::bar : ProgressStyle::plain;
}

std::string clock(double seconds) {
    constexpr double kLongest = 99 * 3600;  // beyond that an estimate says nothing
    const int s = static_cast<int>(std::clamp(seconds, 0.0, kLongest) + 0.5);
    return s >= 3600 ? fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
                     : fmt::format("{}:{:02}", s / 60, s % 60);
}

/// Percent that are done, rounded down, and below 100 until done().
int percent(const Progress& p) {
    return std::clamp(static_cast<int>(100 * p.fraction), 0, 99);
}

/// Two decimals at most, and none where the count is large: "0", "2.39", "1024".
std::string samples(double per_pixel) {
    return per_pixel < 100 ? fmt::format("{:.4g} spp", std::round(100 * per_pixel) / 100)
                           : fmt::format("{:.0f} spp", per_pixel);
}

std::vector<std::string> details(const Progress& p) {
    std::vector<std::string> parts{samples(p.samples_per_pixel)};
    if (std::isfinite(p.error)) parts.push_back(fmt::format("error {:.2g}", p.error));
    parts.push_back(clock(p.elapsed) + " elapsed");
    if (std::isfinite(p.remaining)) parts.push_back(clock(p.remaining) + " left");
    return parts;
}

std::string plain_line(const Progress& p) {
    std::string text = fmt::format("{:<14} {:3}%", name_of(p.phase), percent(p));
    for (const std::string& part : details(p)) text += "  " + part;
    return text;
}

/// Width of the terminal: a longer line would wrap, and could not be redrawn.
size_t terminal_width() {
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

/// The line of a bar, with as much as fits: percent and phase, details from the left, then the bar.
std::string bar_line(const Progress& p, size_t width) {
    constexpr size_t kLeastBar = 8, kMostBar = 32;
    std::string text = fmt::format("{:3}%  {}", percent(p), name_of(p.phase));
    for (const std::string& part : details(p))
        if (text.size() + 2 + part.size() < width) text += "  " + part;
    text.resize(std::min(text.size(), width - 1));
    if (text.size() + 1 + kLeastBar >= width) return text;
    const size_t length = std::min(kMostBar, width - 2 - text.size());
    const auto filled = std::min(length - 1, size_t(double(length) * std::max(0.0, p.fraction)));
    return std::string(filled, '#') + std::string(length - filled, '.') + " " + text;
}

nlohmann::json number(double value) {
    // Unknown values are null: JSON has no NaN.
    if (!std::isfinite(value)) return {};
    return std::round(value * 1e4) / 1e4;
}

}  // namespace

ProgressLine::ProgressLine(ProgressStyle style) : style_(resolve(style)) {}

void ProgressLine::begin() {
    if (style_ != ProgressStyle::bar) return;
    say("reading the scene");
    open_ = true;
}

std::function<void(const Progress&)> ProgressLine::reporter() {
    if (style_ == ProgressStyle::none) return {};
    return [this](const Progress& p) { report(p); };
}

double ProgressLine::interval() const {
    switch (style_) {
        case ProgressStyle::plain:
            return 5;
        case ProgressStyle::percent:
            return 1;
        case ProgressStyle::json:
            return 0.5;
        default:
            return 0.1;
    }
}

void ProgressLine::report(const Progress& p) {
    if (style_ == ProgressStyle::bar) {
        say("\r{}\x1b[K", bar_line(p, terminal_width()));
        open_ = true;
    } else if (style_ == ProgressStyle::plain) {
        say("{}\n", plain_line(p));
    } else if (style_ == ProgressStyle::percent) {
        say("{}%\n", percent(p));
    } else if (style_ == ProgressStyle::json) {
        const double rate = p.elapsed > 0 ? p.samples_per_pixel * pixels_ / p.elapsed : kUnknown;
        const nlohmann::ordered_json j{
            {"phase", name_of(p.phase)},          {"fraction", number(p.fraction)},
            {"spp", number(p.samples_per_pixel)}, {"error", number(p.error)},
            {"elapsed", number(p.elapsed)},       {"remaining", number(p.remaining)},
            {"samples_per_second", number(rate)}};
        say("{}\n", j.dump());
    }
}

void ProgressLine::clear() {
    if (open_) say("\r\x1b[K");
    open_ = false;
}

void ProgressLine::done(double samples_per_pixel, double elapsed, double error) {
    if (style_ == ProgressStyle::percent) say("100%\n");
    if (style_ == ProgressStyle::json) {
        Progress p{Phase::done, 1, samples_per_pixel, elapsed};
        p.remaining = 0;
        p.error = error;
        report(p);
    }
}

}  // namespace covtrace::cli
