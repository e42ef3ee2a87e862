#include "oracle_operators.h"

#include <functional>
#include <map>
#include <regex>
#include <stdexcept>

namespace oracle {

namespace cov = covariance;

namespace {

using Field = cov::LightField<double>;
using Sym2 = cov::Sym2<double>;
using Vec3 = cov::Vec3<double>;

Vec3 vec3(const Json& j) {
    if (j.size() != 3) throw std::invalid_argument("expected three numbers: " + j.dump());
    return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()};
}

Sym2 sym2(const Json& j) {
    return {j.at(0).at(0).get<double>(), j.at(0).at(1).get<double>(), j.at(1).at(1).get<double>()};
}

cov::Mat2<double> mat2(const Json& j) {
    return {j.at(0).at(0).get<double>(), j.at(0).at(1).get<double>(), j.at(1).at(0).get<double>(),
            j.at(1).at(1).get<double>()};
}

Matrix sym5(const Json& j) {
    if (j.size() != 5) throw std::invalid_argument("expected a 5x5 matrix");
    Matrix s;
    for (std::size_t i = 0; i < 5; ++i)
        for (std::size_t k = i; k < 5; ++k) s(i, k) = j.at(i).at(k).get<double>();
    return s;
}

double number(const Json& params, const char* key) {
    return params.at(key).get<double>();
}

cov::Frame<double> frame(const Json& p, const std::string& suffix = "") {
    return {vec3(p.at("X" + suffix)), vec3(p.at("Y" + suffix)), vec3(p.at("Z" + suffix))};
}

cov::Surface<double> surface(const Json& p) {
    return {vec3(p.at("n")), vec3(p.at("T1")), vec3(p.at("T2")), sym2(p.at("kappa"))};
}

cov::Motion<double> motion(const Json& p) {
    return {vec3(p.at("vel")), vec3(p.at("omega"))};
}

Sym2 curvature(const Json& p) {
    return {number(p, "k11"), number(p, "k12"), number(p, "k22")};
}

Quantity quantity(const char* name, const Sym2& m) {
    return {name, {m.xx, m.xy, m.xy, m.yy}};
}

Result sigma(const Matrix& s, std::optional<cov::Matrix5<double>> a = std::nullopt) {
    return {{{"Sigma", flatten(s)}}, a};
}

Matrix input(const Json& v, const char* key = "Sigma") {
    return sym5(v.at("input").at(key));
}

Result specular_event(const Json& v) {
    const Json& p = v.at("params");
    const Field arriving{input(v), frame(p, "i")};
    const cov::Frame<double> leaving = frame(p, "o");
    const cov::Surface<double> hit = surface(p);
    const double n1 = number(p, "n1"), n2 = number(p, "n2");

    Field f = cov::motion_enter(arriving, motion(p));
    f = cov::surface_enter(f, hit);
    f = cov::refract_to(f, hit, leaving, n1, n2);
    f = cov::surface_exit(f, hit);
    f = cov::motion_exit(f, motion(p));

    const cov::Matrix5<double> a =
        cov::motion_enter_matrix(arriving.frame, motion(p)) *
        cov::surface_enter_matrix(arriving.frame, hit) *
        cov::angular_map_matrix(cov::specular_map(arriving.frame, leaving, hit, n1, n2)) *
        cov::surface_exit_matrix(leaving, hit) * cov::motion_exit_matrix(leaving, motion(p));
    return sigma(f.sigma, a);
}

Result average(const Json& v) {
    cov::Accumulator<double> sum;
    std::size_t i = 0;
    for (const Json& w : v.at("params").at("w")) {
        const std::string key = "Sigma" + (i == 0 ? std::string() : std::to_string(i + 1));
        sum.add(input(v, key.c_str()), w.get<double>());
        ++i;
    }
    return sigma(sum.mean());
}

Result micro_cov(const Json& v) {
    const Json& p = v.at("params");
    const std::string kind = p.at("kind").get<std::string>();
    const double a = number(p, "a");
    const double b = p.contains("b") && !p.at("b").is_null() ? number(p, "b") : a;
    if (kind == "beckmann") return {{quantity("C", cov::micro_beckmann(a, b))}, {}};
    if (kind == "ggx") return {{quantity("C", cov::micro_ggx(a, b))}, {}};
    if (kind == "blinn" && a == b) return {{quantity("C", cov::micro_blinn(a))}, {}};
    throw std::invalid_argument("unknown slope distribution " + kind);
}

Result sensor(const Json& v) {
    const Json& p = v.at("params");
    const cov::ThinLens<double> camera{
        vec3(p.at("E1")),         vec3(p.at("E2")), vec3(p.at("E3")), number(p, "z_focus"),
        number(p, "lens_radius"), number(p, "fpx"), number(p, "fpy"), number(p, "shutter")};
    return sigma(cov::sensor(Field{input(v), frame(p)}, camera),
                 cov::sensor_matrix(frame(p), camera));
}

Result preintegrate(const Json& v) {
    return {{quantity("Sigma2D", cov::preintegrate(input(v), sym5(v.at("params").at("W"))))}, {}};
}

Result n_samples(const Json& v) {
    const Json& p = v.at("params");
    const auto n = cov::sample_count(input(v), sym5(p.at("W")), number(p, "k_img"));
    return {{{"N", {n.total}}, {"N_image", {n.image}}, {"N_int", {n.integration}}}, {}};
}

Result filter_quadratic(const Json& v) {
    const Json& p = v.at("params");
    const Sym2 q = cov::filter_quadratic(sym2(v.at("input").at("Sigma2D")), number(p, "c"),
                                         {number(p, "sigma_min"), number(p, "sigma_max")});
    return {{quantity("Q", q)}, {}};
}

Result occlusion(const Json& v) {
    const Json& p = v.at("params");
    const Numbers d = flatten(p.at("d"));
    const Numbers velocity = p.contains("vel2") ? flatten(p.at("vel2")) : Numbers{0, 0};
    return sigma(cov::occlude(input(v), d.at(0), d.at(1), number(p, "r"), velocity.at(0),
                              velocity.at(1), p.value("beta", 0.5)));
}

using Operation = std::function<Result(const Json& vector, const Json& params)>;

const std::map<std::string, Operation>& operations() {
    static const std::map<std::string, Operation> table{
        {"travel",
         [](const Json& v, const Json& p) {
             const double d = number(p, "d");
             return sigma(cov::travel(input(v), d), cov::travel_matrix(d));
         }},
        {"rotate_axes",
         [](const Json& v, const Json& p) {
             const double alpha = number(p, "alpha");
             return sigma(cov::rotate(input(v), alpha),
                          cov::transverse_matrix(cov::rotation(alpha)));
         }},
        {"flip_y",
         [](const Json& v, const Json&) {
             return sigma(cov::flip_y(input(v)),
                          cov::transverse_matrix(cov::Mat2<double>{1, 0, 0, -1}));
         }},
        {"project_aligned",
         [](const Json& v, const Json& p) {
             const double c = number(p, "cos");
             return sigma(cov::project_aligned(input(v), c), cov::project_aligned_matrix(c));
         }},
        {"unproject_aligned",
         [](const Json& v, const Json& p) {
             const double c = number(p, "cos");
             return sigma(cov::unproject_aligned(input(v), c), cov::project_aligned_matrix(1 / c));
         }},
        {"curvature_enter_aligned",
         [](const Json& v, const Json& p) {
             const double c = number(p, "cos_i");
             const auto slope = cov::curvature_aligned_slope(curvature(p), c);
             return sigma(cov::curvature_aligned(input(v), curvature(p), c),
                          cov::position_matrix(cov::Mat2<double>::identity(), slope));
         }},
        {"mirror_curved_aligned",
         [](const Json& v, const Json& p) {
             const double c = number(p, "cos");
             const auto slope = cov::mirror_aligned_slope(curvature(p), c);
             return sigma(cov::mirror_aligned(input(v), curvature(p), c),
                          cov::position_matrix(cov::Mat2<double>::identity(), slope));
         }},
        {"refract_aligned",
         [](const Json& v, const Json& p) {
             const double n1 = number(p, "n1"), n2 = number(p, "n2");
             const double c1 = number(p, "cos_i"), c2 = number(p, "cos_t");
             return sigma(cov::refract_aligned(input(v), n1, n2, c1, c2, curvature(p)),
                          cov::refract_aligned_matrix(n1, n2, c1, c2, curvature(p)));
         }},
        {"surface_enter",
         [](const Json& v, const Json& p) {
             return sigma(cov::surface_enter(input(v), frame(p), surface(p)),
                          cov::surface_enter_matrix(frame(p), surface(p)));
         }},
        {"surface_exit",
         [](const Json& v, const Json& p) {
             return sigma(cov::surface_exit(input(v), frame(p), surface(p)),
                          cov::surface_exit_matrix(frame(p), surface(p)));
         }},
        {"specular_event", [](const Json& v, const Json&) { return specular_event(v); }},
        {"motion_enter",
         [](const Json& v, const Json& p) {
             return sigma(cov::motion_enter(input(v), frame(p), motion(p)),
                          cov::motion_enter_matrix(frame(p), motion(p)));
         }},
        {"motion_exit",
         [](const Json& v, const Json& p) {
             return sigma(cov::motion_exit(input(v), frame(p), motion(p)),
                          cov::motion_exit_matrix(frame(p), motion(p)));
         }},
        {"lens",
         [](const Json& v, const Json& p) {
             const double f = number(p, "f");
             return sigma(cov::lens(input(v), f), cov::lens_matrix(f));
         }},
        {"travel_then_lens",
         [](const Json& v, const Json& p) {
             const double f = number(p, "f"), d = number(p, "d");
             return sigma(cov::lens(cov::travel(input(v), d), f),
                          cov::travel_matrix(d) * cov::lens_matrix(f));
         }},
        {"lens_then_travel",
         [](const Json& v, const Json& p) {
             const double f = number(p, "f"), d = number(p, "d");
             return sigma(cov::travel(cov::lens(input(v), f), d),
                          cov::lens_matrix(f) * cov::travel_matrix(d));
         }},
        {"sensor", [](const Json& v, const Json&) { return sensor(v); }},
        {"occlusion", [](const Json& v, const Json&) { return occlusion(v); }},
        {"texture",
         [](const Json& v, const Json& p) {
             return sigma(cov::add_texture(input(v), sym2(p.at("T2"))));
         }},
        {"angular_window",
         [](const Json& v, const Json& p) {
             return sigma(cov::add_angular_window(input(v), sym2(p.at("W2"))));
         }},
        {"angular_convolution",
         [](const Json& v, const Json& p) {
             return sigma(cov::convolve_angular(input(v), sym2(p.at("C"))));
         }},
        {"harmonic",
         [](const Json& v, const Json&) {
             return sigma(cov::harmonic_sum(input(v), input(v, "Sigma2")));
         }},
        {"average", [](const Json& v, const Json&) { return average(v); }},
        {"micro_cov", [](const Json& v, const Json&) { return micro_cov(v); }},
        {"refraction_cov",
         [](const Json&, const Json& p) {
             return Result{
                 {quantity("C", cov::refraction_cov(sym2(p.at("Cm")), mat2(p.at("P_out")),
                                                    number(p, "cos_i"), number(p, "cos_t"),
                                                    number(p, "n1"), number(p, "n2")))},
                 {}};
         }},
        {"preintegrate", [](const Json& v, const Json&) { return preintegrate(v); }},
        {"project2",
         [](const Json& v, const Json&) {
             return Result{{quantity("Sigma2D", cov::project2(input(v)))}, {}};
         }},
        {"n_samples", [](const Json& v, const Json&) { return n_samples(v); }},
        {"filter_quadratic", [](const Json& v, const Json&) { return filter_quadratic(v); }},
    };
    return table;
}

/// The decimal numbers in the text of a step, such as 0.8 in "travel 0.8".
Numbers numbers_in(const std::string& text) {
    static const std::regex pattern(R"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)");
    Numbers found;
    for (std::sregex_iterator i(text.begin(), text.end(), pattern), end; i != end; ++i)
        found.push_back(std::stod(i->str()));
    return found;
}

/// The number that follows `key` in the text of a step; throws where there is none.
double number_after(const std::string& text, const std::string& key) {
    const std::size_t at = text.find(key);
    const Numbers found =
        at == std::string::npos ? Numbers{} : numbers_in(text.substr(at + key.size()));
    if (found.empty()) throw std::invalid_argument("no number after '" + key + "' in: " + text);
    return found.front();
}

}  // namespace

