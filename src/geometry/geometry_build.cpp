/// The geometry's construction: shapes, alpha and motion as Embree gets them. Rays are in
/// geometry.cpp.
#include <algorithm>
#include <new>

#include "geometry/embree_instances.h"
#include "geometry/embree_shapes.h"
#include "geometry/placed_scene.h"
#include "scene/pane.h"

namespace covtrace {

namespace {

bool has_interface_material(const SceneDescription& scene, const ShapeDescription& shape) {
    return shape.material >= 0 && std::holds_alternative<InterfaceMaterial>(
                                      scene.materials[static_cast<size_t>(shape.material)].value);
}

bool is_mix(const SceneDescription& scene, MaterialId material) {
    return material >= 0 && scene.materials[static_cast<size_t>(material)].mix.has_value();
}

bool is_unlit(const SceneDescription& scene, MaterialId material) {
    return material >= 0 && std::holds_alternative<UnlitMaterial>(
                                scene.materials[static_cast<size_t>(material)].value);
}

/// For each material, whether `is` says so of it or, where it is a mix, of any part. A mix comes
/// after its parts, so each material is looked at once however deep they nest.
template <typename Is>
std::vector<bool> of_any_part(const SceneDescription& scene, const Is& is) {
    std::vector<bool> any;
    any.reserve(scene.materials.size());
    for (const MaterialDescription& m : scene.materials) {
        bool found = !m.mix && is(m);
        if (m.mix)
            for (MaterialId part : m.mix->materials)
                found = found || (part >= 0 && any.at(static_cast<size_t>(part)));
        any.push_back(found);
    }
    return any;
}

/// For each material, whether it may turn out to be no surface at all, by being mixed with an
/// interface.
std::vector<bool> may_be_interface(const SceneDescription& scene) {
    return of_any_part(scene, [](const MaterialDescription& m) {
        return std::holds_alternative<InterfaceMaterial>(m.value);
    });
}

/// For each material, whether light gets through it, or through a part of it, and is scattered
/// wherever it does.
std::vector<bool> are_translucent(const SceneDescription& scene) {
    std::vector<bool> are = of_any_part(scene, [](const MaterialDescription& m) {
        return std::holds_alternative<DiffuseTransmissionMaterial>(m.value) ||
               std::holds_alternative<HairMaterial>(m.value);
    });
    const std::vector<bool> clear = of_any_part(scene, [](const MaterialDescription& m) {
        return std::holds_alternative<DielectricMaterial>(m.value) ||
               std::holds_alternative<ThinDielectricMaterial>(m.value) ||
               std::holds_alternative<InterfaceMaterial>(m.value);
    });
    for (size_t m = 0; m < are.size(); ++m) are[m] = are[m] && !clear[m];
    return are;
}

/// Whether a shape is a strand of hair, whose material tells where light leaves it: it has no
/// inside.
bool is_strand(const SceneDescription& scene, const ShapeDescription& shape) {
    if (shape.tube_sides == 0 || shape.material < 0) return false;
    const MaterialDescription& m = scene.materials[static_cast<size_t>(shape.material)];
    return !m.mix && std::holds_alternative<HairMaterial>(m.value);
}

/// Whether rays pass a shape from within: a strand, or another tube in the place of a ribbon with
/// nothing in it, whose inside does not shine.
bool is_left_freely(const SceneDescription& scene, const ShapeDescription& shape,
                    const std::vector<bool>& translucent) {
    return is_strand(scene, shape) || (shape.tube_sides > 0 && shape.material >= 0 &&
                                       translucent[static_cast<size_t>(shape.material)] &&
                                       shape.inside == shape.outside && shape.area_light < 0);
}

/// Whether alpha hides all of the shape. Such a shape is a light that can't be seen: no other one
/// is kept.
bool is_hidden(const SceneDescription& scene, const ShapeDescription& shape) {
    if (shape.alpha < 0) return false;
    const auto* constant =
        std::get_if<ConstantTexture>(&scene.textures[static_cast<size_t>(shape.alpha)].value);
    return constant && constant->value.r <= 0;
}

bool lets_light_pass(const SceneDescription& scene, const ShapeDescription& shape) {
    return shape.area_light >= 0 &&
           scene.area_lights[static_cast<size_t>(shape.area_light)].lets_light_pass;
}

/// Whether a shape has no effect on any path: hidden, or an interface between nothing and nothing.
bool is_left_out(const SceneDescription& scene, const ShapeDescription& shape) {
    if (is_hidden(scene, shape) || shape.visible_to == set_of(RayKind::any)) return true;
    return has_interface_material(scene, shape) && shape.inside < 0 && shape.outside < 0 &&
           shape.area_light < 0;
}

std::vector<float> key_times(const SceneDescription& scene) {
    std::vector<float> times;
    const auto add = [&times](const AnimatedTransform& t) {
        if (t.is_animated()) times.insert(times.end(), {t.start_time(), t.end_time()});
    };
    for (const ShapeDescription& shape : scene.shapes) add(shape.object_to_world);
    for (const InstanceDescription& instance : scene.instances) add(instance.instance_to_world);
    for (const ObjectDescription& object : scene.objects)
        for (const ShapeDescription& shape : object.shapes) add(shape.object_to_world);
    return times;
}

}  // namespace

struct Geometry::Impl::Builder {
    Impl& g;
    const SceneDescription& scene;
    const std::vector<bool> may_be_interface;  ///< by material: whether it may be an interface
    const std::vector<bool> translucent;       ///< by material: whether light is scattered through

