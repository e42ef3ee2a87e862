#include "light/spectra.h"

#include <algorithm>
#include <cmath>

#include "light/lights_impl.h"

namespace covtrace {

namespace {

/// Angular covariance of light from a single direction, (cycles per radian)^2, in place of
/// infinity.
constexpr float kDirectionalCap = 1e8f;

SourceSpectrum directional_spectrum(Vec3 wi) {
    SourceSpectrum s;
    s.kind = SourceSpectrum::Kind::directional;
    s.tangent = Frame::from_z(-wi);
    s.a11 = s.a22 = kDirectionalCap;
    return s;
}

SourceSpectrum point_spectrum(const PointEmitter& point,
                              const std::optional<LightImageSpectrum>& image, Vec3 wi) {
    SourceSpectrum s;
    s.kind = SourceSpectrum::Kind::point;
    s.tangent = Frame::from_z(-wi);
    s.cone_variance = point.cone_variance;
    if (image) {
        const SpatialCovariance2 a = image->at(s.tangent);
        s.a11 = a.ss;
        s.a12 = a.st;
        s.a22 = a.tt;
    }
    return s;
}

}  // namespace

LightSpectra::LightSpectra(const Lights& lights) : lights_(lights.impl_.get()) {
    for (const AreaLight& area : lights_->area_lights)
        emitters_.emplace_back(lights_->geometry->shapes()[area.shape], area.emitter);
    for (const PointEmitter& point : lights_->points) {
        images_.emplace_back();
        if (point.image) images_.back().emplace(*point.image);
    }
    for (const Environment& e : lights_->environments) environments_.emplace_back(e);
}

SourceSpectrum LightSpectra::source_spectrum(const LightSample& s, float time) const {
    if (s.light < lights_->first_point())
        return area_spectrum(lights_->owner[static_cast<size_t>(s.light)], s.position, s.normal,
                             time, false);
    if (s.light < lights_->first_distant()) {
        const auto i = static_cast<size_t>(s.light - lights_->first_point());
        return point_spectrum(lights_->points[i], images_[i], s.wi);
    }
    if (s.light < lights_->first_environment()) return directional_spectrum(s.wi);
    return environment_spectrum(s.wi);
}

SourceSpectrum LightSpectra::source_spectrum(const SurfaceHit& emitter, bool with_border) const {
    const int light = lights_->area_light_of_shape[emitter.shape];
    if (light < 0) return {};
    return area_spectrum(static_cast<size_t>(light), emitter.position, emitter.ng, emitter.time,
                         with_border);
}

SourceSpectrum LightSpectra::area_spectrum(size_t i, Vec3 position, Vec3 normal, float time,
                                           bool with_border) const {
    SourceSpectrum s = emitters_[i].at(position, normal, time, with_border);
    s.cone_variance = lights_->area_lights[i].cone_variance;
    return s;
}

SourceSpectrum LightSpectra::environment_spectrum(Vec3 w, std::optional<RayKind> seen_by) const {
    SourceSpectrum s = sky_spectrum(w);
    if (!seen_by) return s;
    for (size_t i = 0; i < lights_->environments.size(); ++i) {
        const DistantDisc* disc = lights_->environments[i].disc();
        if (!disc || !contains(lights_->environment_visible_to[i], *seen_by)) continue;
        const Vec3 to_centre = disc->centre() - w;
        const float from_centre = 2 * std::asin(std::min(1.0f, length(to_centre) / 2));
        const float distance = std::abs(disc->angular_radius() - from_centre);
        if (!(distance < s.border_distance)) continue;
        s.border_distance = distance;
        const Vec2 d{dot(to_centre, s.tangent.x), dot(to_centre, s.tangent.y)};
        const float l = std::hypot(d.x, d.y);
        s.border_direction = l > 0 ? Vec2{d.x / l, d.y / l} : Vec2{1, 0};
    }
    return s;
}

SourceSpectrum LightSpectra::sky_spectrum(Vec3 w) const {
    SourceSpectrum s;
    s.kind = SourceSpectrum::Kind::environment;
    if (environments_.size() == 1) {
        const AngularCovariance a = environments_[0].at(w);
        s.tangent = a.tangent;
        s.a11 = a.a11;
        s.a12 = a.a12;
        s.a22 = a.a22;
        return s;
    }
    s.tangent = Frame::from_z(-w);
    float total = 0;
    for (size_t i = 0; i < environments_.size(); ++i) {
        const float weight = luminance(lights_->environments[i].sky(w));
        if (!(weight > 0)) continue;
        const AngularCovariance a = environments_[i].at(w);
        if (total == 0) s.tangent = a.tangent;
        // This light's axes are turned into the first light's: both frames share z.
        const float c = dot(s.tangent.x, a.tangent.x), d = dot(s.tangent.x, a.tangent.y);
        s.a11 += weight * (c * c * a.a11 + 2 * c * d * a.a12 + d * d * a.a22);
        s.a12 += weight * (-c * d * a.a11 + (c * c - d * d) * a.a12 + c * d * a.a22);
        s.a22 += weight * (d * d * a.a11 - 2 * c * d * a.a12 + c * c * a.a22);
        total += weight;
    }
    if (total > 0) {
        s.a11 /= total;
        s.a12 /= total;
        s.a22 /= total;
    }
    return s;
}

}  // namespace covtrace
