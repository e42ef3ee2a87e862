// A small path tracer that filters its image by covariances, from the headers alone:
//   c++ -std=c++20 -O2 -I include examples/path_tracer.cpp -o path_tracer && ./path_tracer
// It traces as path tracers do, remembers the vertices of some paths, and walks those back from the
// light to the camera (`covariance_of`, the part to read first). The covariances say how many
// samples each pixel gets and how each pixel is filtered. Pictures: plain.png (the same number of
// samples, evenly), filtered.png, reference.png, density.png, filters.png.
#include <covariance/renderer.hpp>
#include <cstdlib>

#include "teaching_scene.h"

namespace cov = covariance;

namespace {

constexpr int width = 256, height = 144;
constexpr std::size_t pixels = std::size_t(width) * height;
constexpr int samples = 8;             // per pixel, on average
constexpr int first_samples = 2;       // of `samples`: evenly spread, with covariances
constexpr int reference_samples = 96;  // in each of two halves

struct Camera {
    Vec eye{0.1, 1.5, 4.6};
    cov::ThinLens<double> lens;
    Camera() {
        const Vec forward = normalize(Vec{-0.1, 0.75, -1} - eye);
        lens.e1 = normalize(cross(forward, Vec{0, 1, 0}));
        lens.e2 = cross(forward, lens.e1);  // down
        lens.e3 = forward;
        lens.focus_distance = dot(Vec{-0.3, 0.8, -0.7} - eye, forward);
        lens.lens_radius = 0.1;
        lens.pixels_x = lens.pixels_y = 253;
        lens.shutter = 1.0 / 24;
    }
    /// The ray through a point of the image (pixels from its corner) and of the lens (the unit
    /// disc).
    void ray(double x, double y, double l1, double l2, Vec& origin, Vec& direction) const {
        const double u = (x - width / 2.0) / lens.pixels_x, v = (y - height / 2.0) / lens.pixels_y;
        const Vec focus = lens.focus_distance * (lens.e3 + u * lens.e1 + v * lens.e2);
        const Vec on_lens = lens.lens_radius * (l1 * lens.e1 + l2 * lens.e2);
        origin = eye + on_lens;
        direction = normalize(focus - on_lens);
    }
};

/// A vertex of a path, with all that the walk back needs of it.
struct Vertex {
    Hit hit;
    Vec to_camera;      ///< unit, to the next vertex towards the camera
    double direct = 0;  ///< mean radiance that the lamp adds at the pixel by way of this vertex
    Vec lamp_point;
};
struct Path {
    Vec origin;  ///< on the lens
    double time = 0;
    std::vector<Vertex> vertices;
    double found = 0;     ///< mean radiance at the pixel of the lamp or the sky at the end
    bool is_sky = false;  ///< the end is the sky, in the direction `escape`
    Vec escape;
    Vec color;             ///< radiance that the whole path brings
    bool in_view = false;  ///< no diffuse surface stands between the end and the camera
};

class Tracer {
  public:
    Tracer() : scene_(make_scene()) {
        // The grid gets everything that casts shadows or has an outline, the lamp too.
        for (const Quad& q : scene_.quads) {
            const Vec a = q.corner, b = a + q.side_1, c = b + q.side_2, d = a + q.side_2;
            grid_.add_triangle(a, b, c);
            grid_.add_triangle(a, c, d);
        }
        for (const Sphere& s : scene_.spheres) grid_.add_sphere(s.center, s.radius, s.velocity);
        grid_.build(-camera_.lens.shutter / 2, camera_.lens.shutter / 2);
    }
    const Camera& camera() const { return camera_; }