    void place(const ShapeDescription& shape, bool is_instanced) {
        const bool flip =
            shape.reverse_orientation != shape.object_to_world.start().swaps_handedness();
        const bool passes = lets_light_pass(scene, shape);
        g.placed.push_back({shape, flip, is_instanced, passes, is_pane(scene, shape),
                            is_left_freely(scene, shape, translucent)});
        if (is_strand(scene, shape)) g.placed.back().description.inside = shape.outside;
        constexpr RayKinds kSeen = set_of(RayKind::camera) | set_of(RayKind::shadow);
        g.is_in_the_way.push_back(!passes && !has_interface_material(scene, shape) &&
                                  (shape.visible_to & kSeen) != 0);
    }

    /// Notes where rays of different kinds meet different things.
    void compare_kinds(const PlacedShape& shape) const {
        const RayKinds set = shape.description.visible_to;
        const bool shadows = contains(set, RayKind::shadow) && !shape.lets_light_pass;
        const RayKinds scattered = set & kScatteredRays;
        g.kinds_differ = g.kinds_differ || (scattered != 0 && scattered != kScatteredRays);
        g.shadows_differ = g.shadows_differ ||
                           (!shape.lets_light_pass && scattered != (shadows ? kScatteredRays : 0));
    }

    bool moves(const AnimatedTransform& t) const {
        return Motion{nullptr, &t}.moves(g.clock.open(), g.clock.close());
    }

    ShapeScene new_scene() const { return {g.device.new_scene(), {}}; }

