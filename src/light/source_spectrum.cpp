/// The spectrum of light as it leaves its source, with which every covariance begins.
#include <cassert>
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

SourceSpectrum point_spectrum(const PointEmitter& point, Vec3 wi) {
    SourceSpectrum s;
    s.kind = SourceSpectrum::Kind::point;
    s.tangent = Frame::from_z(-wi);
    s.cone_variance = point.cone_variance;
    if (point.image) {
        const SpatialCovariance2 a = point.image->spectrum(s.tangent);
        s.a11 = a.ss;
        s.a12 = a.st;
        s.a22 = a.tt;
    }
    return s;
}

}  // namespace

SourceSpectrum Lights::Impl::environment_spectrum(Vec3 w) const {
    SourceSpectrum s;
    s.kind = SourceSpectrum::Kind::environment;
    if (environments.size() == 1) {
        const AngularCovariance a = environments[0].spectrum(w);
        s.tangent = a.tangent;
        s.a11 = a.a11;
        s.a12 = a.a12;
        s.a22 = a.a22;
        return s;
    }
    s.tangent = Frame::from_z(-w);
    float total = 0;
    for (const Environment& e : environments) {
        const float weight = luminance(e.radiance(w));
        if (!(weight > 0)) continue;
        const AngularCovariance a = e.spectrum(w);
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

void Lights::prepare_spectra() {
    for (AreaLight& area : impl_->area_lights)
        if (!area.spectrum)
            area.spectrum.emplace(impl_->geometry->shapes()[area.shape], area.emitter);
    for (PointEmitter& p : impl_->points)
        if (p.image) p.image->prepare_spectrum();
    for (Environment& e : impl_->environments) e.prepare_spectrum();
}

SourceSpectrum Lights::source_spectrum(const LightSample& s, float time) const {
    if (s.light < impl_->first_point()) {
        const AreaLight& area = impl_->area_lights[impl_->owner[static_cast<size_t>(s.light)]];
        assert(area.spectrum && "prepare_spectra() comes first");
        return area.spectrum->at(s.position, s.normal, time, false);
    }
    if (s.light < impl_->first_distant())
        return point_spectrum(impl_->points[static_cast<size_t>(s.light - impl_->first_point())],
                              s.wi);
    if (s.light < impl_->first_environment()) return directional_spectrum(s.wi);
    return impl_->environment_spectrum(s.wi);
}

SourceSpectrum Lights::source_spectrum(const SurfaceHit& emitter, bool with_border) const {
    const AreaLight* area = impl_->area_light_of(emitter);
    if (!area) return {};
    assert(area->spectrum && "prepare_spectra() comes first");
    return area->spectrum->at(emitter.position, emitter.ng, emitter.time, with_border);
}

bool Lights::has_even_sky() const {
    return impl_->environments.size() == 1 && !impl_->environments[0].varies();
}

SourceSpectrum Lights::environment_spectrum(Vec3 w) const {
    return impl_->environment_spectrum(w);
}

}  // namespace covtrace
