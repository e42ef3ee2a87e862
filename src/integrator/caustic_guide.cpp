#include "integrator/caustic_guide.h"

#include <algorithm>
#include <cmath>

#include "core/frame.h"
#include "core/hash.h"
#include "core/parallel.h"
#include "core/rng.h"
#include "core/warp.h"
#include "integrator/lit_scene.h"
#include "integrator/path.h"

namespace covtrace {

namespace {

constexpr int64_t kRoundPaths = 4096, kMostRounds = 16;
constexpr size_t kEnoughPhotons = 32768;
constexpr size_t kLeafPhotons = 256;
constexpr size_t kFewestPhotons = 12;  // photons of a cluster that is to be trusted
constexpr int kFits = 3;  // rounds, each without the photons that the one before found to be off
constexpr int kMostTreeDepth = 24;
/// Factor by which lobes are wider than the photons' spread, so that light at their border is not
/// found with a density that is far too small.
constexpr float kWidening = 1.5f;
constexpr float kNarrowest = 1e-3f, kWidest = 0.4f;  // standard deviation, radians
constexpr uint64_t kProbeKey = 0x70726f6265730000ull;
constexpr int kProbes = 16;  // paths that measure how much light a lobe or a leaf brings
constexpr int kProbeDepth = 5;
constexpr float kMostShare = 0.5f, kLeastShare = 0.02f;

/// The von Mises-Fisher density about an axis at the cosine `c`; exact for large kappa, too.
float fisher_pdf(float kappa, float c) {
    return kappa / (2 * kPi * (1 - std::exp(-2 * kappa))) * std::exp(kappa * (c - 1));
}
/// Samples 1 - cos of the angle from the axis, for u in [0, 1) (Jakob 2012, "Numerically stable
/// sampling of the von Mises-Fisher distribution on S2").
float fisher_one_minus_cos(float kappa, float u) {
    return std::clamp(-std::log(1 - u + u * std::exp(-2 * kappa)) / kappa, 0.0f, 2.0f);
}
Vec3 sample_fisher(Vec3 axis, float kappa, Vec2 u) {
    const float h = fisher_one_minus_cos(kappa, u.x);
    const float sin_theta = safe_sqrt(h * (2 - h)), phi = 2 * kPi * u.y;
    return normalize(Frame::from_z(axis).to_world(
        {sin_theta * std::cos(phi), sin_theta * std::sin(phi), 1 - h}));
}

/// Finds the point nearest to all lines through `position` along `direction`, by weight; returns
/// false where they are parallel.
bool nearest_to_rays(std::span<const CausticPhoton> photons, Vec3& point) {
    double a[3][3] = {}, b[3] = {}, weight = 0;
    for (const CausticPhoton& p : photons) {
        const double d[3] = {p.direction.x, p.direction.y, p.direction.z};
        const double x[3] = {p.position.x, p.position.y, p.position.z};
        weight += p.weight;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                const double m = p.weight * ((i == j ? 1 : 0) - d[i] * d[j]);
                a[i][j] += m;
                b[i] += m * x[j];
            }
    }
    const auto minor = [&a](int i, int j) {
        const int r0 = (i + 1) % 3, r1 = (i + 2) % 3, c0 = (j + 1) % 3, c1 = (j + 2) % 3;
        return a[r0][c0] * a[r1][c1] - a[r0][c1] * a[r1][c0];
    };
    const double det = a[0][0] * minor(0, 0) + a[0][1] * minor(0, 1) + a[0][2] * minor(0, 2);
    if (!(det > 1e-9 * weight * weight * weight)) return false;
    double x[3];
    for (int i = 0; i < 3; ++i)
        x[i] = (minor(0, i) * b[0] + minor(1, i) * b[1] + minor(2, i) * b[2]) / det;
    point = {float(x[0]), float(x[1]), float(x[2])};
    return true;
}

/// Squared distance between a photon's direction and the direction to `point`, as unit vectors; 4
/// where the point lies behind.
float miss(const CausticPhoton& p, Vec3 point) {
    const Vec3 to = point - p.position;
    return dot(to, p.direction) > 0 ? length_squared(normalize(to) - p.direction) : 4.0f;
}

/// The median of miss: photons in the long tails of a rough mirror do not change it.
float median_miss(std::span<const CausticPhoton> photons, Vec3 point) {
    std::vector<float> all;
    for (const CausticPhoton& p : photons) all.push_back(miss(p, point));
    const auto middle = all.begin() + std::ptrdiff_t(all.size() / 2);
    std::nth_element(all.begin(), middle, all.end());
    return *middle;
}

/// Limits the weights of photons: those of very large weight say no more about where light comes
/// from than others.
void limit_weights(std::span<CausticPhoton> photons) {
    double sum = 0;
    for (const CausticPhoton& p : photons) sum += p.weight;
    const float most = float(10 * sum / double(photons.size()));
    for (CausticPhoton& p : photons) p.weight = std::min(p.weight, most);
}

}  // namespace

