#include "cli/progress_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

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

std::string line(const Progress& p) {
    return fmt::format("{:<14} {:3.0f}%  {:.4g} spp  {} elapsed  {} left", p.phase,
                       std::clamp(100 * p.fraction - 0.5, 0.0, 99.0), p.samples_per_pixel,
                       clock(p.elapsed), clock(p.remaining));
}

}  // namespace

ProgressReporter make_reporter(ProgressStyle style) {
    switch (resolve(style)) {
        case ProgressStyle::bar:
            return {[](const Progress& p) {
                        constexpr int kWidth = 24;
                        const int filled = static_cast<int>(kWidth * p.fraction);
                        say("\r{}{}  {}\x1b[K", std::string(size_t(filled), '#'),
                            std::string(size_t(kWidth - filled), '.'), line(p));
                        std::fflush(stderr);
                    },
                    0.1};
        case ProgressStyle::plain:
            return {[](const Progress& p) { say("{}\n", line(p)); }, 5};
        case ProgressStyle::percent:
            return {[](const Progress& p) { say("{}%\n", static_cast<int>(99 * p.fraction)); }, 1};
        case ProgressStyle::json:
            return {
                [](const Progress& p) {
                    say("{{\"phase\":\"{}\",\"fraction\":{:.4f},\"spp\":{:.4f},\"elapsed\":{:.3f},"
                        "\"remaining\":{:.3f}}}\n",
                        p.phase, p.fraction, p.samples_per_pixel, p.elapsed, p.remaining);
                },
                0.5};
        case ProgressStyle::automatic:
        case ProgressStyle::none:
            break;
    }
    return {};
}

void finish_line(ProgressStyle style) {
    if (resolve(style) == ProgressStyle::bar) say("\r\x1b[K");
}

}  // namespace covtrace::cli
