// A small path tracer that filters its image by covariances, from the headers alone:
//   c++ -std=c++20 -O2 -I include examples/path_tracer.cpp -o path_tracer && ./path_tracer
// It traces as path tracers do, and tells the library what it meets (`Tracer::trace`, the part to
// read first). The covariances of some paths say how many samples each pixel gets and how each
// pixel is filtered (`main`). Pictures: plain.png (the same number of samples, evenly),
// filtered.png, reference.png, density.png, filters.png.
#include <covariance/renderer.hpp>
#include <cstdlib>

#include "teaching_scene.h"

namespace cov = covariance;
using Path = cov::Path<double>;

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
    const cov::ThinLens<double>& lens() const { return camera_.lens; }
    const cov::OccluderGrid<double>& grid() const { return grid_; }

    /// Traces an ordinary path: lamp sampled at diffuse surfaces, sky found by chance. Caustics of
    /// the lamp are left out, as in small path tracers. Every call of `path` is all that
    /// covariances need.
    void trace(int x, int y, Random& random, Path& path) const {
        const double time = (random.next() - 0.5) * camera_.lens.shutter;
        const double r = std::sqrt(random.next()), phi = 2 * M_PI * random.next();
        const double px = x + random.next(), py = y + random.next();
        Vec d, o, throughput{1, 1, 1};
        camera_.ray(px, py, r * std::cos(phi), r * std::sin(phi), o, d);
        path.begin(o, time);
        bool sees_lamp = true;
        for (int depth = 0; depth < 5; ++depth) {
            Hit hit = scene_.intersect(o, d, time);
            if (!hit.material) {
                path.add_sky(d, times(throughput, scene_.sky));
                return;
            }
            const Material& material = *hit.material;
            if (material.kind == Kind::lamp) {
                if (sees_lamp && dot(hit.normal, d) < 0)
                    path.add_lamp(lamp(), hit.position, times(throughput, scene_.radiance));
                return;
            }
            if (dot(hit.normal, d) > 0) hit.normal = -hit.normal, hit.curvature = -hit.curvature;
            path.add_vertex(vertex(hit, -d, length(hit.position - o)));
            throughput = times(throughput, color_at(hit));
            const Vec n = hit.normal;
            if (material.kind == Kind::diffuse) {
                sample_lamp(hit, throughput, random, path);
                sees_lamp = false;
                d = normalize(n + on_sphere(random));
            } else {
                d = d - 2 * dot(d, n) * n;
                if (material.kind == Kind::fuzzy) {
                    const double r3 = random.next();
                    d = normalize(d + material.fuzz * std::cbrt(r3) * on_sphere(random));
                }
                if (dot(d, n) <= 0) return;
            }
            o = hit.position;
        }
    }

  private:
    static Vec on_sphere(Random& random) {
        const double z = 2 * random.next() - 1, phi = 2 * M_PI * random.next();
        const double r = std::sqrt(1 - z * z);
        return {r * std::cos(phi), r * std::sin(phi), z};
    }

    /// The lamp. Its outline is in the grid.
    cov::Lamp<double> lamp() const {
        return cov::quad_lamp(scene_.quads[0].side_1, scene_.quads[0].side_2);
    }

    void sample_lamp(const Hit& hit, const Vec& throughput, Random& random, Path& path) const {
        const Quad& quad = scene_.quads[0];
        const double a = random.next(), b = random.next();
        const Vec point = quad.corner + a * quad.side_1 + b * quad.side_2;
        const Vec to = point - hit.position, w = normalize(to);
        const double cosines = dot(w, hit.normal) * -dot(w, lamp().normal);
        if (dot(w, hit.normal) <= 0 || cosines <= 0) return;
        if (!scene_.is_free(hit.position, point, path.time())) return;
        const double area = length(quad.side_1) * length(quad.side_2);
        const double share = cosines * area / (M_PI * dot(to, to));
        path.add_lamp(lamp(), point, share * times(throughput, scene_.radiance));
    }

    cov::PathVertex<double> vertex(const Hit& hit, const Vec& to_camera, double distance) const {
        const cov::Surface<double> surface{
            hit.normal, hit.tangent_1, hit.tangent_2,
            cov::Sym2<double>::diagonal(hit.curvature, hit.curvature)};
        const Material& m = *hit.material;
        using Lobe = cov::Lobe<double>;
        const Lobe lobe = m.kind == Kind::mirror  ? Lobe::mirror()
                          : m.kind == Kind::fuzzy ? Lobe::fuzzy(m.fuzz)
                                                  : Lobe::diffuse();
        return {hit.position,      surface, to_camera, lobe, texture(hit, surface, distance),
                {hit.velocity, {}}};
    }

    /// Covariance of the texture's colour at a point that is seen from `distance` away.
    cov::Sym2<double> texture(const Hit& hit, const cov::Surface<double>& surface,
                              double distance) const {
        const double half_pixel = distance / (2 * camera_.lens.pixels_x);
        const Vec edges = edges_of_checks(hit.in_object, hit.material->cell);
        if (hit.material->pattern == Pattern::checks)
            return cov::checkerboard_texture(edges.x, edges.y, half_pixel);
        if (hit.material->pattern == Pattern::solid_checks)
            return cov::solid_texture(cov::solid_checkerboard(edges, half_pixel), surface);
        return {};
    }

    Scene scene_;
    Camera camera_;
    cov::OccluderGrid<double> grid_;
};

