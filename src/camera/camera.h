/// The camera: its rays, and its geometry as the frequency analysis needs it.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "camera/exit_pupil.h"
#include "camera/lens_system.h"
#include "camera/panorama.h"
#include "core/transform.h"
#include "geometry/hit.h"
#include "scene/scene_description.h"

namespace covtrace {

/// The linear map of a camera around one of its rays: that of a thin lens with perspective or
/// parallel rays. A spherical camera counts as a pinhole that looks along the ray, an aperture of
/// blades as the disc of the same variance.
struct SensorGeometry {
    /// Unit world directions of increasing pixel x, of increasing pixel y, and of the optical axis.
    Vec3 right, down, forward;
    float lens_radius = 0;     ///< world units; 0 for a pinhole
    float focal_distance = 1;  ///< world units along `forward`
    /// Pixels along `right` and `down` per unit of slope, or per world unit of an orthographic
    /// camera.
    float pixels_per_x = 1, pixels_per_y = 1;
    float shutter = 1;  ///< length of the shutter interval, in the scene's unit of time
    bool orthographic = false;
    /// Motion of the camera at the ray's lens point and time: world units and radians per unit of
    /// time.
    Vec3 velocity, angular_velocity;
};

/// A ray of a camera.
struct CameraRay : Ray {
    /// Factor on its light: 1, but for lenses whose surfaces are traced. 0 where the lens blocks
    /// it; the ray then still shows what this place of the film sees.
    float weight = 1;
    bool sees = true;  ///< false where no light at all gets to this place of the film
};

class Camera {
  public:
    /// Makes a camera whose full frame has `width` x `height` pixels. Throws Error(scene) for a
    /// lens that can't be focused or whose aperture can't be read.
    Camera(const CameraDescription& description, int width, int height);

    /// The ray through a film position in pixels (y down from the top of the full frame), a lens
    /// position in [0, 1)^2, which is mapped to the aperture, and a shutter position in [0, 1).
    /// Through a traced lens its weight makes the mean over the lens the irradiance on the film,
    /// over that which the description has for its middle.
    CameraRay generate_ray(Vec2 film, Vec2 lens, float shutter) const;
    /// The rays one pixel to the right and one below it, by the same place in the lens.
    std::array<Ray, 2> rays_beside(Vec2 film, Vec2 lens, float shutter) const;
    /// The camera's linear map around a ray that generate_ray has made.
    SensorGeometry sensor(const Ray& ray) const;
    bool has_lens() const { return lens_radius_ > 0; }
    /// Extent of half a pixel at a distance from the camera, scene units.
    float half_pixel(float distance) const;
    /// The map from the world to the camera's space, which looks along +z, at the shutter's
    /// opening.
    Matrix4 world_to_camera() const;
    /// The projection from the world to the film at the shutter's opening: x / w and y / w are in
    /// [0, 1] from the top left corner, as OpenEXR's "worldToNDC" has them. Means nothing for
    /// spherical cameras.
    Matrix4 world_to_ndc() const;

  private:
    /// A lens that is traced, and where light gets through it.
    struct TracedLens {
        LensSystem system;
        ExitPupils pupils;
    };
    void set_window(int width, int height);
    /// Slope (or position) of a film position in camera space.
    Vec2 slope(Vec2 film) const;
    /// A camera-space ray, and its place in time, in the world.
    Ray in_world(Vec3 origin, Vec3 direction, float shutter) const;
    /// The place on the film behind a traced lens.
    Vec2 film_place(Vec2 film) const;
    CameraRay lens_ray(Vec2 film, Vec2 lens, float shutter) const;
    /// A ray through a place in the plane of the rear vertex, which no rim blocks; where the
    /// surfaces don't let it through, the thin lens' ray through its middle.
    Ray unblocked_ray(Vec2 film, Vec2 rear, float shutter) const;

    const Transform& to_world(float time, Transform& storage) const;
    SensorGeometry sensor_at(const Ray& ray) const;
    SensorGeometry spherical_sensor(const Ray& ray, const Transform& camera_to_world) const;

    /// The camera's linear map to the world at one time, in single precision.
    struct Placement {
        Vec3 origin, x, y, z;
        Vec3 point(Vec3 p) const { return origin + vector(p); }
        Vec3 vector(Vec3 v) const { return x * v.x + y * v.y + z * v.z; }
    };
    static Placement placement(const Transform& camera_to_world);

    CameraDescription description_;
    Placement still_;  // at all times where the camera stands still, else at its first key
    int width_, height_;
    Vec2 origin_;     // camera-space slope (or position) of film position (0, 0)
    Vec2 per_pixel_;  // change of camera-space slope (or position) per pixel; y is negative
    float lens_radius_ = 0, focal_distance_ = 1;
    std::optional<Panorama> panorama_;        // of a spherical camera
    std::shared_ptr<const TracedLens> lens_;  // none: thin, or a pinhole
    float shutter_open_ = 0, shutter_close_ = 1;
    std::optional<SensorGeometry> sensor_;  // set where it is the same for all rays
};

}  // namespace covtrace
