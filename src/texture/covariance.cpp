/// How fast textures vary: the covariance of their amplitude spectra per unit of (u, v).
#include <cmath>

#include "core/noise.h"
#include "texture/graph.h"
#include "texture/mapping.h"
#include "texture/spectra.h"

namespace covtrace {
namespace {

/// Share of an edge's distance e that a filter may reach: with an edge at the distance e a point
/// sees frequencies up to 1 / (2 pi beta e).
constexpr float kEdgeBeta = 0.5f;
/// Contrast, standard deviation over mean, from which on a variation counts in full. A lower one
/// counts in proportion: smoothing it away changes less than the noise that the smoothing removes.
constexpr float kFullContrast = 0.1f;
/// Least distance to an edge, as a part of a checkerboard's cell or of an image.
constexpr float kMinEdgeDistance = 1e-5f;

SpatialCovariance2 operator+(SpatialCovariance2 a, SpatialCovariance2 b) {
    return {a.ss + b.ss, a.st + b.st, a.tt + b.tt};
}
SpatialCovariance2 operator*(SpatialCovariance2 a, float w) {
    return {a.ss * w, a.st * w, a.tt * w};
}

/// Replaces a covariance that is not finite by none: parameters of textures may be near the largest
/// numbers there are.
SpatialCovariance2 finite(SpatialCovariance2 c) {
    return std::isfinite(c.ss + c.st + c.tt) ? c : SpatialCovariance2{};
}

/// The covariance `c` over (s, t), expressed over (u, v): J^T c J with J = d(s, t)/d(u, v).
SpatialCovariance2 to_uv(SpatialCovariance2 c, const StGradient& g) {
    const auto form = [&](Vec2 a, Vec2 b) {
        return a.x * (c.ss * b.x + c.st * b.y) + a.y * (c.st * b.x + c.tt * b.y);
    };
    const Vec2 du{g.s.x, g.t.x}, dv{g.s.y, g.t.y};
    return {form(du, du), form(du, dv), form(dv, dv)};
}

/// The covariance over (u, v) that comes from an edge across a texture coordinate: `distance` away
/// in units of the coordinate, whose gradient by (u, v) is given.
SpatialCovariance2 edge(float distance, Vec2 gradient, float footprint_uv) {
    const float e = std::max({distance, footprint_uv * length(gradient), kMinEdgeDistance});
    const float variance = 1 / sqr(2 * kPi * kEdgeBeta * e);
    return {variance * gradient.x * gradient.x, variance * gradient.x * gradient.y,
            variance * gradient.y * gradient.y};
}

/// Whether a mirrored image shows its columns (or rows) in reverse order at the coordinate `v`.
bool runs_back(float v) {
    return std::floor(v) != 2 * std::floor(0.5f * v);
}

float distance_to_integer(float v) {
    return std::abs(v - std::round(v));
}

/// Contrast of two colours in equal shares, such as a checkerboard's: their standard deviation over
/// their mean, in units of kFullContrast.
float relative_contrast(Rgb a, Rgb b) {
    const Rgb difference(std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b));
    const float d = luminance(difference);
    const auto size = [](Rgb c) {
        return luminance({std::abs(c.r), std::abs(c.g), std::abs(c.b)});
    };
    return d > 0 ? d / (kFullContrast * (size(a) + size(b))) : 0;
}
float contrast_weight(Rgb a, Rgb b) {
    return std::min(1.0f, relative_contrast(a, b));
}

/// The weight of a contrast between neighbouring unit cells once a pixel has smoothed it: a
/// Gaussian with a deviation of half a pixel leaves this much of the cells' fundamental wave, which
/// is two cells long. `gradient` takes uv to cells.
float kept_weight(float contrast, Vec2 gradient, float footprint_uv) {
    const float exponent = 0.5f * sqr(kPi * footprint_uv) * dot(gradient, gradient);
    // Since exp(-x) >= 1 - x, most contrasts are seen to count in full without the exponential.
    if (contrast * (1 - exponent) >= 1) return 1;
    return std::min(1.0f, contrast * std::exp(-exponent));
}

/// The covariance of a node. `spectrum`: of the image that the node shows or mixes by, null where
/// it does neither.
struct Analyser {
    const TextureGraph& graph;
    const TextureSpectra& spectra;
    const TexturePoint& at;
    Vec3 dpdu, dpdv;
    float footprint_uv;

