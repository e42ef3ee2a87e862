#include "camera/camera.h"

#include <cmath>

#include "camera/aperture_blades.h"
#include "core/frame.h"

namespace covtrace {

namespace {

/// The smallest window of this aspect around the given one, with the same centre.
std::array<float, 4> widened(std::array<float, 4> w, float aspect) {
    const float width = w[1] - w[0], height = w[3] - w[2];
    const float x = std::max(0.0f, height * aspect - width) / 2;
    const float y = std::max(0.0f, width / aspect - height) / 2;
    return {w[0] - x, w[1] + x, w[2] - y, w[3] + y};
}

}  // namespace

Camera::Camera(const CameraDescription& description, int width, int height)
    : description_(description),
      still_(placement(description.camera_to_world.start())),
      width_(width),
      height_(height),
      lens_radius_(description.lens_radius),
      focal_distance_(description.focal_distance),
      shutter_open_(description.shutter_open),
      shutter_close_(description.shutter_close) {
    set_window(width, height);
    if (description.kind == CameraDescription::Kind::spherical)
        panorama_.emplace(description, width, height, origin_, per_pixel_);
    else if (!description.camera_to_world.is_animated())
        sensor_ = sensor_at({});
}

void Camera::set_window(int width, int height) {
    const CameraDescription& d = description_;
    const auto w = static_cast<float>(width), h = static_cast<float>(height);
    float aspect = d.frame_aspect_ratio > 0 ? d.frame_aspect_ratio : w / h;
    float scale = d.kind == CameraDescription::Kind::perspective ? std::tan(d.fov * kPi / 360) : 1;
    if (d.lens) {
        const float radius = d.lens->film_diagonal / 2;
        const LensSystem system(*d.lens, lens_radius_, focal_distance_, d.where);
        lens_ = std::make_shared<const TracedLens>(TracedLens{system, ExitPupils(system, radius)});
        focal_distance_ -= system.front_z();  // the thin lens stands where rays leave this one
        aspect = w / h;
        scale = radius * std::min(w, h) / std::sqrt(w * w + h * h) / system.image_distance();
    }
    std::array<float, 4> window = aspect > 1 ? std::array<float, 4>{-aspect, aspect, -1, 1}
                                             : std::array<float, 4>{-1, 1, -1 / aspect, 1 / aspect};
    if (d.screen_window) window = *d.screen_window;
    if (d.screen_window && !d.window_fills_film) window = widened(window, aspect);
    origin_ = {window[0] * scale, window[3] * scale};
    per_pixel_ = {(window[1] - window[0]) * scale / w, (window[2] - window[3]) * scale / h};
}

const Transform& Camera::to_world(float time, Transform& storage) const {
    if (!description_.camera_to_world.is_animated()) return description_.camera_to_world.start();
    storage = description_.camera_to_world.at(time);
    return storage;
}

Vec2 Camera::slope(Vec2 film) const {
    return {origin_.x + film.x * per_pixel_.x, origin_.y + film.y * per_pixel_.y};
}

Ray Camera::in_world(Vec3 origin, Vec3 direction, float shutter) const {
    Ray ray;
    ray.time = shutter_open_ + shutter * (shutter_close_ - shutter_open_);
    const bool moves = description_.camera_to_world.is_animated();
    const Placement at = moves ? placement(description_.camera_to_world.at(ray.time)) : still_;
    ray.origin = at.point(origin);
    ray.direction = normalize(at.vector(direction));
    ray.kind = RayKind::camera;
    return ray;
}

CameraRay Camera::generate_ray(Vec2 film, Vec2 lens, float shutter) const {
    if (lens_) return lens_ray(film, lens, shutter);
    const Vec2 s = slope(film);
    Vec3 origin, direction{0, 0, 1};
    if (panorama_)
        direction = panorama_->direction(film);
    else if (description_.kind == CameraDescription::Kind::perspective)
        direction = {s.x, s.y, 1};
    else
        origin = {s.x, s.y, 0};
    if (lens_radius_ > 0) {
        const Vec3 focus = origin + direction * focal_distance_;
        const Vec2 l = aperture_point(description_.blades, lens) * lens_radius_;
        origin += Vec3{l.x, l.y, 0};
        direction = focus - origin;
    }
    if (panorama_ && !panorama_->sees(film))
        return {in_world(origin, direction, shutter), 0, false};
    return {in_world(origin, direction, shutter)};
}

Vec2 Camera::film_place(Vec2 film) const {
    return slope(film) * -lens_->system.image_distance();  // the image is upside down
}

Ray Camera::unblocked_ray(Vec2 film, Vec2 rear, float shutter) const {
    if (const auto ray = lens_->system.trace_unblocked(film_place(film), rear))
        return in_world(ray->origin, ray->direction, shutter);
    const Vec2 s = slope(film);
    return in_world({0, 0, lens_->system.front_z()}, {s.x, s.y, 1}, shutter);
}

CameraRay Camera::lens_ray(Vec2 film, Vec2 lens, float shutter) const {
    const LensSystem& system = lens_->system;
    const Vec2 place = film_place(film);
    const ExitPupils::Sample pupil = lens_->pupils.sample(place, lens);
    if (!(pupil.area > 0)) return {unblocked_ray(film, {}, shutter), 0, false};
    const std::optional<LensRay> ray = system.trace(place, pupil.rear);
    if (!ray) return {unblocked_ray(film, pupil.rear, shutter), 0};
    // Irradiance of a radiance of 1 through the plane of the rear vertex: cos^4 / z^2 by its area
    const float z = system.rear_z(), across = length(pupil.rear - place);
    const float cos2 = z * z / (z * z + across * across);
    const float irradiance = ray->share * cos2 * cos2 * pupil.area / (z * z);
    return {in_world(ray->origin, ray->direction, shutter),
            irradiance / description_.film_irradiance};
}

std::array<Ray, 2> Camera::rays_beside(Vec2 film, Vec2 lens, float shutter) const {
    const Vec2 right = film + Vec2{1, 0}, below = film + Vec2{0, 1};
    if (!lens_) return {generate_ray(right, lens, shutter), generate_ray(below, lens, shutter)};
    const Vec2 rear = lens_->pupils.sample(film_place(film), lens).rear;
    return {unblocked_ray(right, rear, shutter), unblocked_ray(below, rear, shutter)};
}

Camera::Placement Camera::placement(const Transform& t) {
    return {t.point({}), t.vector({1, 0, 0}), t.vector({0, 1, 0}), t.vector({0, 0, 1})};
}

/// The sensor of a spherical camera: a pinhole that looks along the ray, with the map's own scale
/// there.
SensorGeometry Camera::spherical_sensor(const Ray& ray, const Transform& camera_to_world) const {
    const Vec3 w = normalize(camera_to_world.inverse().vector(ray.direction));
    const Vec2 film = panorama_->film(w);
    constexpr float kStep = 0.25f;  // pixels
    const auto along = [&](Vec2 step) {
        const Vec3 ahead = normalize(camera_to_world.vector(panorama_->direction(film + step)));
        const Vec3 behind = normalize(camera_to_world.vector(panorama_->direction(film - step)));
        return (ahead - behind) / (2 * kStep);
    };
    const Vec3 x = along({kStep, 0}), y = along({0, kStep});
    SensorGeometry g;
    g.forward = ray.direction;
    const Frame frame = Frame::from_z_x(g.forward, x);
    g.right = frame.x;
    g.down = dot(frame.y, y) < 0 ? -frame.y : frame.y;
    constexpr float kSmallest = 1e-6f;  // radians per pixel; less only where the map is torn
    g.pixels_per_x = 1 / std::max(length(x), kSmallest);
    g.pixels_per_y = 1 / std::max(std::abs(dot(g.down, y)), kSmallest);
    return g;
}

float Camera::half_pixel(float distance) const {
    switch (description_.kind) {
        case CameraDescription::Kind::orthographic:
            return 0.5f * per_pixel_.x * length(still_.x);
        case CameraDescription::Kind::spherical:
            return 0.5f * panorama_->pixel_angle() * distance;
        case CameraDescription::Kind::perspective:
            break;
    }
    return 0.5f * per_pixel_.x * distance;
}

SensorGeometry Camera::sensor(const Ray& ray) const {
    return sensor_ ? *sensor_ : sensor_at(ray);
}

SensorGeometry Camera::sensor_at(const Ray& ray) const {
    Transform storage;
    const Transform& camera_to_world = to_world(ray.time, storage);
    if (panorama_) {
        SensorGeometry g = spherical_sensor(ray, camera_to_world);
        g.shutter = shutter_close_ - shutter_open_;
        g.velocity = description_.camera_to_world.velocity(ray.origin, ray.time);
        g.angular_velocity = description_.camera_to_world.angular_velocity(ray.time);
        return g;
    }
    const Vec3 x = camera_to_world.vector({per_pixel_.x, 0, 0});
    const Vec3 y = camera_to_world.vector({0, per_pixel_.y, 0});
    const Vec3 z = camera_to_world.vector({0, 0, 1});
    const float unit = length(z);  // a camera may be scaled as a whole
    SensorGeometry g;
    g.right = normalize(x);
    g.down = normalize(y);
    g.forward = normalize(z);
    g.lens_radius = lens_radius_ * radius_of_like_disc(description_.blades) * unit;
    g.focal_distance = focal_distance_ * unit;
    g.orthographic = description_.kind == CameraDescription::Kind::orthographic;
    g.pixels_per_x = 1 / (g.orthographic ? length(x) : length(x) / unit);
    g.pixels_per_y = 1 / (g.orthographic ? length(y) : length(y) / unit);
    g.shutter = shutter_close_ - shutter_open_;
    g.velocity = description_.camera_to_world.velocity(ray.origin, ray.time);
    g.angular_velocity = description_.camera_to_world.angular_velocity(ray.time);
    return g;
}

Matrix4 Camera::world_to_camera() const {
    Transform storage;
    return to_world(shutter_open_, storage).inverse_matrix();
}

Matrix4 Camera::world_to_ndc() const {
    // Film fractions lie in [0, 1], y down, as pbrt and OpenEXR's "worldToNDC" users expect: x' /
    // w', y' / w'.
    Matrix4 projection;
    const double width_slope = double(per_pixel_.x) * width_,
                 height_slope = double(per_pixel_.y) * height_;
    projection.m[0] = {1 / width_slope, 0, -origin_.x / width_slope, 0};
    projection.m[1] = {0, 1 / height_slope, -origin_.y / height_slope, 0};
    projection.m[2] = {0, 0, 1, 0};
    projection.m[3] = {0, 0, 1, 0};
    if (description_.kind == CameraDescription::Kind::orthographic) {
        projection.m[0] = {1 / width_slope, 0, 0, -origin_.x / width_slope};
        projection.m[1] = {0, 1 / height_slope, 0, -origin_.y / height_slope};
        projection.m[3] = {0, 0, 0, 1};
    }
    return projection * world_to_camera();
}

}  // namespace covtrace