    void add(ShapeScene& target, uint32_t shape) const {
        const bool may_let_pass = g.placed[shape].may_let_pass();
        // A shape that may be an interface in places is asked for its material there by
        // `visibility`.
        const MaterialId material = g.placed[shape].description.material;
        const bool may_pass = material >= 0 && may_be_interface[static_cast<size_t>(material)];
        compare_kinds(g.placed[shape]);
        unsigned mask = g.placed[shape].description.visible_to;
        if (g.placed[shape].lets_light_pass)
            mask &= ~(ray_mask(RayKind::any) | ray_mask(RayKind::shadow));
        // Light passes what is unlit, so that rays to lights need not know of it.
        else if (!may_pass && !is_unlit(scene, material) && (mask & ray_mask(RayKind::shadow)) != 0)
            mask |= may_let_pass ? kAlphaMask : kSolidMask;
        // Shapes that the camera alone sees are not in the way of light that is sampled through
        // panes; a mix with an interface is, so that which of both it is need not be known twice.
        if (g.placed[shape].is_pane)
            g.any_pane = true;
        else if ((mask & kScatteredRays) != 0)
            mask |= kBehindPanesMask;
        if (!g.placed[shape].is_pane &&
            ((mask & kSolidMask) != 0 || (is_mix(scene, material) && !may_let_pass)))
            mask |= kBlockingMask;
        g.any_interface = g.any_interface || may_pass;
        g.any_alpha = g.any_alpha || may_let_pass;
        GeometryHandle geometry = new_shape_geometry(g.device, g.local[shape], mask);
        if (geometry) attach(target, geometry.get(), shape);
    }

    static void attach(ShapeScene& target, RTCGeometry geometry, uint32_t shape) {
        rtcAttachGeometryByID(target.scene.get(), geometry,
                              static_cast<unsigned>(target.shape_of_geometry.size()));
        target.shape_of_geometry.push_back(shape);
    }

    /// Keeps `part` as a scene to be instanced; returns its index.
    uint32_t keep(ShapeScene part) const {
        g.device.commit(part.scene.get());
        g.scenes.push_back(std::move(part));
        return static_cast<uint32_t>(g.scenes.size() - 1);
    }

    /// Limits where rays may start, so that Embree can carry them into this instance.
    void limit_origins(RTCGeometry instance, bool moves, const SourceLocation& where) const {
        const unsigned steps = moves ? 32 : 0;
        for (unsigned i = 0; i <= steps; ++i) {
            const float parameter = moves ? static_cast<float>(i) / static_cast<float>(steps) : 0;
            const Affine inverse = instance_transform(instance, parameter).inverse();
            const Vec3d scale = inverse.absolute({1, 1, 1}), offset = abs(inverse.translation);
            const double scales = std::max({scale.x, scale.y, scale.z, 1.0});
            const double offsets = std::max({offset.x, offset.y, offset.z});
            if (!(scale.x + scale.y + scale.z <= kStrongestShrinking) ||
                !(offsets < kLargestEmbreeCoordinate / 2))
                throw Error(ErrorKind::scene, where,
                            "the transform shrinks the shape to nothing or moves it out of reach; "
                            "expected a scale above 1e-12");
            const double most = (kLargestEmbreeCoordinate - offsets) / scales;
            g.farthest_origin = std::min(g.farthest_origin, static_cast<float>(most));
        }
    }

    /// Places scene number `index` in the world. Instances come first in the top scene, so that
    /// Embree's instance number is the index into `instances`.
    void instantiate(uint32_t index, const Motion& motion, const SourceLocation& where) const {
        RTCScene part = g.scenes[index].scene.get();
        EmbreeInstance instance;
        instance.scene = index;
        instance.motion = motion;
        instance.moves = motion.moves(g.clock.open(), g.clock.close());
        const GeometryHandle handle =
            instance.moves ? new_moving_instance(g.device, part, motion, g.clock)
                           : new_still_instance(g.device, part, motion.at(g.clock.open()));
        instance.handle = handle.get();
        instance.still = instance_transform(handle.get(), 0);
        limit_origins(handle.get(), instance.moves, where);
        attach(g.top, handle.get(), 0);
        g.instances.push_back(instance);
    }

    uint32_t single_shape_scene(uint32_t shape) const {
        ShapeScene part = new_scene();
        add(part, shape);
        return keep(std::move(part));
    }

    /// The scenes of an object: its still shapes as one, each of its moving shapes as one of its
    /// own.
    struct ObjectScenes {
        std::vector<std::pair<uint32_t, const AnimatedTransform*>> parts;
    };

