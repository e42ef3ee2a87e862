#include "cli/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "cli/values.h"
#include "core/error.h"
#include "image/output_file.h"

namespace covtrace::cli {

namespace {

/// The shutter of a frame: that of the arguments, or half a frame from 0 on, later by the frame's
/// time. Throws Error(usage) where times that late are too coarse for it.
std::array<float, 2> shutter_at(const RenderArguments& a, int frame) {
    const double begin = frame / a.fps.value_or(kFramesPerSecond);
    const std::array<float, 2> first = a.overrides.shutter.value_or(
        std::array{0.0f, static_cast<float>(0.5 / a.fps.value_or(kFramesPerSecond))});
    const std::array<float, 2> shutter{static_cast<float>(first[0] + begin),
                                       static_cast<float>(first[1] + begin)};
    // Scenes have times in single precision: hours from their beginning an exposure would have
    // another length, and at last none.
    constexpr double kMostError = 0.1;
    const double wanted = double(first[1]) - double(first[0]),
                 got = double(shutter[1]) - double(shutter[0]);
    if (!(std::abs(got - wanted) <= kMostError * wanted))
        throw Error(ErrorKind::usage,
                    fmt::format("--frames: an exposure of {:.3g} seconds is too short to be told "
                                "apart at {:.9g} seconds, frame {}",
                                wanted, begin, frame));
    return shutter;
}

}  // namespace

FrameRange parse_frames(const std::string& option, const std::string& text) {
    const auto refuse = [&] {
        throw Error(ErrorKind::usage,
                    option +
                        ": expected a frame, or the first and the last one, and every how many, "
                        "such as 12, 0-47 or 0-47x4, not '" +
                        text + "'");
    };
    const auto number = [&](const std::string& part) {
        constexpr int kMost = 9'999'999;  // has as many digits as its text may have
        const bool is_number =
            !part.empty() && part.size() <= 7 &&
            std::all_of(part.begin(), part.end(), [](char c) { return c >= '0' && c <= '9'; });
        if (!is_number) refuse();
        return static_cast<int>(parse_whole(option, part, 0, kMost));
    };
    const size_t dash = text.find('-'), cross = text.find_first_of("xX");
    FrameRange frames;
    frames.first = frames.last = number(text.substr(0, std::min(dash, cross)));
    if (dash != std::string::npos)
        frames.last =
            number(text.substr(dash + 1, cross == std::string::npos ? cross : cross - dash - 1));
    if (cross != std::string::npos) frames.step = number(text.substr(cross + 1));
    if (frames.last < frames.first || frames.step < 1) refuse();
    return frames;
}

std::string frame_file(const std::string& file, int frame) {
    if (file.empty() || OutputFile::names_stream(file)) return file;
    const std::filesystem::path path = file;
    std::string name = path.filename().string();
    const size_t last = name.find_last_of('#');
    if (last == std::string::npos) {
        name = fmt::format("{}.{:04}{}", path.stem().string(), frame, path.extension().string());
    } else {
        const size_t before = name.find_last_not_of('#', last);
        const size_t first = before == std::string::npos ? 0 : before + 1;
        const size_t digits = last + 1 - first;
        name.replace(first, digits, fmt::format("{:0{}}", frame, digits));
    }
    return (path.parent_path() / name).string();
}

RenderArguments at_frame(const RenderArguments& a, int frame) {
    RenderArguments one = a;
    one.overrides.shutter = shutter_at(a, frame);
    one.options.seed += static_cast<uint64_t>(frame);
    one.frame = frame;
    one.reading.is_frame = true;
    for (std::string* file :
         {&one.output, &one.png, &one.stats, &one.film.film, &one.film.checkpoint})
        *file = frame_file(*file, frame);
    return one;
}

}  // namespace covtrace::cli
