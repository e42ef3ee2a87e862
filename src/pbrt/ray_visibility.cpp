#include "pbrt/ray_visibility.h"

#include <algorithm>

#include "scene/names.h"

namespace covtrace {

RayKinds visible_to(Entity& e) {
    static const std::vector<std::string> names{"camera",       "diffuse", "glossy",
                                                "transmission", "volume",  "shadow"};
    RayKinds visible = kEveryRay;
    for (const std::string& name : e.parameters.texts("hiddenfrom")) {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end())
            throw Error(ErrorKind::scene, e.parameters.where("hiddenfrom", e.where),
                        unknown_name("kind of ray", name, names));
        // The names follow RayKind::any in the order of the kinds.
        const auto kind = static_cast<RayKind>(found - names.begin() + 1);
        visible = static_cast<RayKinds>(visible & ~set_of(kind));
    }
    return visible;
}

}  // namespace covtrace