/// Sample k of pixel i. Numbers of different passes are independent.
void trace(const Tracer& tracer, std::size_t i, std::uint64_t k, std::uint64_t pass, Path& path) {
    Random random(i, k, pass);
    tracer.trace(int(i) % width, int(i) / width, random, path);
}

std::vector<Vec> plain_image(const Tracer& tracer, int per_pixel, std::uint64_t pass) {
    std::vector<Vec> image(pixels);
    Path path;
    for (std::size_t i = 0; i < pixels; ++i)
        for (int k = 0; k < per_pixel; ++k) {
            trace(tracer, i, std::uint64_t(k), pass, path);
            const Vec color = path.color(cov::Part::scattered) + path.color(cov::Part::in_view);
            image[i] += color / per_pixel;
        }
    return image;
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

    cov::Film<double> film(width, height, samples);
    Path path;

    // 1. A few even samples, each followed back to its covariance.
    for (std::size_t i = 0; i < pixels; ++i)
        for (int k = 0; k < first_samples; ++k) {
            trace(tracer, i, std::uint64_t(k), 1, path);
            film.add(int(i) % width, int(i) / width, path, tracer.grid(), tracer.lens());
        }

    // 2. The rest of the samples where the covariances ask for them.
    const auto counts = film.plan();
    for (std::size_t i = 0; i < pixels; ++i)
        for (std::uint64_t k = first_samples; k < counts[i]; ++k) {
            trace(tracer, i, k, 1, path);
            film.add(int(i) % width, int(i) / width, path);
        }

    // 3. The image through its filters.
    const std::vector<Vec> filtered = film.filtered();

    // For comparison, plain path tracing of as many samples, and a reference in two halves.
    const auto plain = plain_image(tracer, samples, 2);
    const auto a = plain_image(tracer, reference_samples, 3),
               b = plain_image(tracer, reference_samples, 4);
    const double plain_error = relative_error(plain, a, b);
    const double filtered_error = relative_error(filtered, a, b);

    const cov::PartFilters<float> filters = film.filters();
    std::vector<Vec> reference(pixels), densities(pixels), sizes(pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        reference[i] = 0.5 * (a[i] + b[i]);
        const double d = counts[i] / (4.0 * samples);
        const double s = double(cov::filter_size(filters.scattered.covariance[i])) / 6;
        densities[i] = {d, d, d};
        sizes[i] = {s, s, s};
    }
    bool written = write_png(folder + "plain.png", width, height, plain);
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
