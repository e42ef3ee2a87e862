#include "scene/summary.h"

#include <iomanip>
#include <sstream>

#include "scene/extent.h"
#include "scene/view_text.h"

namespace covtrace {

namespace {

struct ShapeCounts {
    size_t shapes = 0, triangles = 0, patches = 0, spheres = 0, disks = 0, emitters = 0, moving = 0;

    void add(const ShapeDescription& s) {
        ++shapes;
        emitters += s.area_light >= 0;
        moving += s.object_to_world.is_animated();
        if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&s.geometry))
            triangles += (*mesh)->triangles.size();
        else if (const auto* quads = std::get_if<std::shared_ptr<const BilinearMesh>>(&s.geometry))
            patches += (*quads)->patches.size();
        else if (std::holds_alternative<Sphere>(s.geometry))
            ++spheres;
        else
            ++disks;
    }
};

std::string mapping_text(const CameraDescription& camera) {
    using Mapping = CameraDescription::Mapping;
    if (camera.mapping == Mapping::equal_area) return "spherical, equal-area";
    std::ostringstream out;
    if (camera.mapping == Mapping::equirectangular) {
        out << "spherical, equirectangular";
        const auto& [left, right, top, bottom] = camera.sphere_part;
        if (camera.sphere_part != CameraDescription{}.sphere_part)
            out << ", longitude " << 360 * left << " to " << 360 * right << ", latitude "
                << 90 - 180 * bottom << " to " << 90 - 180 * top;
        return out.str();
    }
    out << (camera.mapping == Mapping::equidistant ? "equidistant" : "equisolid")
        << " fisheye, field of view " << camera.fov;
    return out.str();
}

std::string aperture_text(const ApertureBlades& blades) {
    std::ostringstream out;
    if (blades.count > 0) out << ", " << blades.count << " blades";
    if (blades.ratio != 1) out << ", aperture ratio " << blades.ratio;
    return out.str();
}

std::string kind_text(const CameraDescription& camera) {
    switch (camera.kind) {
        case CameraDescription::Kind::orthographic:
            return "orthographic";
        case CameraDescription::Kind::spherical:
            return mapping_text(camera);
        default:
            break;
    }
    std::ostringstream out;
    out << "perspective, field of view " << camera.fov;
    return out.str();
}

}  // namespace

std::string summarize(const SceneDescription& scene) {
    ShapeCounts top, objects;
    for (const ShapeDescription& s : scene.shapes) top.add(s);
    for (const ObjectDescription& o : scene.objects)
        for (const ShapeDescription& s : o.shapes) objects.add(s);
    const CameraDescription& camera = scene.camera;
    std::ostringstream out;
    out << "scene      " << scene.name << "\n"
        << "film       " << scene.film.width << "x" << scene.film.height << ", "
        << scene.samples_per_pixel << " samples per pixel, depth " << scene.max_depth << "\n"
        << "camera     " << kind_text(camera) << ", lens radius " << camera.lens_radius
        << aperture_text(camera.blades) << ", focal distance " << camera.focal_distance
        << ", shutter " << camera.shutter_open << " to " << camera.shutter_close
        << (camera.camera_to_world.is_animated() ? ", moving" : "") << "\n"
        << "view       " << view_text(scene) << "\n"
        << "shapes     " << top.shapes << " (" << top.triangles << " triangles, " << top.patches
        << " patches, " << top.spheres << " spheres, " << top.disks << " disks; " << top.moving
        << " moving)\n";
    if (const Bounds3 box = bounds(scene); !box.empty())
        out << "extent     x " << box.lo.x << " to " << box.hi.x << ", y " << box.lo.y << " to "
            << box.hi.y << ", z " << box.lo.z << " to " << box.hi.z << "\n";
    if (!scene.objects.empty())
        out << "objects    " << scene.objects.size() << " of " << objects.shapes << " shapes ("
            << objects.triangles << " triangles), " << scene.instances.size() << " instances\n";
    out << "materials  " << scene.materials.size() << ", " << scene.textures.size() << " textures, "
        << scene.media.size() << " media\n"
        << "lights     " << scene.lights.size() << " and " << top.emitters << " emitting shapes\n";
    out << "hash       " << std::hex << std::setw(16) << std::setfill('0') << scene.content_hash
        << std::dec << "\n";
    for (const Warning& w : scene.warnings) {
        const std::string place = w.where.to_string();
        out << "warning    " << place << (place.empty() ? "" : ": ") << w.text << "\n";
    }
    return out.str();
}

}  // namespace covtrace