    /// Traces an ordinary path: lamp sampled at diffuse surfaces, sky found by chance. Caustics of
    /// the lamp are left out, as in small path tracers.
    Path trace(int x, int y, Random& random) const {
        Path path;
        path.time = (random.next() - 0.5) * camera_.lens.shutter;
        const double r = std::sqrt(random.next()), phi = 2 * M_PI * random.next();
        const double px = x + random.next(), py = y + random.next();
        Vec d, o, throughput{1, 1, 1};
        camera_.ray(px, py, r * std::cos(phi), r * std::sin(phi), o, d);
        path.origin = o;
        bool in_view = true;
        for (int depth = 0; depth < 5; ++depth) {
            Hit hit = scene_.intersect(o, d, path.time);
            if (!hit.material) {
                finish(path, times(throughput, scene_.sky), in_view);
                path.is_sky = true;
                path.escape = d;
                break;
            }
            if (hit.material->kind == Kind::lamp) {
                if (in_view && dot(hit.normal, d) < 0) {
                    path.vertices.push_back({hit, -d, 0, {}});
                    finish(path, times(throughput, scene_.radiance), in_view);
                }
                break;
            }
            if (dot(hit.normal, d) > 0) hit.normal = -hit.normal, hit.curvature = -hit.curvature;
            path.vertices.push_back({hit, -d, 0, {}});
            throughput = times(throughput, color_at(hit));
            const Vec n = hit.normal;
            if (hit.material->kind == Kind::diffuse) {
                add_direct(path, throughput, random);
                in_view = false;
                d = normalize(n + on_sphere(random));
            } else {
                d = d - 2 * dot(d, n) * n;
                if (hit.material->kind == Kind::fuzzy) {
                    const double r3 = random.next();
                    d = normalize(d + hit.material->fuzz * std::cbrt(r3) * on_sphere(random));
                }
                if (dot(d, n) <= 0) break;
            }
            o = hit.position;
        }
        return path;
    }

    /// Walks back along a path: the covariance of its light at the sensor, and the radiance it
    /// weighs.
    std::pair<cov::SymmetricMatrix5<double>, double> covariance_of(const Path& path) const {
        std::size_t i = path.vertices.size();
        const auto at = [&](std::size_t k) {
            return k == 0 ? path.origin : path.vertices[k - 1].hit.position;
        };
        cov::LightField<double> light;
        double weight = path.found;
        if (path.found > 0 && path.is_sky) {
            // Light from infinity has no variation in space, until it passes beside something.
            light = cov::distant_source(cov::frame_along<double>(-path.escape), {});
            light =
                i == 0 ? cov::arrive_from_infinity(grid_, light, at(0), camera_.lens, path.time)
                       : cov::arrive_from_infinity(grid_, light, at(i), window(path, i), path.time);
        } else if (path.found > 0) {
            --i;
            light = carry(path, lamp_light(path.vertices[i].to_camera), at(i + 1), i);
        }
        for (; i > 0; --i) {
            const Vertex& v = path.vertices[i - 1];
            const cov::Surface<double> surface = surface_of(v.hit);
            const cov::Motion<double> motion{v.hit.velocity, {}};
            const auto leave = [&](const cov::LightField<double>& field) {
                const auto textured =
                    cov::add_texture(field, texture(v, surface, length(at(i) - at(i - 1))));
                return cov::motion_exit(cov::surface_exit(textured, surface), motion);
            };
            if (weight > 0) light = leave(scatter(light, v, surface, motion, {}));
            if (v.direct > 0) {
                const Vec way = v.hit.position - v.lamp_point;
                auto lit = lamp_light(normalize(way));
                lit = cov::travel_past(grid_, lit, v.lamp_point, v.hit.position,
                                       cov::diffuse_receiver<double>, path.time);
                lit = leave(scatter(lit, v, surface, motion, {lamp_surface().n, length(way)}));
                light = weight > 0 ? cov::merge(light, weight, lit, v.direct) : lit;
                weight += v.direct;
            }
            if (weight > 0) light = carry(path, light, at(i), i - 1);
        }
        return {cov::sensor(light, camera_.lens), weight};
    }

  private:
    static Vec on_sphere(Random& random) {
        const double z = 2 * random.next() - 1, phi = 2 * M_PI * random.next();
        const double r = std::sqrt(1 - z * z);
        return {r * std::cos(phi), r * std::sin(phi), z};
    }

    static void finish(Path& path, const Vec& radiance, bool in_view) {
        path.found = mean(radiance);
        path.color += radiance;
        path.in_view = in_view;
    }

    void add_direct(Path& path, const Vec& throughput, Random& random) const {
        const Quad& lamp = scene_.quads[0];
        const Hit& hit = path.vertices.back().hit;
        const double a = random.next(), b = random.next();
        const Vec p = lamp.corner + a * lamp.side_1 + b * lamp.side_2;
        const Vec to = p - hit.position, w = normalize(to);
        const double cosines = dot(w, hit.normal) * -dot(w, lamp_surface().n);
        if (dot(w, hit.normal) <= 0 || cosines <= 0) return;
        if (!scene_.is_free(hit.position, p, path.time)) return;
        const double area = length(lamp.side_1) * length(lamp.side_2);
        const Vec added =
            cosines * area / (M_PI * dot(to, to)) * times(throughput, scene_.radiance);
        path.vertices.back().direct = mean(added);
        path.vertices.back().lamp_point = p;
        path.color += added;
    }

