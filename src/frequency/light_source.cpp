#include "frequency/light_source.h"

#include <cmath>

namespace covtrace {

namespace cov = covariance;

namespace {

LightField area_field(const SourceSpectrum& s, Vec3 travel, bool seen_sharply, double smallest,
                      const cov::Sym2<double>& texture) {
    const cov::Surface<double> surface{
        s.tangent.z, s.tangent.x, s.tangent.y, {s.k11, s.k12, s.k22}};
    const double cap = cov::edge_variance(smallest);
    LightField field =
        cov::area_source<double>({s.s11, s.s12, s.s22}, cov::frame_along<double>(travel), cap);
    if (seen_sharply) field = cov::add_texture(field, texture);
    if (seen_sharply && std::isfinite(s.border_distance)) {
        const double q = cov::edge_variance(std::max<double>(s.border_distance, smallest));
        const double dx = s.border_direction.x, dy = s.border_direction.y;
        field = cov::add_texture(field, {q * dx * dx, q * dx * dy, q * dy * dy});
    }
    const cov::Motion<double> motion{s.velocity, s.angular_velocity};
    return cov::motion_exit(cov::surface_exit(field, surface), motion);
}

}  // namespace

LightField source_field(const SourceSpectrum& source, Vec3 travel, bool seen_sharply,
                        double smallest, const cov::Sym2<double>& texture) {
    switch (source.kind) {
        case SourceSpectrum::Kind::area:
            return area_field(source, travel, seen_sharply, smallest, texture);
        case SourceSpectrum::Kind::point: {
            const LightField field = cov::point_source(cov::frame_along<double>(travel), smallest);
            if (!(source.cone_variance > 0)) return field;
            return cov::add_angular_window(
                field, cov::spot_window(std::sqrt(double(source.cone_variance))));
        }
        case SourceSpectrum::Kind::directional:
        case SourceSpectrum::Kind::environment:
            break;
    }
    // The directions of the map are those towards the light, against its travel: both slopes change
    // their signs, which a covariance does not see.
    const cov::Frame<double> frame{source.tangent.x, source.tangent.y, travel};
    return cov::distant_source(frame, {source.a11, source.a12, source.a22});
}

}  // namespace covtrace
