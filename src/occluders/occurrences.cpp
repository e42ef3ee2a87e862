#include "occluders/occurrences.h"

namespace covtrace {

std::vector<Occurrence> occurrences(const Geometry::Impl& g, float time) {
    std::vector<Occurrence> all;
    const auto add = [&](uint32_t shape, const EmbreeInstance* instance) {
        if (!g.is_in_the_way[shape]) return;
        Occurrence o;
        o.shape = &g.local[shape];
        o.is_instanced = g.placed[shape].is_instanced;
        if (instance) {
            o.world_from_local = g.world_from_local(*instance, time);
            o.moves = instance->moves;
            if (o.moves)
                o.velocity = instance->motion.rate(time, g.clock) * o.world_from_local.inverse();
        }
        all.push_back(o);
    };
    for (const EmbreeInstance& instance : g.instances)
        for (uint32_t shape : g.scenes[instance.scene].shape_of_geometry) add(shape, &instance);
    // The top scene starts with the instances themselves, so its own shapes come after these.
    for (size_t i = g.instances.size(); i < g.top.shape_of_geometry.size(); ++i)
        add(g.top.shape_of_geometry[i], nullptr);
    return all;
}

}  // namespace covtrace