    SpatialCovariance2 of(TextureId id) const {
        const ImageSpectrum* spectrum = spectra.of_image(id);
        return std::visit([&](const auto& node) { return (*this)(node, spectrum); },
                          graph.nodes[size_t(id)]);
    }

    SpatialCovariance2 operator()(const ConstantNode&, const ImageSpectrum*) const { return {}; }

    SpatialCovariance2 operator()(const ImageNode& node, const ImageSpectrum* spectrum) const {
        return of_image(node, *spectrum);
    }

    SpatialCovariance2 of_image(const ImageNode& node, const ImageSpectrum& spectrum) const {
        const TextureImage& image = graph.images[size_t(node.image)];
        const StGradient gradient = st_gradient(node.mapping, at, dpdu, dpdv);
        Vec2 st = flip_t(map_to_st(node.mapping, at));
        float turns = -1;  // the image's rows run against t
        const auto unmirror = [&turns](float& v, TextureImage::Wrap wrap) {
            if (wrap != TextureImage::Wrap::mirror) return;
            if (runs_back(v)) turns = -turns;
            v = mirrored(v);
        };
        unmirror(st.x, image.wrap().s);
        unmirror(st.y, image.wrap().t);
        const float pixel_uv = 2 * footprint_uv;
        SpatialCovariance2 c =
            spectrum.at(st.x, st.y, {pixel_uv * length(gradient.s), pixel_uv * length(gradient.t)});
        c.st *= turns;
        SpatialCovariance2 result = to_uv(c, gradient);
        // An image before black ends in hard edges, which its own analysis, on clamped values,
        // doesn't see.
        const auto rim = [&](float v, Vec2 gradient_of_v) {
            return edge(std::min(std::abs(v), std::abs(1 - v)), gradient_of_v, footprint_uv);
        };
        if (image.wrap().s == TextureImage::Wrap::black) result = result + rim(st.x, gradient.s);
        if (image.wrap().t == TextureImage::Wrap::black) result = result + rim(st.y, gradient.t);
        return result;
    }

    SpatialCovariance2 operator()(const CheckerboardNode& node, const ImageSpectrum*) const {
        const Rgb a = eval(graph, node.tex1, at), b = eval(graph, node.tex2, at);
        const float contrast = relative_contrast(a, b);
        const auto edge_at = [&](float coordinate, Vec2 gradient) {
            return edge(distance_to_integer(coordinate), gradient, footprint_uv) *
                   kept_weight(contrast, gradient, footprint_uv);
        };
        SpatialCovariance2 edges;
        if (node.dimension == 2) {
            const Vec2 st = map_to_st(node.mapping, at);
            const StGradient gradient = st_gradient(node.mapping, at, dpdu, dpdv);
            edges = edge_at(st.x, gradient.s) + edge_at(st.y, gradient.t);
        } else {
            const Vec3 p = node.texture_from_world.point(at.position);
            const Vec3 pu = node.texture_from_world.vector(dpdu);
            const Vec3 pv = node.texture_from_world.vector(dpdv);
            for (int axis = 0; axis < 3; ++axis)
                edges = edges + edge_at(p[axis], {pu[axis], pv[axis]});
        }
        return edges + of(active_texture(node, at));
    }

    /// A texture that depends on the normal alone varies as slowly as the surface bends: no
    /// covariance.
    SpatialCovariance2 operator()(const AsideTexture&, const ImageSpectrum*) const { return {}; }

    /// The angle of sight varies as slowly as the normal, too: what is left is the textures'.
    SpatialCovariance2 operator()(const FacingNode& node, const ImageSpectrum*) const {
        const FacingNeighbours n =
            facing_neighbours(node.between, at.facing == kSeenFromNowhere ? 0.0f : at.facing);
        if (!(n.share > 0)) return of(n.first);
        return of_sum(of(n.first), (1 - n.share) * eval(graph, n.first, at), of(n.second),
                      n.share * eval(graph, n.second, at));
    }

