#include "pbrt/graphics_state.h"

namespace covtrace {

AnimatedTransform GraphicsState::object_to_world(const SourceLocation& user) const {
    return {ctm[0].get(user), start_time, ctm[1].get(user), end_time};
}

AnimatedTransform GraphicsState::world_to_object(const SourceLocation& user) const {
    return {ctm[0].get(user).inverse(), start_time, ctm[1].get(user).inverse(), end_time};
}

void GraphicsState::concatenate(const CurrentTransform& t, const SourceLocation& where) {
    for (size_t i = 0; i < 2; ++i)
        if (active[i]) ctm[i] = ctm[i].times(t, where);
}

void GraphicsState::replace(const CurrentTransform& t) {
    for (size_t i = 0; i < 2; ++i)
        if (active[i]) ctm[i] = t;
}

}  // namespace covtrace
