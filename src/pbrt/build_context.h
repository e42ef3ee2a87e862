/// Data that the builders of all kinds of entities share.
#pragma once

#include "pbrt/entity.h"
#include "scene/scene_description.h"
#include "scene/scene_files.h"
#include "scene/warning_log.h"

namespace covtrace {

struct BuildContext {
    SceneDescription& scene;
    SceneFiles& files;
    WarningLog& log;
};

}  // namespace covtrace