    /// Dots: the nearest rim counts as a straight edge.
    SpatialCovariance2 operator()(const DotsTexture& node, const ImageSpectrum*) const {
        const Vec2 st = map_to_st(node.mapping, at);
        const StGradient gradient = st_gradient(node.mapping, at, dpdu, dpdv);
        float nearest = kInfinity;
        Vec2 across;  // the rim, by (u, v)
        for (int j = -1; j <= 1; ++j)
            for (int i = -1; i <= 1; ++i) {
                const auto center = dot_center({st.x + float(i), st.y + float(j)});
                if (!center) continue;
                const Vec2 d{st.x - center->x, st.y - center->y};
                const float r = length(d), rim = std::abs(r - kDotRadius);
                if (!(rim < nearest) || !(r > 0)) continue;
                nearest = rim;
                across = {(d.x * gradient.s.x + d.y * gradient.t.x) / r,
                          (d.x * gradient.s.y + d.y * gradient.t.y) / r};
            }
        const SpatialCovariance2 own = of(active_texture(node, at));
        if (nearest == kInfinity) return own;
        const float contrast =
            relative_contrast(eval(graph, node.inside, at), eval(graph, node.outside, at));
        return own +
               edge(nearest, across, footprint_uv) * kept_weight(contrast, across, footprint_uv);
    }

    /// Bilinear ramps vary as fast as they rise, relative to their value.
    SpatialCovariance2 operator()(const BilerpTexture& node, const ImageSpectrum*) const {
        const Vec2 st = map_to_st(node.mapping, at);
        const float value = std::abs(luminance(bilerp(node, st)));
        // A thousandth of the corners keeps the quotient finite where a ramp goes through black.
        const float least = 1e-3f * (std::abs(luminance(node.v00)) + std::abs(luminance(node.v01)) +
                                     std::abs(luminance(node.v10)) + std::abs(luminance(node.v11)));
        if (!(value + least > 0)) return {};
        const float scale = 1 / (2 * kPi * (value + least));
        const float s =
            scale * luminance((1 - st.y) * (node.v10 - node.v00) + st.y * (node.v11 - node.v01));
        const float t =
            scale * luminance((1 - st.x) * (node.v01 - node.v00) + st.x * (node.v11 - node.v10));
        return to_uv({s * s, s * t, t * t}, st_gradient(node.mapping, at, dpdu, dpdv));
    }

    /// Noise is alike everywhere and in all directions: along each axis of texture space it has the
    /// mean square frequency, weighted by energy, of the octaves that a pixel shows.
    SpatialCovariance2 operator()(const NoiseTexture& node, const ImageSpectrum*) const {
        using Kind = NoiseTexture::Kind;
        const Vec3 pu = node.texture_from_world.vector(dpdu),
                   pv = node.texture_from_world.vector(dpdv);
        const float stretch = node.kind == Kind::marble ? std::abs(node.scale) : 1.0f;
        const float pixel = 2 * footprint_uv * std::max(length(pu), length(pv)) * stretch;
        const Octaves octaves =
            node.kind == Kind::windy ? Octaves{6, 0.5f} : Octaves{node.octaves, node.omega};
        const NoiseEnergy energy = noise_energy(pixel, octaves);
        const SpatialCovariance2 all = {dot(pu, pu), dot(pu, pv), dot(pv, pv)};
        if (node.kind == Kind::marble) {
            // Marble's colours follow a phase that runs along y and is bent by the noise. The
            // harmonic is the root mean square slope of marble's luminance, but for its jumps, over
            // its deviation.
            constexpr float kHarmonic = 8.4f;
            const float square = sqr(kHarmonic * node.scale / (2 * kPi));
            const SpatialCovariance2 along{pu.y * pu.y, pu.y * pv.y, pv.y * pv.y};
            return finite(along * square +
                          all * (square * sqr(2 * kPi * node.variation) * energy.slope));
        }
        if (!(energy.all > 0)) return {};
        // The absolute value of noise has as much slope as noise, but 1 - 2 / pi of its variance.
        const float folded = node.kind == Kind::wrinkled ? 1 / (1 - 2 * kInvPi) : 1.0f;
        return finite(all * (folded * energy.slope / energy.all));
    }

