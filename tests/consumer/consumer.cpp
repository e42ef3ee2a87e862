// The first steps of a renderer with the library: light from a disc reflected by a floor, seen
// through a lens.
#include <cmath>
#include <covariance/covariance.hpp>
#include <cstdio>

namespace {

struct Vec {
    double x, y, z;
};

}  // namespace

int main() {
    const Vec towards_floor{0, -1, 0}, up{0, 1, 0};
    auto field = covariance::area_source(covariance::disc_moments(0.25),
                                         covariance::frame_along(towards_floor));
    field = covariance::travel(field, 2.0);
    const covariance::Surface<double> floor{up, Vec{1, 0, 0}, Vec{0, 0, 1}, {}};
    field = covariance::surface_enter(field, floor);
    field = covariance::reflect_diffuse(field, floor, up);
    field = covariance::surface_exit(field, floor);
    field = covariance::travel(field, 3.0);

    const covariance::ThinLens<double> lens{.e1 = {1, 0, 0},
                                            .e2 = {0, 0, 1},
                                            .e3 = {0, -1, 0},
                                            .focus_distance = 3,
                                            .lens_radius = 0.05,
                                            .pixels_x = 64,
                                            .pixels_y = 64,
                                            .shutter = 1};
    const auto sigma = covariance::sensor(field, lens);
    const auto spectrum = covariance::preintegrate(sigma);
    std::printf("%g %g %g\n", spectrum.xx, spectrum.xy, spectrum.yy);
    return covariance::is_finite(sigma) && spectrum.xx >= 0 && spectrum.yy >= 0 ? 0 : 1;
}
