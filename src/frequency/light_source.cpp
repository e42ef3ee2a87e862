#include "frequency/light_source.h"

#include <cmath>
#include <optional>

namespace covtrace {

namespace cov = covariance;

namespace {

/// Whether the emitter is a ball, which shows every side about the same disc.
bool is_ball(const SourceSpectrum& s) {
    return s.kind == SourceSpectrum::Kind::area && s.k11 > 0 && s.k22 > 0;
}

/// The light of a ball: that of a disc through its centre that faces the receiver. The disc that
/// the receiver sees changes with its distance from the centre, not from the point of the surface.
LightField ball_field(const SourceSpectrum& s, Vec3 travel, double cap) {
    const double moment = 0.5 * (double(s.s11) + s.s22);
    const LightField disc = cov::area_source<double>(cov::Sym2<double>::diagonal(moment, moment),
                                                     cov::frame_along<double>(travel), cap);
    const cov::Motion<double> motion{s.velocity, s.angular_velocity};
    const double depth = std::max(0.0f, dot(s.tangent.z, travel)) / (0.5 * (double(s.k11) + s.k22));
    return cov::motion_exit(cov::travel(disc, depth), motion);
}

/// The light of a flat emitter at rest. Together area_source and surface_exit turn its moments S
/// into (4 pi^2 P S P^T)^-1, the spectrum of the moments as the receiver sees them. Empty where one
/// of the two has to limit anything.
std::optional<LightField> flat_field(const SourceSpectrum& s, Vec3 travel, double cap) {
    const bool is_flat = s.k11 == 0 && s.k12 == 0 && s.k22 == 0;
    if (!is_flat || s.velocity != Vec3{} || s.angular_velocity != Vec3{}) return std::nullopt;
    const cov::Sym2<double> moments{s.s11, s.s12, s.s22};
    const cov::Frame<double> frame = cov::frame_along<double>(travel);
    const auto p = cov::projection<double>(frame, s.tangent.x, s.tangent.y);
    // Cosines near the limit of surface_exit are left to it: area_source and surface_exit need not
    // agree on which side of the limit they are.
    const bool is_grazing = std::abs(cov::det(p)) < 1.01 * cov::min_surface_cosine<double>;
    if (is_grazing || !cov::is_spectrum_below(moments, cap)) return std::nullopt;
    LightField field{{}, frame};
    field.sigma.set_spatial(
        cov::inverse(cov::four_pi_sq<double> * cov::congruence(moments, cov::transpose(p))));
    return field;
}

LightField area_field(const SourceSpectrum& s, Vec3 travel, bool seen_sharply, double smallest,
                      const cov::Sym2<double>& texture) {
    if (!seen_sharply)
        if (const auto field = flat_field(s, travel, cov::edge_variance(smallest))) return *field;
    const cov::Surface<double> surface{
        s.tangent.z, s.tangent.x, s.tangent.y, {s.k11, s.k12, s.k22}};
    const double cap = cov::edge_variance(smallest);
    if (is_ball(s) && !seen_sharply) return ball_field(s, travel, cap);
    LightField field =
        cov::area_source<double>({s.s11, s.s12, s.s22}, cov::frame_along<double>(travel), cap);
    if (seen_sharply) field = cov::add_texture(field, texture);
    if (seen_sharply && std::isfinite(s.border_distance)) {
        const double q = cov::edge_variance(std::max<double>(s.border_distance, smallest));
        const double dx = s.border_direction.x, dy = s.border_direction.y;
        field = cov::add_texture(field, {q * dx * dx, q * dx * dy, q * dy * dy});
    }
    const cov::Motion<double> motion{s.velocity, s.angular_velocity};
    const auto left = cov::surface_exit(field, surface);
    return motion.at_rest() ? left : cov::motion_exit(left, motion);
}

/// Light that a spot's cone has narrowed.
LightField within_cone(const LightField& field, const SourceSpectrum& s) {
    if (!(s.cone_variance > 0)) return field;
    return cov::add_angular_window(field, cov::spot_window(std::sqrt(double(s.cone_variance))));
}

}  // namespace

LightField source_field(const SourceSpectrum& source, Vec3 travel, bool seen_sharply,
                        double smallest, const cov::Sym2<double>& texture) {
    switch (source.kind) {
        case SourceSpectrum::Kind::area:
            return within_cone(area_field(source, travel, seen_sharply, smallest, texture), source);
        case SourceSpectrum::Kind::point: {
            const bool has_image = source.a11 + source.a22 > 0;
            const cov::Frame<double> frame =
                has_image ? cov::Frame<double>{source.tangent.x, source.tangent.y, travel}
                          : cov::frame_along<double>(travel);
            const LightField field = cov::point_source(frame, smallest);
            if (has_image)
                return cov::add_angular_window(field, {source.a11, source.a12, source.a22});
            return within_cone(field, source);
        }
        case SourceSpectrum::Kind::directional:
        case SourceSpectrum::Kind::environment:
            break;
    }
    // Directions of the map are those towards the light, against its travel: both slopes change
    // their signs, which a covariance does not see.
    const cov::Frame<double> frame{source.tangent.x, source.tangent.y, travel};
    cov::Sym2<double> angular{source.a11, source.a12, source.a22};
    if (std::isfinite(source.border_distance)) {
        constexpr double kNearest = 1e-4;  // radians, as far as single precision tells rims apart
        const double q = cov::edge_variance(std::max<double>(source.border_distance, kNearest));
        const double dx = source.border_direction.x, dy = source.border_direction.y;
        angular = angular + cov::Sym2<double>{q * dx * dx, q * dx * dy, q * dy * dy};
    }
    return cov::distant_source(frame, angular);
}

LightField unlit_field(const cov::Surface<double>& surface, const cov::Motion<double>& motion,
                       const cov::Sym2<double>& texture, Vec3 travel) {
    const LightField even{{}, cov::frame_along<double>(travel)};
    const LightField left = cov::surface_exit(cov::add_texture(even, texture), surface);
    return motion.at_rest() ? left : cov::motion_exit(left, motion);
}

cov::Emitter<double> emitter_of(const SourceSpectrum& source, double distance) {
    switch (source.kind) {
        case SourceSpectrum::Kind::area:
            return {is_ball(source) ? Vec3{} : source.tangent.z, distance};
        case SourceSpectrum::Kind::point:
            return {{}, distance};
        case SourceSpectrum::Kind::directional:
        case SourceSpectrum::Kind::environment:
            break;
    }
    return {};
}

}  // namespace covtrace
