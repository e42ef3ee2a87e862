/// Data that the builders of all kinds of entities share.
#pragma once

#include <string>

#include "pbrt/parameter_list.h"
#include "scene/scene_description.h"
#include "scene/scene_files.h"
#include "scene/warning_log.h"

namespace covtrace {

/// A directive with a type and parameters, kept until it is built.
struct Entity {
    std::string type;
    ParameterList parameters;
    SourceLocation where;
    int directive = 0;  ///< running number, orders warnings
};

struct BuildContext {
    SceneDescription& scene;
    SceneFiles& files;
    WarningLog& log;
};

}  // namespace covtrace