    /// Colours of vertices vary over a triangle as fast as they rise, relative to their value, and
    /// jump where the neighbour's colours differ along a side.
    SpatialCovariance2 operator()(const VertexColourTexture& node, const ImageSpectrum*) const {
        const VertexPlace& place = at.vertices;
        if (!place.mesh || place.mesh->colours.empty()) return {};
        const std::array<VertexColour, 3> colours = place.corners(place.mesh->colours);
        const std::array<float, 3> weights = place.weights();
        std::array<float, 3> values;
        float value = 0, sum = 0;
        for (size_t i = 0; i < 3; ++i) {
            values[i] = node.is_alpha ? colours[i].alpha : luminance(colours[i].value);
            value += weights[i] * values[i];
            sum += values[i];
        }
        const auto [by1, by2] = place.barycentric_by_uv();
        SpatialCovariance2 result;
        // A thousandth of the corners keeps the quotient finite where the colour goes through
        // black.
        if (const float least = 1e-3f * sum; value + least > 0) {
            const Vec2 slope = (by1 * (values[1] - values[0]) + by2 * (values[2] - values[0])) *
                               (1 / (2 * kPi * (value + least)));
            result = {slope.x * slope.x, slope.x * slope.y, slope.y * slope.y};
        }
        if (place.mesh->colour_steps.empty()) return finite(result);
        // A barycentric coordinate is the distance to the side opposite its corner.
        const std::array<Vec2, 3> gradients{(by1 + by2) * -1.0f, by1, by2};
        const auto& steps = place.mesh->colour_steps[place.triangle];
        for (size_t i = 0; i < 3; ++i) {
            if (steps[i] == 0) continue;
            const float contrast =
                float(steps[i]) / (TriangleMesh::kLargestColourStep * kFullContrast);
            result = result + edge(weights[i], gradients[i], footprint_uv) *
                                  kept_weight(contrast, gradients[i], footprint_uv);
        }
        return finite(result);
    }

    /// A cutoff is met in jumps; what it is applied to varies no slower.
    SpatialCovariance2 operator()(const CutoffTexture& node, const ImageSpectrum*) const {
        return of(node.tex);
    }

    /// Scaling is a product of signals: their spectra are convolved, so their covariances add.
    SpatialCovariance2 operator()(const ScaleNode& node, const ImageSpectrum*) const {
        return of(node.tex) + of(node.scale);
    }

    /// Mixing is a sum of two signals, each weighted by what it contributes here. The amount
    /// multiplies their difference, so it counts as much as an edge between the two would.
    SpatialCovariance2 operator()(const MixNode& node, const ImageSpectrum* mixture) const {
        const SpatialCovariance2 first = of(node.tex1), second = of(node.tex2);
        const bool varies = first.ss + first.tt + second.ss + second.tt > 0;
        const auto of_mixture = [&] {
            return of_image(std::get<ImageNode>(graph.nodes[size_t(node.amount)]), *mixture);
        };
        if (mixture && !varies) return of_mixture();
        const Rgb a = eval(graph, node.tex1, at), b = eval(graph, node.tex2, at);
        SpatialCovariance2 result =
            mixture ? of_mixture() : of(node.amount) * contrast_weight(a, b);
        if (!varies) return result;
        const Rgb amount = eval(graph, node.amount, at);
        return result + of_sum(first, (Rgb(1) - amount) * a, second, amount * b);
    }

    /// A sum of two signals: each counts by the value that it contributes.
    static SpatialCovariance2 of_sum(const SpatialCovariance2& first, Rgb a,
                                     const SpatialCovariance2& second, Rgb b) {
        const float wa = std::abs(luminance(a)), wb = std::abs(luminance(b));
        if (!(wa + wb > 0)) return {};
        return first * (wa / (wa + wb)) + second * (wb / (wa + wb));
    }
};

/// The covariance per (u, v) of one edge along u and one along v through every point.
SpatialCovariance2 highest_covariance(float footprint_uv) {
    return edge(0, {1, 0}, footprint_uv) + edge(0, {0, 1}, footprint_uv);
}

}  // namespace

SpatialCovariance2 TextureSpectra::uv_covariance(TextureId id, const TexturePoint& at, Vec3 dpdu,
                                                 Vec3 dpdv, float footprint_uv) const {
    if (bandwidth_ == TextureBandwidth::highest) return highest_covariance(footprint_uv);
    return Analyser{*graph_, *this, at, dpdu, dpdv, footprint_uv}.of(id);
}

}  // namespace covtrace
