// Nanoseconds per operation, each on 1024 different light fields, the fastest of many rounds:
//   c++ -std=c++20 -O2 -I include bench/operators.cpp -o operators && ./operators
// With -D OTHER -I <CovarianceTracing>/include it also times Belcour's Covariance4D
// (github.com/belcour/CovarianceTracing), which has no time axis, side by side.
#include <chrono>
#include <covariance/covariance.hpp>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace cov = covariance;

namespace {

using Field = cov::LightField<double>;
using Vec = cov::Vec3<double>;

constexpr std::size_t fields = 1024;

/// Keeps the compiler from dropping a value that nobody reads, and the work that made it.
template <typename T>
void keep(T& value) {
    asm volatile("" : : "r"(&value) : "memory");
}

struct Case {
    Field field;
    cov::Surface<double> flat, curved;
    Vec outgoing;
};

double uniform() {
    return std::rand() / (RAND_MAX + 1.0);
}

Vec direction() {
    const double z = 2 * uniform() - 1, phi = 6.28 * uniform(), r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

std::vector<Case> make_cases() {
    std::vector<Case> cases;
    for (std::size_t i = 0; i < fields; ++i) {
        Case c;
        c.field.frame = cov::frame_along<double>(direction());
        for (int rank = 0; rank < 5; ++rank) {
            double w[5];
            for (double& v : w) v = 2 * uniform() - 1;
            for (std::size_t a = 0; a < 5; ++a)
                for (std::size_t b = a; b < 5; ++b) c.field.sigma(a, b) += w[a] * w[b];
        }
        Vec n = direction();
        if (dot(n, c.field.frame.z) > 0) n = -n;
        const auto t = cov::frame_along<double>(n);
        c.flat = c.curved = {n, t.x, t.y, {}};
        c.curved.curvature = {uniform(), 0.1, uniform()};
        c.outgoing = c.field.frame.z - 2 * dot(c.field.frame.z, n) * n;
        cases.push_back(c);
    }
    return cases;
}

/// Time per case of the fastest of `rounds` runs over all cases.
template <typename Cases, typename Operation>
double nanoseconds(const Cases& cases, const Operation& operation) {
    double best = 1e30;
    for (int round = 0; round < 300; ++round) {
        const auto begin = std::chrono::steady_clock::now();
        for (const auto& c : cases) {
            auto result = operation(c);
            keep(result);
        }
        const std::chrono::duration<double, std::nano> took =
            std::chrono::steady_clock::now() - begin;
        best = std::min(best, took.count() / double(cases.size()));
    }
    return best;
}

Field vertex(const Case& c, const cov::Surface<double>& surface) {
    Field f = cov::surface_enter(c.field, surface);
    f = cov::reflect_glossy(f, surface, c.outgoing, cov::micro_ggx(0.3, 0.3));
    return cov::travel(cov::surface_exit(f, surface), 2.0);
}

}  // namespace

#ifdef OTHER
#include <Covariance/Covariance4D.hpp>

namespace {

struct OtherVec {
    double x, y, z;
    static double Dot(const OtherVec& a, const OtherVec& b) {
        return a.x * b.x + a.y * b.y + a.z * b.z;
    }
    static OtherVec Cross(const OtherVec& a, const OtherVec& b) {
        return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    }
    static void Frame(const OtherVec& z, OtherVec& x, OtherVec& y) {
        const auto f = cov::frame_along<double>(z);
        x = {f.x.x, f.x.y, f.x.z}, y = {f.y.x, f.y.y, f.y.z};
    }
    void Normalize() {
        const double l = std::sqrt(Dot(*this, *this));
        x /= l, y /= l, z /= l;
    }
    friend OtherVec operator*(double s, const OtherVec& a) { return {s * a.x, s * a.y, s * a.z}; }
    friend OtherVec operator+(const OtherVec& a, const OtherVec& b) {
        return {a.x + b.x, a.y + b.y, a.z + b.z};
    }
    friend OtherVec operator-(const OtherVec& a) { return {-a.x, -a.y, -a.z}; }
};

using Other = Covariance::Covariance4D<OtherVec, double>;

struct OtherCase {
    Other field;
    OtherVec n, outgoing;
    double k1, k2;
};

OtherVec other(const Vec& v) {
    return {v.x, v.y, v.z};
}

Other other_vertex(const OtherCase& c, bool curved) {
    Other f = c.field;
    f.Projection(c.n);
    if (curved) f.Curvature(c.k1, c.k2);
    f.Symmetry();
    f.Reflection(0.28, 0.28);
    if (curved) f.Curvature(-c.k1, -c.k2);
    f.InverseProjection(c.outgoing);
    f.Travel(2.0);
    return f;
}

void print_others(const std::vector<Case>& ours) {
    std::vector<OtherCase> cases;
    for (const Case& c : ours) {
        const auto& s = c.field.sigma;
        const std::array<double, 10> m{s(0, 0), s(0, 1), s(1, 1), s(0, 2), s(1, 2),
                                       s(2, 2), s(0, 3), s(1, 3), s(2, 3), s(3, 3)};
        cases.push_back(
            {Other(m, other(c.field.frame.x), other(c.field.frame.y), other(c.field.frame.z)),
             other(c.flat.n), other(c.outgoing), c.curved.curvature.xx, c.curved.curvature.yy});
    }
    const auto print = [&](const char* name, const auto& operation) {
        std::printf("%-34s %7.1f\n", name, nanoseconds(cases, operation));
    };
    std::puts("Covariance4D (4x4, no time)");
    const auto with = [](const auto& change) {
        return [change](const OtherCase& c) {
            Other f = c.field;
            change(f, c);
            return f;
        };
    };
    print("copy", with([](Other&, const OtherCase&) {}));
    print("Travel", with([](Other& f, const OtherCase&) { f.Travel(2.0); }));
    print("Rotate", with([](Other& f, const OtherCase&) { f.Rotate(0.8, 0.6); }));
    print("Projection", with([](Other& f, const OtherCase& c) { f.Projection(c.n); }));
    print("Curvature", with([](Other& f, const OtherCase& c) { f.Curvature(c.k1, c.k2); }));
    print("Cosine", with([](Other& f, const OtherCase&) { f.Cosine(0.7); }));
    print("Reflection", with([](Other& f, const OtherCase&) { f.Reflection(0.28, 0.28); }));
    print("Add", with([](Other& f, const OtherCase& c) { f.Add(c.field, 2, 1); }));
    print("SpatialFilter", [](const OtherCase& c) {
        std::array<double, 3> s{};
        c.field.SpatialFilter(s[0], s[1], s[2]);
        return s;
    });
    print("vertex, flat", [](const OtherCase& c) { return other_vertex(c, false); });
    print("vertex, curved", [](const OtherCase& c) { return other_vertex(c, true); });
}

}  // namespace
#endif

int main() {
    const std::vector<Case> cases = make_cases();
    const auto print = [&](const char* name, const auto& operation) {
        std::printf("%-34s %7.1f\n", name, nanoseconds(cases, operation));
    };
    const cov::ThinLens<double> camera{
        .focus_distance = 3, .lens_radius = 0.1, .pixels_x = 500, .pixels_y = 500, .shutter = 0.02};
    std::puts("this library (5x5, double), ns per operation");
    print("copy", [](const Case& c) { return c.field; });
    print("travel", [](const Case& c) { return cov::travel(c.field, 2.0); });
    print("rotate_to", [](const Case& c) {
        return cov::rotate_to(c.field, {c.field.frame.y, -c.field.frame.x, c.field.frame.z});
    });
    print("surface_enter, flat", [](const Case& c) { return cov::surface_enter(c.field, c.flat); });
    print("surface_enter, curved",
          [](const Case& c) { return cov::surface_enter(c.field, c.curved); });
    print("surface_exit, flat", [](const Case& c) { return cov::surface_exit(c.field, c.flat); });
    print("surface_exit, curved",
          [](const Case& c) { return cov::surface_exit(c.field, c.curved); });
    print("motion_enter", [](const Case& c) {
        return cov::motion_enter(c.field, {{1, 2, 3}, {0, 1, 0}});
    });
    print("occlude", [](const Case& c) {
        return cov::occlude(c.field, c.outgoing, 0.01, {1, 2, 3});
    });
    print("add_texture", [](const Case& c) { return cov::add_texture(c.field, {1, 0.5, 2}); });
    print("reflect_diffuse",
          [](const Case& c) { return cov::reflect_diffuse(c.field, c.flat, c.outgoing); });
    print("reflect_specular",
          [](const Case& c) { return cov::reflect_specular(c.field, c.flat, c.outgoing); });
    print("reflect_glossy", [](const Case& c) {
        return cov::reflect_glossy(c.field, c.flat, c.outgoing, cov::micro_ggx(0.3, 0.3));
    });
    print("merge", [](const Case& c) { return cov::merge(c.field, 2, c.field, 1); });
    print("sensor", [&](const Case& c) { return cov::sensor(c.field, camera); });
    print("integrate_over_sensor",
          [](const Case& c) { return cov::integrate_over_sensor(c.field.sigma); });
    print("transform (any matrix)",
          [](const Case& c) { return cov::transform(c.field.sigma, cov::travel_matrix(2.0)); });
    print("vertex, flat", [](const Case& c) { return vertex(c, c.flat); });
    print("vertex, curved", [](const Case& c) { return vertex(c, c.curved); });
#ifdef OTHER
    print_others(cases);
#endif
}
