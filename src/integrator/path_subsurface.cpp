/// A path's walk through a body that scatters light inside, from where it enters to where it
/// leaves: a random walk through the body's medium, as in Chiang, Kutz and Burley 2016, "Practical
/// and controllable subsurface scattering for production path tracing". Lights are sampled where it
/// leaves, not on the way, where the border is between. The walk counts as one scattering event.
#include <algorithm>
#include <cmath>
#include <limits>

#include "bsdf/fresnel.h"
#include "bsdf/phase_function.h"
#include "integrator/path_tracer.h"

namespace covtrace {

namespace {

/// The medium below a hit, where it is too dense for positions in single precision thinned to what
/// they resolve: a walk in steps below the distance by which its origin is moved off the surface
/// would never find back. What leaves is the same, since only the scale changes.
Medium medium_below(const SubsurfaceBsdf& bsdf, const SurfaceHit& hit) {
    // Shortest mean free path over the uncertainty of the position: the reflectances 0.9, 0.5 and
    // 0.2 of a ball lose less than 1 %, with a third of it up to 3 %; three times it blurs bodies
    // far from the scene's origin more.
    constexpr float kResolved = 30;
    const Vec3 p = hit.position;
    const float size = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    const float shortest =
        kResolved * (hit.position_error + std::numeric_limits<float>::epsilon() * size);
    Medium medium{bsdf.absorption, bsdf.scattering, {}, bsdf.g};
    for (int c = 0; c < 3; ++c) {
        const float paths = shortest * (bsdf.absorption[c] + bsdf.scattering[c]);
        if (!(paths > 1)) continue;
        medium.absorption[c] /= paths;
        medium.scattering[c] /= paths;
    }
    return medium;
}

}  // namespace

bool PathTracer::goes_back_in(const Surface& surface, const BsdfSample& s) const {
    if (!body_) return false;
    const Vec3 out = face_forward(surface.hit.ng, -surface.frame.to_world(surface.wo));
    return dot(out, surface.frame.to_world(s.wi)) < 0;
}

bool PathTracer::enter_body(const Surface& surface, const BsdfSample& s, PathVertex* vertex) {
    const auto& bsdf = std::get<SubsurfaceBsdf>(surface.bsdf);
    const SurfaceHit& hit = surface.hit;
    Vec3 wi = normalize(surface.frame.to_world(s.wi));
    if (!bsdf.is_left) {
        // Below a turned normal may be above the surface: let light enter in any case
        const Vec3 out = face_forward(hit.ng, surface.frame.to_world(surface.wo));
        const float cosine = dot(out, wi);
        if (cosine > 0) wi = normalize(wi - out * (2 * cosine));
    }
    beta_ *= s.weight;
    colourless_beta_ *= s.weight;
    specular_ = sharp_so_far_ = seen_clearly_ = false;
    if (vertex) {
        vertex->scatters = true;
        vertex->next_event.wi = wi;
        vertex->next_event.lobes.count = 1;
        vertex->next_event.lobes.lobes[0] = {LobeKind::diffuse_transmission, s.weight};
    }
    if (!body_) {
        const MaterialId of_shape = surface.shape.description.material;
        body_ = Body{{}, scene_.materials.at(of_shape, hit, scene_.textures).id, of_shape};
    }
    body_->medium = medium_below(bsdf, hit);
    body_->eta = bsdf.refracts ? bsdf.border.eta : 1;
    body_->entered = max_component(beta_);
    body_->steps = 0;
    ray_.origin = Geometry::offset_origin(hit, wi);
    ray_.direction = wi;
    ray_.t_max = kInfinity;
    ray_.kind = RayKind::any;
    return true;
}

bool PathTracer::cross_body(bool found) {
    // Throughput over that of the way in below which a walk may end at random, as for all paths
    // (docs/decisions/0075). Beyond the long walk, which one of a hundred exceeds in a half space
    // that absorbs nothing (1 / sqrt(pi n) of symmetric walks are longer than n steps: Sparre
    // Andersen 1954, "On the fluctuations of sums of random variables II"), it goes on for a
    // thousand steps in the mean.
    constexpr float kFaint = 0.25f, kLeastEnd = 0.001f;
    constexpr int kLongWalk = 4096;
    sampler_.set_dimension(pairs_to_come() + kPairsPerBounce);
    const auto [u_distance, u_direction, u_border, u_roulette] = sampler_.next_four_2d();
    // Sample the distance at which the medium scatters
    const MediumEvent event =
        sample_event(body_->medium, {}, found ? hit_.t : kInfinity, beta_, u_distance);
    beta_ *= event.weight;
    colourless_beta_ *= event.weight;
    if (is_black(beta_) || (!event.scatters && !found)) return false;
    if (!event.scatters) {
        const PlacedShape& shape = scene_.geometry.shapes()[hit_.shape];
        const Vec3 outside = face_forward(hit_.ng, ray_.direction);
        const float cosine = dot(outside, ray_.direction);
        if (is_border(hit_, shape)) {
            if (u_border.x >= fresnel_dielectric(cosine, 1 / body_->eta).reflectance)
                return leave_body(hit_, shape);
            ray_.direction = normalize(ray_.direction - outside * (2 * cosine));
        }
        ray_.origin = Geometry::offset_origin(hit_, ray_.direction);
    } else {
        ray_.origin += ray_.direction * event.distance;
        ray_.direction = sample_phase(body_->medium.g, -ray_.direction, u_direction);
    }
    ++steps_in_bodies_;
    // End long walks at random
    const float carried = max_component(beta_) / (kFaint * body_->entered);
    const float end = std::max(++body_->steps > kLongWalk ? kLeastEnd : 0.0f, 1 - carried);
    if (u_roulette.x < end) return false;
    if (end > 0) {
        beta_ *= 1 / (1 - end);
        colourless_beta_ *= 1 / (1 - end);
    }
    return true;
}

bool PathTracer::is_border(const SurfaceHit& hit, const PlacedShape& shape) {
    if (shape.description.material == body_->surface) return true;
    // Parts of one mesh may have other materials than the body; things inside of it are entered
    // before they are left
    if (dot(hit.ng, ray_.direction) < 0) {
        ++body_->things;
        return false;
    }
    return body_->things == 0 || (--body_->things, false);
}

bool PathTracer::leave_body(const SurfaceHit& hit, const PlacedShape& shape) {
    const Vec3 from = ray_.direction;
    const MaterialId material = body_->material;
    Bsdf bsdf = bsdf_at(hit, material);
    std::get<SubsurfaceBsdf>(bsdf).is_left = true;
    // Let the path seem to come straight from where it entered, wherever it has been
    const Vec3 back = lit_.position - hit.position;
    const float way = length(back);
    PathVertex* vertex = begin_vertex(hit, -1, way > 0 ? back / way : -from);
    const Frame frame = frame_at(hit, shape, material);
    const bool is_outside = dot(frame.z, face_forward(hit.ng, from)) > 0;
    if (vertex) {
        vertex->material = material;
        vertex->shading = frame;
    }
    sampler_.set_dimension(pairs_to_come());
    ++steps_in_bodies_;
    ray_begin_ = hit.position;
    return light_and_scatter({hit, shape, bsdf, frame, {0, 0, is_outside ? -1.0f : 1.0f}},
                             is_outside ? frame.z : -frame.z, vertex);
}

}  // namespace covtrace