    cov::Surface<double> lamp_surface() const {
        const Quad& q = scene_.quads[0];
        return {normalize(cross(q.side_1, q.side_2)), normalize(q.side_1), normalize(q.side_2), {}};
    }
    /// The lamp's light along `direction`. Its outline is in the grid, so it is not added here.
    cov::LightField<double> lamp_light(const Vec& direction) const {
        const Quad& q = scene_.quads[0];
        const auto moments = cov::rectangle_moments(length(q.side_1), length(q.side_2));
        return cov::surface_exit(cov::area_source(moments, cov::frame_along<double>(direction)),
                                 lamp_surface());
    }

    static cov::Surface<double> surface_of(const Hit& h) {
        return {h.normal, h.tangent_1, h.tangent_2,
                cov::Sym2<double>::diagonal(h.curvature, h.curvature)};
    }

    /// The sharpness with which vertex i (counted from 1) sees occluders beside its light.
    static double window(const Path& path, std::size_t i) {
        const Material& m = *path.vertices[i - 1].hit.material;
        if (m.kind == Kind::mirror) return cov::mirror_receiver<double>;
        return m.kind == Kind::fuzzy ? cov::fuzz_cov(m.fuzz).xx : cov::diffuse_receiver<double>;
    }

    /// Carries light from a vertex to the one before it, or to the camera where `to` is 0, past
    /// occluders.
    cov::LightField<double> carry(const Path& path, const cov::LightField<double>& light,
                                  const Vec& from, std::size_t to) const {
        if (to == 0)
            return cov::travel_past(grid_, light, from, path.origin, camera_.lens, path.time);
        return cov::travel_past(grid_, light, from, path.vertices[to - 1].hit.position,
                                window(path, to), path.time);
    }

    static cov::LightField<double> scatter(cov::LightField<double> light, const Vertex& v,
                                           const cov::Surface<double>& surface,
                                           const cov::Motion<double>& motion,
                                           const cov::Emitter<double>& emitter) {
        light = cov::surface_enter(cov::motion_enter(light, motion), surface);
        switch (v.hit.material->kind) {
            case Kind::mirror:
                return cov::reflect_specular(light, surface, v.to_camera);
            case Kind::fuzzy:
                return cov::reflect_fuzzy(light, surface, v.to_camera, v.hit.material->fuzz);
            default:
                return cov::reflect_diffuse(light, surface, v.to_camera, emitter);
        }
    }

    /// Covariance of the texture's colour at a vertex that the camera sees from `distance` away.
    cov::Sym2<double> texture(const Vertex& v, const cov::Surface<double>& surface,
                              double distance) const {
        const Material& m = *v.hit.material;
        const double half_pixel = distance / (2 * camera_.lens.pixels_x);
        const Vec edges = edges_of_checks(v.hit.in_object, m.cell);
        if (m.pattern == Pattern::checks)
            return cov::checkerboard_texture(edges.x, edges.y, half_pixel);
        if (m.pattern == Pattern::solid_checks)
            return cov::solid_texture(cov::solid_checkerboard(edges, half_pixel), surface);
        return {};
    }

    Scene scene_;
    Camera camera_;
    cov::OccluderGrid<double> grid_;
};

/// Sums of the colours of samples, for scattered light and for light in view.
struct Film {
    std::vector<Vec> scattered = std::vector<Vec>(pixels), in_view = scattered;
    std::vector<std::uint32_t> count = std::vector<std::uint32_t>(pixels);

