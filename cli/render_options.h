/// The options of `covtrace render`. All places that a new one touches, Python's among them:
/// docs/internals/architecture.md, "To add".
#pragma once

#include <CLI/CLI.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "cli/denoiser_options.h"
#include "cli/display_options.h"
#include "cli/film_options.h"
#include "cli/layer_options.h"
#include "cli/progress_line.h"
#include "cli/values.h"
#include "geometry/instruction_set.h"
#include "image/layer_names.h"
#include "render/options.h"
#include "render/overrides.h"
#include "render/preset.h"
#include "scene/read_options.h"
#include "texture/texture.h"

namespace covtrace::cli {

inline constexpr size_t kNoMemoryLimit = std::numeric_limits<size_t>::max();

/// Frames of an animation, from the first to the last, each `step`-th.
struct FrameRange {
    int first = 0, last = 0, step = 1;
};

inline constexpr double kFramesPerSecond = 24;

struct RenderArguments {
    std::string scene, output, png, stats;
    std::optional<FrameRange> frames;
    std::optional<double> fps;  ///< frames of `frames` per second, else kFramesPerSecond
    std::optional<int> frame;   ///< the one of `frames` that is rendered
    std::optional<Preset> preset;
    std::optional<InstructionSet> isa;
    std::string seconds, tev;
    FilmChoice film;
    DenoiserArguments denoiser;
    std::optional<DebugPixel> debug_pixel;
    LayerSelection layers{true, {}}, tev_layers;
    DisplayArguments display;
    std::optional<LayerNames> layer_names;  ///< none: the scene decides
    size_t texture_bytes = kNoTextureLimit, max_memory = kNoMemoryLimit;
    std::vector<std::string> search_paths;
    RenderOptions options;
    SceneOverrides overrides;
    ReadOptions reading;
    ProgressStyle progress = ProgressStyle::automatic;
    int threads = 0;
    bool reproducible = false, quiet = false;
};

/// Adds the options to a command; `arguments` must outlive the parser.
void add_render_options(CLI::App* command, RenderArguments& arguments);

}  // namespace covtrace::cli