Vec3 GuideMixture::sample(float u_choice, Vec2 u) const {
    int i = 0;
    for (; i + 1 < count_; ++i) {
        if (u_choice < lobes_[size_t(i)].weight) break;
        u_choice -= lobes_[size_t(i)].weight;
    }
    const Lobe& lobe = lobes_[size_t(i)];
    return sample_fisher(lobe.direction(), lobe.kappa, u);
}

float GuideMixture::pdf(Vec3 w) const {
    float p = 0;
    for (int i = 0; i < count_; ++i) {
        const Lobe& lobe = lobes_[size_t(i)];
        // Half the squared distance is 1 - cos, and exact for narrow lobes.
        const float h = 0.5f * length_squared(w - lobe.direction());
        if (lobe.kappa * h < 60) p += lobe.weight * fisher_pdf(lobe.kappa, 1 - h);
    }
    return p;
}

CausticGuide::CausticGuide(const LitScene& scene) {
    // Trace photons until there are enough
    const FilmDescription& film = scene.description.film;
    const int64_t round = std::min(kRoundPaths, int64_t(film.width) * int64_t(film.height));
    std::vector<CausticPhoton> photons;
    for (int64_t i = 0; i < kMostRounds && photons.size() < kEnoughPhotons; ++i) {
        const auto more = trace_caustic_photons(scene, i * round, round);
        photons.insert(photons.end(), more.begin(), more.end());
        if (photons.size() < kFewestPhotons) return;
    }
    limit_weights(photons);
    // Divide them into leaves, with the images that each may see
    std::vector<Region> regions;
    build(photons, {}, 0, regions);
    // Measure how much light each image brings, and drop images that bring nothing
    parallel_for(int64_t(regions.size()), [&](int64_t i) {
        const auto k = static_cast<size_t>(i);
        leaves_[k].share = measure(scene, regions[k], uint64_t(i));
    });
    for (size_t i = 0; i < leaves_.size(); ++i) {
        leaves_[i].first = uint32_t(images_.size());
        leaves_[i].count = uint32_t(regions[i].images.size());
        images_.insert(images_.end(), regions[i].images.begin(), regions[i].images.end());
    }
}

uint32_t CausticGuide::build(std::span<CausticPhoton> photons, std::vector<Image> images, int depth,
                             std::vector<Region>& regions) {
    refine(photons, images);
    const auto index = uint32_t(nodes_.size());
    nodes_.emplace_back();
    Bounds3 bounds;
    for (const CausticPhoton& p : photons) bounds.extend(p.position);
    const Vec3 size = bounds.diagonal();
    const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    if (photons.size() <= kLeafPhotons || depth == kMostTreeDepth || !(size[axis] > 0)) {
        nodes_[index].left = uint32_t(leaves_.size());
        // The leaf is larger than its photons: light does not end where the last one fell.
        const Vec3 margin = size * 0.25f + Vec3{1, 1, 1} * (0.05f * size[axis]);
        leaves_.push_back({{bounds.lo - margin, bounds.hi + margin}, 0, 0, 0});
        regions.push_back({photons, std::move(images)});
        return index;
    }
    const size_t half = photons.size() / 2;
    std::stable_sort(photons.begin(), photons.end(),
                     [axis](const CausticPhoton& a, const CausticPhoton& b) {
                         return a.position[axis] < b.position[axis];
                     });
    nodes_[index].axis = axis;
    nodes_[index].split = photons[half].position[axis];
    const uint32_t left = build(photons.first(half), images, depth + 1, regions);
    const uint32_t right = build(photons.subspan(half), std::move(images), depth + 1, regions);
    nodes_[index].left = left;
    nodes_[index].right = right;
    return index;
}

