/// Names that options of `covtrace` have in other renderers.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace covtrace::cli {

/// The option, one of `known`, that has this name in pbrt-v4, Mitsuba, Cycles or Blender; none
/// where there is no such one.
inline std::optional<std::string> known_by_another_name(std::string_view option,
                                                        const std::vector<std::string>& known) {
    struct OtherName {
        std::string_view name, option;
    };
    constexpr std::array kNames{OtherName{"--samples", "--spp"},
                                OtherName{"--samples-per-pixel", "--spp"},
                                OtherName{"--spp", "--samples"},
                                OtherName{"-s", "--spp"},
                                OtherName{"--outfile", "--output"},
                                OtherName{"--out", "--output"},
                                OtherName{"--render-output", "--output"},
                                OtherName{"--nthreads", "--threads"},
                                OtherName{"-t", "--threads"},
                                OtherName{"-j", "--threads"},
                                OtherName{"--size", "--resolution"},
                                OtherName{"--width", "--resolution"},
                                OtherName{"--height", "--resolution"},
                                OtherName{"--pixelbounds", "--crop"},
                                OtherName{"--cropwindow", "--crop"},
                                OtherName{"--region", "--crop"},
                                OtherName{"--depth", "--max-depth"},
                                OtherName{"--maxdepth", "--max-depth"},
                                OtherName{"--hdri", "--environment"},
                                OtherName{"--hdr", "--environment"},
                                OtherName{"--envmap", "--environment"},
                                OtherName{"--sky", "--environment"},
                                OtherName{"--denoise", "--denoiser"},
                                OtherName{"--display-server", "--tev"},
                                OtherName{"--integrator", "--method"},
                                OtherName{"--quick", "--preset"},
                                OtherName{"--aperture", "--fstop"},
                                OtherName{"--noise-threshold", "--error"},
                                OtherName{"--time-limit", "--time"},
                                OtherName{"--tonemap", "--view"},
                                OtherName{"--view-transform", "--view"}};
    const std::string_view name = option.substr(0, option.find('='));
    const auto* found = std::ranges::find(kNames, name, &OtherName::name);
    if (found == kNames.end() || std::ranges::find(known, found->option) == known.end()) return {};
    return std::string(found->option);
}

}  // namespace covtrace::cli
