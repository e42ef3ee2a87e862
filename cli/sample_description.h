/// A description of one sample's path: the option --debug-pixel.
#pragma once

#include <string>

#include "cli/values.h"
#include "integrator/render_scene.h"
#include "render/options.h"

namespace covtrace::cli {

/// Traces the sample as a render with the same options does and tells its path, one vertex a line.
/// Throws Error(usage) for a pixel outside the image, or a sample that no pixel can have.
std::string describe_sample(const RenderScene& scene, const RenderOptions& options,
                            const DebugPixel& pixel);

}  // namespace covtrace::cli
