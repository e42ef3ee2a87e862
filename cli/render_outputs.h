/// The files that `render` writes: their names, and whether they may be written.
#pragma once

#include <filesystem>

#include "cli/render_options.h"
#include "scene/scene_description.h"

namespace covtrace::cli {

/// Path of the image: --output, or else the name that the scene's film gives, an OpenEXR file, or
/// else SCENE.exr. A scene does not choose where to write: of a name that leads out of the working
/// folder the last part is taken, with a warning among the scene's.
std::filesystem::path image_path(const RenderArguments& arguments, SceneDescription& scene);

/// Checks the outputs. Throws before anything is written, and before hours of rendering:
/// Error(usage) where an output is another one, or a file that is read; Error(usage) or Error(io)
/// where one cannot be written. `image` is empty for a shard, which has none. Removes the leftovers
/// of killed processes.
void check_outputs(const RenderArguments& arguments, const std::filesystem::path& image,
                   const SceneDescription& scene);

/// Warns of options that change nothing: of other methods, or for files that are not written.
void warn_of_idle(const RenderArguments& arguments, const std::filesystem::path& image);

}  // namespace covtrace::cli