void CausticGuide::refine(std::span<const CausticPhoton> photons, std::vector<Image>& images) {
    std::vector<CausticPhoton> sorted(photons.begin(), photons.end());
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const auto& a, const auto& b) { return a.source < b.source; });
    for (size_t begin = 0, end = 0; begin < sorted.size(); begin = end) {
        while (end < sorted.size() && sorted[end].source == sorted[begin].source) ++end;
        const auto cluster = std::span<const CausticPhoton>(sorted).subspan(begin, end - begin);
        if (cluster.size() < kFewestPhotons) continue;
        const uint64_t source = cluster[0].source;
        const auto known = std::find_if(images.begin(), images.end(),
                                        [source](const Image& i) { return i.source == source; });
        if (known != images.end())
            *known = fit(cluster);
        else
            images.push_back(fit(cluster));
    }
}

CausticGuide::Image CausticGuide::fit(std::span<const CausticPhoton> cluster) {
    std::vector<CausticPhoton> core(cluster.begin(), cluster.end());
    Vec3 point;
    float spread = 4;  // median of miss
    for (int i = 0; i < kFits; ++i) {
        Vec3 position, direction;
        float weight = 0, distance = 0;
        for (const CausticPhoton& p : core) {
            position += p.position * p.weight;
            direction += p.direction * p.weight;
            distance += std::min(p.distance, 1e6f) * p.weight;
            weight += p.weight;
        }
        // Unfolded, the light lies as far along the mean direction as the paths are long; where
        // rays meet in a nearer point (a curved mirror's focus), that point tells better where it
        // is.
        point = position / weight + normalize(direction) * (distance / weight);
        spread = median_miss(core, point);
        Vec3 focus;
        if (nearest_to_rays(core, focus)) {
            const float s = median_miss(core, focus);
            if (s < spread) {
                spread = s;
                point = focus;
            }
        }
        std::erase_if(core, [&](const CausticPhoton& p) { return miss(p, point) > 9 * spread; });
    }
    // The median of the squared distance from the centre of a normal distribution in the plane is 2
    // ln 2 variances of one axis.
    const float deviation =
        std::max(kWidening * std::sqrt(spread / (2 * std::log(2.0f))), kNarrowest);
    Image image;
    image.point = point;
    image.source = cluster[0].source;
    image.kappa = deviation < kWidest ? 1 / (deviation * deviation) : 0;
    return image;
}

/// Paths that measure the light which a leaf's images, and all else, bring to its photons' places.
class CausticGuide::Probes {
  public:
    struct Found {
        Image image;           ///< with its irradiance
        double second_moment;  ///< second moment of finding its light by sampling the cosine
        bool is_photon_seen;   ///< whether a photon of the leaf came by this image
    };

    Probes(const LitScene& scene, const Region& region, uint64_t key)
        : scene_(scene), region_(region), key_(key), rng_(hash_combine(kProbeKey, key)) {}

    Found look_at(Image image) {
        double mean = 0, second_moment = 0;
        for (int i = 0; i < kProbes; ++i) {
            const CausticPhoton& at = place(i);
            const Vec3 axis = normalize(image.point - at.position);
            const Vec3 w = sample_fisher(axis, image.kappa, rng_.next_2d());
            const float cosine = dot(at.normal, w);
            if (!(cosine > 0)) continue;
            const double l = radiance(at, w);
            const double q = fisher_pdf(image.kappa, dot(axis, w));
            mean += l * cosine / q / kProbes;
            second_moment += l * l * cosine * kPi / q / kProbes;
        }
        image.irradiance = float(mean);
        const bool seen =
            std::any_of(region_.photons.begin(), region_.photons.end(),
                        [&image](const CausticPhoton& p) { return p.source == image.source; });
        return {image, mean > 0 ? second_moment : double(kInfinity), seen};
    }

    /// Irradiance by all else: by lamps, and by all other paths. Each of the two finds a part of
    /// it; the larger will do to share samples out.
    double rest() {
        double lamps = 0;
        std::array<float, kProbes> others{};
        for (int i = 0; i < kProbes; ++i) {
            const CausticPhoton& at = place(i);
            lamps += by_lamp(at) / kProbes;
            const Vec3 w =
                Frame::from_z(at.normal).to_world(square_to_cosine_hemisphere(rng_.next_2d()));
            others[size_t(i)] = kPi * radiance(at, w);
        }
        std::sort(others.begin(), others.end());
        const auto typical =
            std::span(others).first(kProbes - kProbes / 8);  // without the rare bright ones
        double rest = 0;
        for (float e : typical) rest += e / double(typical.size());
        return std::max(rest, lamps);
    }

