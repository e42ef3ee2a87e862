#include "frequency/round_lobe.h"

#include <cmath>

#include "frequency/axes4.h"
#include "frequency/fresnel_derivatives.h"

namespace covtrace {

namespace cov = covariance;

namespace {

using Vec = cov::Vec3<double>;
using cov::multiply_add;
using cov::sum_of_products;

/// Logarithm of Smith's masking, -log D with D = b s(w) + s_b w.n, about the unit direction w: its
/// derivatives along the axes of w's ray are slope N and square N N^T + level I, where N holds the
/// components of the normal along these axes.
struct LogMasking {
    double slope, square, level;

    /// Computes the derivatives: `c` and `s` belong to the cosine c = w.n, `b` and `sb` to the
    /// other direction; `i` is 1/D.
    LogMasking(double alpha2, double c, double s, double b, double sb, double i) {
        const double rest = 1 - alpha2, bi = b * i / s, k = rest * c / s;
        slope = -multiply_add(b, k, sb) * i;
        square = sum_of_products(slope, slope, bi, multiply_add(k, k, -rest));
        level = -alpha2 * bi;
    }
};

/// The window -(level I + square N N^T)/(4 pi^2) without negative parts, at most the cosine's
/// window: both have the axes along and across N.
cov::Sym2<double> window_of(double level, double square, double nx, double ny, double cosine) {
    constexpr double kScale = -1 / cov::four_pi_sq<double>,
                     kAcross = 1 / (cov::pi<double> * cov::pi<double>);
    const double size = sum_of_products(nx, nx, ny, ny);
    const double c = std::max(cosine, cov::min_window_cosine<double>);
    const double across = std::clamp(kScale * level, 0.0, kAcross);
    const double along =
        std::clamp(kScale * multiply_add(square, size, level), 0.0, kAcross / (c * c));
    const double rest = size > cov::noise_level<double> ? (along - across) / size : 0;
    return {multiply_add(rest * nx, nx, across), rest * nx * ny,
            multiply_add(rest * ny, ny, across)};
}

/// Derivatives of the logarithm of Fresnel's factor of x = cos(wo, h), x^2 = (1 + c)/2: slope W and
/// square W W^T + level I, where W holds the components of wi along the leaving axes.
struct LogFresnel {
    double slope = 0, square = 0, level = 0;
    bool reflects = true;

    LogFresnel(const LobeShare& lobe, double c) {
        if (!lobe.has_border()) return;
        const double x = std::sqrt(0.5 * (1 + c)), x1 = 0.25 / x, x2 = -x1 * x1 / x;
        const auto r = reflectance_at(lobe, x);
        reflects = r.value > 0;
        const double i = 1 / r.value, l1 = r.first * i, l2 = multiply_add(r.second, i, -l1 * l1);
        slope = l1 * x1;
        square = sum_of_products(l1, x2, l2, x1 * x1);
        level = -slope * c;
    }
};

}  // namespace

RoundReflection round_reflection(const LobeShare& lobe, const cov::Frame<double>& in,
                                 const Vec& outgoing, const Vec& n) {
    // Mirror the frame
    const Vec half = cov::half_vector<double>(in.z, outgoing, n);
    Axes4 axes(in);
    const Double4 in_normal = axes.dot(n), in_half = axes.dot(half);
    axes.add(all4(-2.0) * in_half, half);
    RoundReflection result;
    result.outgoing = axes.frame();

    // Find the window: masking of the arriving light, with the cosine and the solid angle
    const double alpha2 = double(lobe.alpha_x) * lobe.alpha_x, narrow = 1 / alpha2;
    const double side =
        std::copysign(1.0, multiply_add(-2 * in_half[2], cov::dot(half, n), in_normal[2]));
    const Double4 normal = axes.dot(n) * all4(side);
    const double co = normal[2], signed_ci = -side * in_normal[2], ci = std::abs(signed_ci);
    const auto stretched = [&](double c) {
        return std::sqrt(multiply_add(1 - alpha2, c * c, alpha2));
    };
    const double so = stretched(co), si = stretched(ci), i = 1 / sum_of_products(ci, so, co, si);
    const LogMasking arriving(alpha2, ci, si, co, so, i);
    // The solid angle is (1 + u^2 + v^2)^(-3/2).
    result.window = window_of(arriving.level - 3, arriving.square - 1 / (ci * ci), in_normal[0],
                              in_normal[1], ci);

    // Find the peak: all tangents are alike, and those of the half vector leave I minus the square
    // of its components along the axes
    const double cos_h = std::max(std::abs(in_half[2]), cov::min_surface_cosine<double>);
    const double scale = narrow / (cov::four_pi_sq<double> * cos_h * cos_h);
    const cov::Sym2<double> peak{scale * multiply_add(-in_half[0], in_half[0], 1),
                                 -scale * in_half[0] * in_half[1],
                                 scale * multiply_add(-in_half[1], in_half[1], 1)};
    result.lobe = peak;
    const Vec wi = -in.z, h = result.outgoing.z + wi;
    const Double4 towards = axes.dot(wi);
    const LogFresnel fresnel(lobe, towards[2]);
    if (!(signed_ci > 0) || !fresnel.reflects) return result;

    // Find the lobe at this pair of directions. The distribution at h = W + |W| wi is twice log
    // |h|^2 / h.(A h), with A = I/alpha^2 along the surface and 1 along the normal: A h is
    // `across`, the part of h along the surface, over alpha^2 and `up`, its part along the normal
    const double up = co + ci, ih = 1 / cov::dot(h, h);
    const Vec across = cov::add_scaled(h, -side * up, n);
    const double iq = 1 / sum_of_products(narrow, cov::dot(across, across), up, up);
    const Double4 ah = multiply_add(axes.dot(across), narrow, normal * all4(up));
    const double bend = sum_of_products(narrow, cov::dot(wi, across), ci, up);
    const LogMasking leaving(alpha2, co, so, ci, si, i);
    const Double4 slope = multiply_add(towards, multiply_add(4.0, ih, fresnel.slope),
                                       multiply_add(ah, -4 * iq, normal * all4(leaving.slope)));
    const double level =
        1 + leaving.level + fresnel.level + 4 * (ih * (1 + cov::dot(h, wi)) - iq * (narrow + bend));
    const Double4 second =
        multiply_add(square4(towards), multiply_add(-8 * ih, ih, fresnel.square),
                     multiply_add(square4(ah), 8 * iq * iq,
                                  multiply_add(square4(normal),
                                               multiply_add(-4 * iq, 1 - narrow, leaving.square),
                                               Double4{level, 0, level, 0})));
    result.lobe = cov::local_lobe_of_log<double>(
        {0, slope[0], slope[1], second[0], second[1], second[2]}, peak);
    return result;
}

}  // namespace covtrace
