/// The choice of a finite light for a piece of a ray.
#include <algorithm>

#include "light/lights_impl.h"

namespace covtrace {

std::optional<Lights::Beside> Lights::choose_beside(Vec3 origin, Vec3 direction, float length,
                                                    float& u) const {
    const auto ball = impl_->tree.choose_beside(origin, direction, length, u);
    if (!ball) return std::nullopt;
    const float along = std::clamp(dot(ball->center - origin, direction), 0.0f, length);
    return Beside{*ball, 1 - impl_->infinite_share(origin + along * direction, Vec3{}).probability};
}

}  // namespace covtrace
