// Follows one path through a scene of a few lines: a checkered floor that slides by, a disc light,
// a ball that almost covers the light, a camera with a lens. Needs the headers and nothing else:
//   c++ -std=c++20 -I include examples/follow_a_path.cpp && ./a.out
#include <cmath>
#include <covariance/covariance.hpp>
#include <cstdio>

namespace cov = covariance;

struct Vec {  // the renderer's own vector type; the library takes any with x, y, z
    double x, y, z;
    friend Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vec operator*(double s, Vec a) { return {s * a.x, s * a.y, s * a.z}; }
    friend double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    friend double length(Vec a) { return std::sqrt(dot(a, a)); }
    friend Vec unit(Vec a) { return (1 / length(a)) * a; }
};

int main() {
    // The scene, in metres and seconds.
    const Vec light{1, 3, -2}, light_normal{0, -1, 0};
    const double light_radius = 0.3;
    const Vec ball{0.9, 1.2, -2.8};
    const double ball_radius = 0.2;
    const Vec floor_velocity{0.5, 0, 0};
    const double square = 0.4;
    const cov::ThinLens<double> camera{.e1 = {1, 0, 0},
                                       .e2 = {0, -1, 0},
                                       .e3 = {0, 0, -1},
                                       .focus_distance = 3,
                                       .lens_radius = 0.02,
                                       .pixels_x = 800,
                                       .pixels_y = 800,
                                       .shutter = 1.0 / 48};
    const Vec eye{0, 1, 2};

    // Trace as every path tracer does, from the camera: one pixel, the floor y = 0, the light.
    const double pixel_x = 60, pixel_y = 150;  // from the centre of the image
    const Vec view = unit(Vec{pixel_x / camera.pixels_x, -pixel_y / camera.pixels_y, -1});
    const Vec hit = eye + (-eye.y / view.y) * view;
    const Vec to_light = unit(light - hit);

    // Walk back from the light. Z of every frame is the way the light goes.
    const cov::Surface<double> lamp{light_normal, Vec{1, 0, 0}, Vec{0, 0, 1}, {}};
    const cov::Surface<double> floor{Vec{0, 1, 0}, Vec{1, 0, 0}, Vec{0, 0, 1}, {}};
    const cov::Motion<double> sliding{floor_velocity, {}};

    auto field = cov::area_source(cov::disc_moments(light_radius), cov::frame_along(-1 * to_light));
    field = cov::surface_exit(field, lamp);

    const double along = dot(light - ball, to_light), whole = length(light - hit);
    const Vec off_axis = ball - (light - along * to_light);  // from the ray to the ball's centre
    const double clearance = length(off_axis) - ball_radius;
    std::printf("the ball passes the ray at %.3f m\n", clearance);
    field = cov::travel(field, along);
    field = cov::occlude(field, clearance * unit(off_axis), 1e-3);
    field = cov::travel(field, whole - along);

    // Distances along both axes to the nearest edge of the checkerboard.
    const double ex = std::abs(hit.x - square * std::round(hit.x / square));
    const double ez = std::abs(hit.z - square * std::round(hit.z / square));
    field = cov::motion_enter(field, sliding);
    field = cov::surface_enter(field, floor);
    field = cov::reflect_diffuse(field, floor, -1 * view);
    field = cov::add_texture(field, cov::checkerboard_texture(ex, ez, 0.002));
    field = cov::surface_exit(field, floor);
    field = cov::motion_exit(field, sliding);
    field = cov::travel(field, length(hit - eye));

    // A renderer adds many of these per pixel, weighted by the radiance each path carries.
    cov::Accumulator<double> pixel;
    pixel.add(cov::sensor(field, camera), 1.0);
    const cov::SymmetricMatrix5<double> sigma = pixel.mean();

    std::puts("covariance over pixel x, pixel y, lens 1, lens 2, shutter:");
    for (std::size_t i = 0; i < 5; ++i, std::puts(""))
        for (std::size_t j = 0; j < 5; ++j) std::printf(" %11.3e", sigma(i, j));

    const auto spectrum = cov::preintegrate(sigma);
    std::printf("after lens and shutter, in (cycles/pixel)^2: xx %.3e  xy %.3e  yy %.3e\n",
                spectrum.xx, spectrum.xy, spectrum.yy);

    const double c = cov::filter_sharpness(16.0);
    const auto filter = cov::filter_covariance(cov::filter_quadratic(spectrum, c));
    const auto axes = cov::eigen(filter);
    std::printf(
        "filter: %.2f by %.2f pixels (standard deviations), the long axis along (%.2f, %.2f)\n",
        std::sqrt(axes.high), std::sqrt(axes.low), axes.x, axes.y);

    const auto usable = cov::limit_spectrum(spectrum, c, 0.5, 15);
    const double lens_and_time = cov::integration_count(sigma);
    std::printf("%.2f samples per pixel (%.2f for lens and shutter alone)\n",
                cov::image_factor(c, 4) * cov::image_density(usable) * lens_and_time,
                lens_and_time);
    return cov::is_finite(sigma) ? 0 : 1;
}