  private:
    const CausticPhoton& place(int i) const {
        return region_.photons[size_t(i) * region_.photons.size() / kProbes];
    }
    float radiance(const CausticPhoton& at, Vec3 w) {
        Sampler sampler(kProbeKey, int(key_), int(count_++), 0);
        const Ray ray{at.position, w, at.time, kInfinity};
        const float y =
            luminance(trace_path(scene_, {}, ray, sampler, kProbeDepth, nullptr).radiance);
        return std::isfinite(y) ? y : 0.0f;
    }
    double by_lamp(const CausticPhoton& at) {
        const float u_select = rng_.next_float();
        const auto light =
            scene_.lights.sample(at.position, at.normal, at.time, u_select, rng_.next_2d());
        if (!light || !(light->pdf > 0)) return 0;
        const Ray shadow{at.position, light->wi, at.time, light->distance * (1 - 1e-3f)};
        // The part of the light that the cosine finds as well is counted with the other paths.
        const float cosine = std::max(0.0f, dot(at.normal, light->wi));
        const float density = light->pdf + (light->is_delta ? 0.0f : cosine * kInvPi);
        if (scene_.geometry.occluded(shadow)) return 0;
        return luminance(light->radiance) * cosine / density;
    }

    const LitScene& scene_;
    const Region& region_;
    uint64_t key_;
    Rng rng_;
    uint32_t count_ = 0;
};

float CausticGuide::measure(const LitScene& scene, Region& region, uint64_t key) {
    Probes probes(scene, region, key);
    std::vector<Probes::Found> all;
    for (const Image& image : region.images) {
        if (!(image.kappa > 0)) continue;
        const Probes::Found found = probes.look_at(image);
        if (found.image.irradiance > 0 || found.is_photon_seen) all.push_back(found);
    }
    const double rest = probes.rest();

    // Only images whose light the surface's own sampling would leave noisy are worth samples.
    double total = rest;
    for (const Probes::Found& f : all) total += f.image.irradiance;
    std::erase_if(all, [total](const Probes::Found& f) { return f.second_moment < total * total; });
    std::stable_sort(all.begin(), all.end(), [](const Probes::Found& a, const Probes::Found& b) {
        return a.image.irradiance > b.image.irradiance;
    });
    if (all.size() > GuideMixture::kMostLobes) all.resize(GuideMixture::kMostLobes);
    region.images.clear();
    double found = 0;
    for (Probes::Found& f : all) {
        // A part of the leaf that the probes missed may be lit brightly.
        f.image.irradiance = std::max(f.image.irradiance, float(kLeastShare * total));
        region.images.push_back(f.image);
        found += f.image.irradiance;
    }
    return std::min(kMostShare, float(found / (found + rest)));
}

GuideMixture CausticGuide::at(Vec3 position, Vec3 n) const {
    GuideMixture mixture;
    if (nodes_.empty()) return mixture;
    const Node* node = &nodes_[0];
    while (node->axis >= 0)
        node = &nodes_[position[node->axis] < node->split ? node->left : node->right];
    const Leaf& leaf = leaves_[node->left];
    if (leaf.count == 0 || !leaf.bounds.contains(position)) return mixture;
    const bool both_sides = n == Vec3{};
    float sum = 0, all = 0;
    for (uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
        const Image& image = images_[i];
        const Vec3 direction = normalize(image.point - position);
        const float cosine = both_sides ? 1.0f : dot(n, direction);
        all += image.irradiance;
        if (!(cosine > 0)) continue;
        const float weight = image.irradiance * cosine;
        mixture.lobes_[size_t(mixture.count_++)] = {direction.x, direction.y, direction.z,
                                                    image.kappa, weight};
        sum += weight;
    }
    if (!(sum > 0)) return {};
    for (int i = 0; i < mixture.count_; ++i) mixture.lobes_[size_t(i)].weight /= sum;
    mixture.share_ = leaf.share * sum / all;
    return mixture;
}

}  // namespace covtrace