    void add(std::size_t pixel, const Path& path) {
        (path.in_view ? in_view : scattered)[pixel] += path.color;
        ++count[pixel];
    }
    std::vector<Vec> mean_of(const std::vector<Vec>& sums) const {
        std::vector<Vec> image = sums;
        for (std::size_t i = 0; i < pixels; ++i) image[i] /= std::max(1.0, double(count[i]));
        return image;
    }
    std::vector<Vec> image() const {
        std::vector<Vec> all = scattered;
        for (std::size_t i = 0; i < pixels; ++i) all[i] += in_view[i];
        return mean_of(all);
    }
};

void trace_evenly(const Tracer& tracer, Film& film, int per_pixel, std::uint64_t pass) {
    for (std::size_t i = 0; i < pixels; ++i)
        for (int k = 0; k < per_pixel; ++k) {
            Random random(i, std::uint64_t(k), pass);
            film.add(i, tracer.trace(int(i) % width, int(i) / width, random));
        }
}

/// Relative error of an image: mean of (error / reference)^2. The noise of the reference falls out,
/// as its halves `a` and `b` are independent.
double relative_error(const std::vector<Vec>& image, const std::vector<Vec>& a,
                      const std::vector<Vec>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
        const Vec true_color = 0.5 * (a[i] + b[i]);
        const double squared = dot(image[i] - a[i], image[i] - b[i]);
        sum += squared / (dot(true_color, true_color) + 0.01);
    }
    return sum / double(pixels);
}

}  // namespace

int main(int argc, char** argv) {
    const std::string folder = argc > 1 ? std::string(argv[1]) + "/" : "";
    const Tracer tracer;

    // 1. A few even samples, each followed back to its covariance.
    Film film;
    cov::CovarianceImage<float> scattered(width, height), in_view(width, height);
    for (std::size_t i = 0; i < pixels; ++i)
        for (int k = 0; k < first_samples; ++k) {
            Random random(i, std::uint64_t(k), 1);
            const int x = int(i) % width, y = int(i) / width;
            const Path path = tracer.trace(x, y, random);
            film.add(i, path);
            const auto [sigma, weight] = tracer.covariance_of(path);
            (path.in_view ? in_view : scattered).add(x, y, sigma, weight);
        }

    // 2. The rest of the samples where the covariances ask for them.
    const auto settings = cov::filter_settings(samples);
    const auto prediction = cov::preintegrate(cov::smooth(cov::merge(scattered, in_view)));
    const auto density =
        cov::relative_density(prediction, cov::DensityRule::tempered, settings.c, settings.limits);
    const auto counts =
        cov::allocate(density, samples * std::int64_t(pixels), film.count, 8 * samples);
    for (std::size_t i = 0; i < pixels; ++i)
        for (std::uint32_t k = film.count[i]; k < counts[i]; ++k) {
            Random random(i, k, 1);
            film.add(i, tracer.trace(int(i) % width, int(i) / width, random));
        }

    // 3. Filters, limited by their neighbours, and the gather.
    const auto filters = cov::filters_of_parts(scattered, in_view, samples);
    const auto gathered =
        cov::gather(film.mean_of(film.scattered), film.mean_of(film.in_view), film.count, filters);
    const std::vector<Vec> filtered(gathered.begin(), gathered.end());

    // For comparison, plain path tracing of as many samples, and a reference in two halves.
    Film plain, half_1, half_2;
    trace_evenly(tracer, plain, samples, 2);
    trace_evenly(tracer, half_1, reference_samples, 3);
    trace_evenly(tracer, half_2, reference_samples, 4);
    const auto a = half_1.image(), b = half_2.image();
    const double plain_error = relative_error(plain.image(), a, b);
    const double filtered_error = relative_error(filtered, a, b);

    std::vector<Vec> reference(pixels), densities(pixels), sizes(pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        reference[i] = 0.5 * (a[i] + b[i]);
        const double d = counts[i] / (4.0 * samples);
        const double s = double(cov::filter_size(filters.scattered.covariance[i])) / 6;
        densities[i] = {d, d, d};
        sizes[i] = {s, s, s};
    }
    bool written = write_png(folder + "plain.png", width, height, plain.image());
    written = write_png(folder + "filtered.png", width, height, filtered) && written;
    written = write_png(folder + "reference.png", width, height, reference) && written;
    written = write_png(folder + "density.png", width, height, densities) && written;
    written = write_png(folder + "filters.png", width, height, sizes) && written;
    if (!written) {
        std::fputs("the pictures could not be written\n", stderr);
        return EXIT_FAILURE;
    }
    std::printf("relative squared error at %d samples: plain %.5f, filtered %.5f, ratio %.2f\n",
                samples, plain_error, filtered_error, plain_error / filtered_error);
    return plain_error > 3.5 * filtered_error ? EXIT_SUCCESS : EXIT_FAILURE;
}
