#include <pybind11/pybind11.h>

#include "bindings.h"
#include "vectorize.h"

namespace covtrace::python {

namespace cov = covariance;

namespace {

using Sigma = cov::SymmetricMatrix5<double>;
using Field = cov::LightField<double>;
using Frame = cov::Frame<double>;
using Vec3 = cov::Vec3<double>;
using Mat2 = cov::Mat2<double>;
using Sym2 = cov::Sym2<double>;
using Matrix5 = cov::Matrix5<double>;

/// Makes a surface from the rows t1, t2, n and its shape operator in the basis t1, t2.
cov::Surface<double> surface_of(const Frame& rows, const Sym2& curvature) {
    return {rows.z, rows.x, rows.y, curvature};
}

/// Makes a lens from the camera's axes, given as the rows e1, e2, e3.
cov::ThinLens<double> thin_lens(const Frame& axes, double focus_distance, double lens_radius,
                                double pixels_x, double pixels_y, double shutter) {
    return {axes.x, axes.y, axes.z, focus_distance, lens_radius, pixels_x, pixels_y, shutter};
}

cov::OrthographicLens<double> orthographic(const Frame& axes, double focus_distance,
                                           double lens_radius, double pixels_x, double pixels_y,
                                           double shutter) {
    return {axes.x, axes.y, axes.z, focus_distance, lens_radius, pixels_x, pixels_y, shutter};
}

void bind_ray(py::module_& m) {
    m.def("transform", vectorized(+[](Sigma s, Matrix5 a) { return cov::transform(s, a); }));
    m.def("travel", vectorized(+[](Sigma s, double d) { return cov::travel(s, d); }));
    m.def("lens", vectorized(+[](Sigma s, double f) { return cov::lens(s, f); }));
    m.def("change_transverse",
          vectorized(+[](Sigma s, Mat2 q) { return cov::change_transverse(s, q); }));
    m.def("rotate_to", vectorized(+[](Sigma s, Frame from, Frame to) {
              return cov::rotate_to(Field{s, from}, to);
          }));
    m.def("frame_along", vectorized(+[](Vec3 z) { return cov::frame_along<double>(z); }));
    m.def("occlude", vectorized(+[](Sigma s, double dx, double dy, double r, double vx, double vy) {
              return cov::occlude(s, dx, dy, r, vx, vy);
          }));
    m.def("motion_enter", vectorized(+[](Sigma s, Frame f, Vec3 velocity, Vec3 turn) {
              return cov::motion_enter(s, f, cov::Motion<double>{velocity, turn});
          }));
    m.def("motion_exit", vectorized(+[](Sigma s, Frame f, Vec3 velocity, Vec3 turn) {
              return cov::motion_exit(s, f, cov::Motion<double>{velocity, turn});
          }));
}

void bind_surface(py::module_& m) {
    m.def("surface_enter", vectorized(+[](Sigma s, Frame f, Frame rows, Sym2 k) {
              return cov::surface_enter(s, f, surface_of(rows, k));
          }));
    m.def("surface_exit", vectorized(+[](Sigma s, Frame f, Frame rows, Sym2 k) {
              return cov::surface_exit(s, f, surface_of(rows, k));
          }));
    m.def("reflect_specular", vectorized(+[](Sigma s, Frame f, Frame rows, Vec3 out) {
              return cov::reflect_specular(Field{s, f}, surface_of(rows, {}), out);
          }));
    m.def("reflect_glossy", vectorized(+[](Sigma s, Frame f, Frame rows, Vec3 out, Sym2 micro) {
              return cov::reflect_glossy(Field{s, f}, surface_of(rows, {}), out, micro);
          }));
    m.def("reflect_lobe", vectorized(+[](Sigma s, Frame f, Frame rows, Vec3 out, Sym2 lobe) {
              return cov::reflect_lobe(Field{s, f}, surface_of(rows, {}), out, lobe);
          }));
    m.def("reflect_diffuse", vectorized(+[](Sigma s, Frame f, Frame rows, Vec3 out) {
              return cov::reflect_diffuse(Field{s, f}, surface_of(rows, {}), out);
          }));
    m.def("refract", vectorized(+[](Sigma s, Frame f, Frame rows, Vec3 out, double n1, double n2) {
              return cov::refract(Field{s, f}, surface_of(rows, {}), out, n1, n2);
          }));
    m.def("refract_glossy",
          vectorized(+[](Sigma s, Frame f, Frame rows, Vec3 out, double n1, double n2, Sym2 micro) {
              return cov::refract_glossy(Field{s, f}, surface_of(rows, {}), out, n1, n2, micro);
          }));
    m.def("convolve_angular",
          vectorized(+[](Sigma s, Sym2 kernel) { return cov::convolve_angular(s, kernel); }));
    m.def("add_angular_window",
          vectorized(+[](Sigma s, Sym2 window) { return cov::add_angular_window(s, window); }));
    m.def("add_texture",
          vectorized(+[](Sigma s, Sym2 texture) { return cov::add_texture(s, texture); }));
    m.def("micro_beckmann",
          vectorized(+[](double ax, double ay) { return cov::micro_beckmann(ax, ay); }));
    m.def("micro_ggx", vectorized(+[](double ax, double ay) { return cov::micro_ggx(ax, ay); }));
    m.def("phong_cov", vectorized(+[](double exponent) { return cov::phong_cov(exponent); }));
}

void bind_ends(py::module_& m) {
    m.def("disc_moments", vectorized(+[](double radius) { return cov::disc_moments(radius); }));
    m.def("rectangle_moments",
          vectorized(+[](double a, double b) { return cov::rectangle_moments(a, b); }));
    m.def("area_source",
          vectorized(+[](Sym2 moments) { return cov::area_source(moments, Frame{}).sigma; }));
    m.def("point_source",
          vectorized(+[](double r_min) { return cov::point_source(Frame{}, r_min).sigma; }));
    m.def("sun_source",
          vectorized(+[](double radius) { return cov::sun_source(Frame{}, radius).sigma; }));
    m.def("distant_source",
          vectorized(+[](Sym2 angular) { return cov::distant_source(Frame{}, angular).sigma; }));
    m.def("sensor", vectorized(+[](Sigma s, Frame f, Frame axes, double focus, double radius,
                                   double px, double py_, double shutter) {
              return cov::sensor(s, f, thin_lens(axes, focus, radius, px, py_, shutter));
          }));
    m.def("sensor_orthographic",
          vectorized(+[](Sigma s, Frame f, Frame axes, double focus, double radius, double px,
                         double py_, double shutter) {
              return cov::sensor(s, f, orthographic(axes, focus, radius, px, py_, shutter));
          }));
    m.def("preintegrate",
          vectorized(+[](Sigma s, Sigma window) { return cov::preintegrate(s, window); }));
    m.def("sensor_window", vectorized(+[](double lens, double shutter) {
              return cov::sensor_window(lens, shutter);
          }));
    m.attr("disc_lens_window") = cov::disc_lens_window<double>;
    m.attr("square_lens_window") = cov::square_lens_window<double>;
    m.attr("box_shutter_window") = cov::box_shutter_window<double>;
    m.def("integration_count",
          vectorized(+[](Sigma s, Sigma window) { return cov::integration_count(s, window); }));
    m.def("image_density", vectorized(+[](Sym2 spectrum) { return cov::image_density(spectrum); }));
    m.def("hypercube_density", vectorized(+[](Sym2 spectrum, double integration) {
              return cov::hypercube_density(spectrum, integration);
          }));
    m.def("filter_sharpness", vectorized(+[](double spp) { return cov::filter_sharpness(spp); }));
    m.def("filter_covariance", vectorized(+[](Sym2 spectrum, double c, double s_min, double s_max) {
              return cov::filter_covariance(
                  cov::filter_quadratic(spectrum, c, cov::FilterLimits<double>{s_min, s_max}));
          }));
    m.def("thesis_filter_covariance", vectorized(+[](Sym2 spectrum, double s_min, double s_max) {
              return cov::filter_covariance(
                  cov::thesis_filter_quadratic(spectrum, cov::FilterLimits<double>{s_min, s_max}));
          }));
}

}  // namespace

void bind_covariance(py::module_& module) {
    py::module_ m = module.def_submodule("covariance");
    bind_ray(m);
    bind_surface(m);
    bind_ends(m);
}

}  // namespace covtrace::python
