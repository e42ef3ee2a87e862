#include "frequency/strand_lobe.h"

#include <algorithm>
#include <cmath>

namespace covtrace {

namespace cov = covariance;

namespace {

constexpr double kLeastCosine = 0.02;

/// Axes across a direction: along growing angles to the cross section, and about the strand.
struct StrandAxes {
    cov::Vec3<double> along, about;
    double cosine;  ///< of the direction's angle to the cross section

    StrandAxes(const cov::Vec3<double>& axis, const cov::Vec3<double>& direction) {
        const cov::Vec3<double> turning = cov::cross(axis, direction);
        cosine = std::max(cov::length(turning), kLeastCosine);
        about = cov::normalized_or(turning, cov::frame_along<double>(direction).x);
        along = cov::cross(direction, about);
    }
};

/// Covariance of a Gaussian of the given standard deviation; infinite: of what is even.
double spectrum_of(double deviation) {
    return std::isfinite(deviation) ? 1 / (cov::four_pi_sq<double> * deviation * deviation) : 0;
}

}  // namespace

cov::GlossyPair<double> strand_pair(const LobeShare& lobe, const cov::Vec3<double>& axis,
                                    const cov::Frame<double>& in,
                                    const cov::Vec3<double>& outgoing) {
    const StrandAxes arriving(axis, -in.z), leaving(axis, outgoing);
    // A ray that travels with the slopes (u, v) along (arriving.along, arriving.about) comes from
    // the angles theta_i - u and phi_i - v / cosine. With theta mirrored and phi kept it leaves
    // with slopes u along leaving.along, and -v cos(theta_o) / cos(theta_i) along leaving.about.
    const cov::Mat2<double> turned = cov::projection<double>(in, arriving.along, arriving.about);
    const double ratio = arriving.cosine / leaving.cosine;
    cov::GlossyPair<double> pair;
    pair.outgoing = {leaving.along, -leaving.about, outgoing};
    pair.map = turned * cov::Mat2<double>{1, 0, 0, ratio};
    pair.lobe = {spectrum_of(lobe.alpha_x), 0, spectrum_of(lobe.alpha_y * leaving.cosine)};
    return pair;
}

}  // namespace covtrace