    ObjectScenes build_object(uint32_t first, size_t count) const {
        ObjectScenes object;
        ShapeScene still = new_scene();
        for (uint32_t i = first; i < first + count; ++i) {
            if (is_left_out(scene, g.placed[i].description)) continue;
            const AnimatedTransform& motion = g.placed[i].description.object_to_world;
            if (moves(motion))
                object.parts.emplace_back(single_shape_scene(i), &motion);
            else
                add(still, i);
        }
        if (!still.shape_of_geometry.empty())
            object.parts.emplace_back(keep(std::move(still)), nullptr);
        return object;
    }

    void run() {
        for (const ShapeDescription& shape : scene.shapes) place(shape, false);
        std::vector<uint32_t> first_of_object;
        for (const ObjectDescription& object : scene.objects) {
            first_of_object.push_back(static_cast<uint32_t>(g.placed.size()));
            for (const ShapeDescription& shape : object.shapes) place(shape, true);
        }
        g.local.reserve(g.placed.size());
        for (const PlacedShape& shape : g.placed) {
            const AnimatedTransform& t = shape.description.object_to_world;
            g.local.push_back(
                make_local_shape(shape.description, moves(t) ? Transform{} : t.at(g.clock.open())));
        }
        g.top = new_scene();
        g.instance_of_shape.assign(g.placed.size(), -1);

        for (const InstanceDescription& instance : scene.instances)
            g.instance_motions.push_back(instance.instance_to_world);
        std::vector<ObjectScenes> objects(scene.objects.size());
        std::vector<bool> is_built(scene.objects.size(), false);
        for (const InstanceDescription& instance : scene.instances) {
            const auto o = static_cast<size_t>(instance.object);
            if (!is_built[o])
                objects[o] = build_object(first_of_object[o], scene.objects[o].shapes.size());
            is_built[o] = true;
        }
        for (size_t i = 0; i < scene.instances.size(); ++i)
            for (const auto& [part, motion] :
                 objects[static_cast<size_t>(scene.instances[i].object)].parts)
                instantiate(part, {&g.instance_motions[i], motion}, scene.instances[i].where);
        const auto count = static_cast<uint32_t>(scene.shapes.size());
        for (uint32_t i = 0; i < count; ++i) {
            const AnimatedTransform& motion = g.placed[i].description.object_to_world;
            if (is_left_out(scene, g.placed[i].description) || !moves(motion)) continue;
            g.instance_of_shape[i] = static_cast<int>(g.instances.size());
            instantiate(single_shape_scene(i), {nullptr, &motion}, g.placed[i].description.where);
        }
        for (uint32_t i = 0; i < count; ++i)
            if (!is_left_out(scene, g.placed[i].description) &&
                !moves(g.placed[i].description.object_to_world))
                add(g.top, i);
        g.device.commit(g.top.scene.get());
        g.packets_are_exact = g.instances.empty() && g.device.isa() != "sse2" &&
                              std::all_of(g.local.begin(), g.local.end(), is_intersected_by_embree);
    }
};

Geometry::Impl::Impl(const SceneDescription& scene, const std::string& isa)
    : device(isa), clock(scene.camera.shutter_open, scene.camera.shutter_close, key_times(scene)) {
    try {
        Builder{*this, scene, may_be_interface(scene), are_translucent(scene)}.run();
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::limit, "out of memory while building the scene's geometry");
    }
    RTCBounds box;
    rtcGetSceneBounds(top.scene.get(), &box);
    bounds = {{box.lower_x, box.lower_y, box.lower_z}, {box.upper_x, box.upper_y, box.upper_z}};
    if (bounds.empty() || !is_finite(bounds.lo) || !is_finite(bounds.hi))
        bounds = {{-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}};
}

Affine Geometry::Impl::moving_map(const EmbreeInstance& instance, float time) const {
    return instance_transform(instance.handle, clock.parameter(time));
}

}  // namespace covtrace
