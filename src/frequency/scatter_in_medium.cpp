#include "frequency/scatter_in_medium.h"

#include <cmath>

namespace covtrace {

namespace cov = covariance;

LightField scatter_in_medium(const LightField& arriving, float g, cov::Vec3<double> outgoing) {
    const double k = std::abs(double(g));
    const double lobe = 3 * k / ((1 - k) * (1 - k)) / cov::four_pi_sq<double>;
    LightField field = cov::convolve_angular(arriving, cov::Sym2<double>::diagonal(lobe, lobe));
    // Slopes keep their axes as those turn with the direction; positions are seen from the side.
    const cov::Frame<double> turned = cov::turned_to<double>(field.frame, outgoing);
    const auto side = cov::projection(field.frame, turned.x, turned.y);
    field.sigma = cov::change_positions<double>(field.sigma, side, cov::Mat2<double>{0, 0, 0, 0});
    field.frame = turned;
    return cov::rotate_to(field, cov::frame_along<double>(outgoing));
}

}  // namespace covtrace