Numbers flatten(const Json& array) {
    if (array.is_number()) return {array.get<double>()};
    if (!array.is_array()) throw std::invalid_argument("expected numbers: " + array.dump());
    Numbers all;
    for (const Json& item : array)
        for (const double x : flatten(item)) all.push_back(x);
    return all;
}

Numbers flatten(const Matrix& s) {
    Numbers all;
    for (std::size_t i = 0; i < 5; ++i)
        for (std::size_t j = 0; j < 5; ++j) all.push_back(s(i, j));
    return all;
}

Result apply(const Json& vector) {
    const std::string op = vector.at("op").get<std::string>();
    const auto found = operations().find(op);
    if (found == operations().end()) throw std::invalid_argument("unknown operation " + op);
    return found->second(vector, vector.at("params"));
}

std::vector<Step> follow_chain(const Json& vector) {
    const Json& p = vector.at("params");
    const Vec3 hit = vec3(p.at("P1")), light = vec3(p.at("light"));
    const cov::Surface<double> s = surface(p);
    const cov::Frame<double> incoming = frame(p, "i"), outgoing = frame(p, "o");

    double travelled = 0;
    bool diffuse = false;
    Field f{{}, incoming};
    std::vector<Step> steps;
    for (const Json& item : vector.at("steps")) {
        const std::string name = item.at("step").get<std::string>();
        const auto begins = [&name](const char* with) { return name.rfind(with, 0) == 0; };
        if (begins("emission")) {
            const double deviation = number_after(name, "std");
            f = cov::area_source(Sym2::diagonal(deviation * deviation, deviation * deviation),
                                 incoming);
        } else if (begins("travel to lens")) {
            f = cov::travel(f, cov::length(hit));  // the lens is at the origin
        } else if (begins("travel rest")) {
            f = cov::travel(f, cov::length(hit - light) - travelled);
        } else if (begins("travel")) {
            travelled += number_after(name, "travel");
            f = cov::travel(f, number_after(name, "travel"));
        } else if (begins("occlusion d=X")) {
            const Numbers velocity = numbers_in(name.substr(name.find("v=(")));
            f = {cov::occlude(f.sigma, 1, 0, number_after(name, "r="), velocity.at(0),
                              velocity.at(1), number_after(name, "beta=")),
                 f.frame};
        } else if (begins("motion_enter")) {
            f = cov::motion_enter(f, motion(p));
        } else if (begins("surface_enter")) {
            f = cov::surface_enter(f, s);
        } else if (begins("cosine window")) {
            f = cov::add_cosine_window(f, s);
        } else if (begins("diffuse slice")) {
            f = {cov::convolve_angular(f.sigma, Sym2{}), outgoing};
            diffuse = true;
        } else if (begins("GGX")) {
            const double alpha = number_after(name, "GGX");
            f = cov::reflect_glossy(f, s, outgoing.z, cov::micro_ggx(alpha, alpha));
        } else if (begins("texture")) {
            // The file names no numbers for this step unless they stand in its text.
            const Numbers t = numbers_in(name);
            f = cov::add_texture(f, t.size() == 3 ? Sym2{t[0], t[1], t[2]} : Sym2{30, 5, 10});
        } else if (begins("surface_exit")) {
            f = diffuse ? cov::surface_exit(f, s, outgoing) : cov::surface_exit(f, s);
        } else if (begins("motion_exit")) {
            f = cov::motion_exit(f, motion(p));
        } else if (begins("sensor")) {
            const double pixels = number_after(name, " f=");
            const cov::ThinLens<double> camera{{1, 0, 0},
                                               {0, -1, 0},
                                               {0, 0, -1},
                                               number_after(name, "zf="),
                                               number_after(name, "R="),
                                               pixels,
                                               pixels,
                                               number_after(name, "shutter=")};
            f = {cov::sensor(f, camera), f.frame};
        } else {
            throw std::invalid_argument("unknown step of a chain: " + name);
        }
        steps.push_back({name, f.sigma});
    }
    return steps;
}

}  // namespace oracle
