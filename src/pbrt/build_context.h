/// Data that the builders of all kinds of entities share.
#pragma once

#include <optional>

#include "colour/sensor_matrix.h"
#include "pbrt/entity.h"
#include "scene/scene_description.h"
#include "scene/scene_files.h"
#include "scene/warning_log.h"

namespace covtrace {

struct BuildContext {
    SceneDescription& scene;
    SceneFiles& files;
    WarningLog& log;
    /// How the film's sensor sees black bodies, from where the film is built on; empty: as the
    /// standard observer does.
    std::optional<SensorLight> sensor = {};
};

}  // namespace covtrace
