#include "integrator/guides/caustic_guide.h"

#include <algorithm>
#include <cmath>

#include "core/frame.h"
#include "core/hash.h"
#include "core/parallel.h"
#include "core/rng.h"
#include "core/warp.h"
#include "integrator/guides/lamp_guide.h"
#include "integrator/guides/path_guide.h"
#include "integrator/guides/path_lesson.h"
#include "integrator/guides/sky_guide.h"
#include "integrator/lit_scene.h"
#include "integrator/path.h"
#include "integrator/visibility.h"

namespace covtrace {

namespace {

constexpr int64_t kRoundPaths = 4096, kMostRounds = 16;
// A sketch of few photons tells whether a guide pays, a coarse guide of more where a fine one does.
constexpr size_t kSketchPhotons = 2048, kCoarsePhotons = 8192, kCoarseLeaf = 256;
constexpr int64_t kSketchRounds = 4;
constexpr size_t kFinePhotons = 32768, kFineLeaf = 64;
constexpr int kMostTreeDepth = 24;
constexpr uint64_t kProbeKey = 0x70726f6265730000ull;
/// Most images that a leaf probes, sixteen times as many as it may keep: rooms full of coated and
/// rough surfaces have hundreds, almost all of them without light (docs/decisions/0152).
constexpr size_t kMostProbed = 16 * GuideMixture::kMostLobes;
constexpr int kProbes = 16;  // paths that measure how much light a lobe or a leaf brings
constexpr int kProbeDepth = 5;
constexpr int kProbeScales = 4;        // lobes about a photon's direction
constexpr float kProbeScaleStep = 16;  // times as concentrated as the one before
constexpr float kMostKappa = 1e7f;     // single precision tells no narrower lobe from its axis
constexpr float kMostShare = 0.5f, kLeastShare = 0.02f;
/// Light is hidden where a path that meets it by the surface's own sampling is so many times as
/// bright as the place in the mean: so rare that paths cannot measure what it costs. Where it is
/// more than this share of the light over the photons' leaves, the guide leads paths in any case.
constexpr double kHiddenBrightness = 1000, kMuchHidden = 0.2;
/// Elsewhere it pays where it leaves less than this share of the second moment of paths, which
/// takes thousands of them to tell: two for each pixel, within a limit.
constexpr double kWorthwhile = 0.78;
constexpr int64_t kTrialPerPixel = 2, kMostTrialPaths = 16384;

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

CausticGuide::CausticGuide(const LitScene& scene, const SkyGuide& sky, const LampGuide& lamps) {
    const FilmDescription& film = scene.description.film;
    const int64_t pixels = int64_t(film.width) * int64_t(film.height);
    const int64_t round = std::min(kRoundPaths, pixels);
    std::vector<CausticPhoton> photons;
    int64_t rounds = 0;
    const auto trace = [&](size_t enough, int64_t most_rounds) {
        for (; rounds < most_rounds && photons.size() < enough; ++rounds) {
            const auto more = trace_caustic_photons(scene, rounds * round, round);
            photons.insert(photons.end(), more.begin(), more.end());
            if (photons.size() < CausticImage::kFewestPhotons) return;
        }
    };
    const auto measure_paths = [&] {
        const int64_t count = std::min(kTrialPerPixel * pixels, kMostTrialPaths);
        return second_moment(trace_lesson(scene, *this, sky, lamps, {}, 0, count));
    };
    const auto give_up = [&](double left) {
        const GuideOutcome outcome{GuideState::unused, 0, 0, left, outcome_.most_probed};
        *this = {};
        outcome_ = outcome;
        if (!photons.empty()) outcome_.state = GuideState::gave_up;
    };
    // Learn from a few photons whether it pays
    trace(kSketchPhotons, kSketchRounds);
    const bool is_hidden = learn(scene, photons, kCoarseLeaf) > kMuchHidden;
    const double left = is_hidden || images_.empty() ? 0 : measure_paths();
    if (images_.empty() || !(left < kWorthwhile)) {
        give_up(left);
        return;
    }
    // Learn where it does, then in earnest there
    *this = {};
    trace(kCoarsePhotons, kMostRounds);
    learn(scene, photons, kCoarseLeaf);
    trace(kFinePhotons, kMostRounds);
    const CausticGuide coarse = std::move(*this);
    std::erase_if(photons,
                  [&coarse](const CausticPhoton& p) { return !coarse.guides(p.position); });
    *this = {};
    learn(scene, photons, kFineLeaf);
    if (images_.empty()) {
        give_up(0);
        return;
    }
    outcome_.state = GuideState::guides;
    outcome_.second_moment = is_hidden ? measure_paths() : left;
    outcome_.bytes = nodes_.capacity() * sizeof(Node) + leaves_.capacity() * sizeof(Leaf) +
                     images_.capacity() * sizeof(Image);
}

double CausticGuide::learn(const LitScene& scene, std::vector<CausticPhoton> photons,
                           size_t leaf_photons) {
    if (photons.size() < CausticImage::kFewestPhotons) return 0;
    limit_weights(photons);
    // Divide them into leaves, with the images that each may see
    std::vector<Region> regions;
    build(photons, {}, leaf_photons, 0, regions);
    // Measure how much light each image brings, and drop images that bring nothing
    parallel_for(int64_t(regions.size()), [&](int64_t i) {
        const auto k = static_cast<size_t>(i);
        leaves_[k].share = measure(scene, regions[k], uint64_t(i));
    });
    double hidden = 0;
    for (size_t i = 0; i < leaves_.size(); ++i) {
        leaves_[i].first = uint32_t(images_.size());
        leaves_[i].count = uint32_t(regions[i].images.size());
        images_.insert(images_.end(), regions[i].images.begin(), regions[i].images.end());
        hidden += double(regions[i].hidden) / double(leaves_.size());
    }
    return hidden;
}

uint32_t CausticGuide::build(std::span<CausticPhoton> photons, std::vector<Image> images,
                             size_t leaf_photons, int depth, std::vector<Region>& regions) {
    refine(photons, images);
    const auto index = uint32_t(nodes_.size());
    nodes_.emplace_back();
    Bounds3 bounds;
    for (const CausticPhoton& p : photons) bounds.extend(p.position);
    const Vec3 size = bounds.diagonal();
    const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    if (photons.size() <= leaf_photons || depth == kMostTreeDepth || !(size[axis] > 0)) {
        nodes_[index].left = uint32_t(leaves_.size());
        // The leaf is larger than its photons: light does not end where the last one fell.
        const Vec3 margin = size * 0.25f + Vec3{1, 1, 1} * (0.05f * size[axis]);
        leaves_.push_back({{bounds.lo - margin, bounds.hi + margin}, 0, 0, 0});
        keep_brightest(images, kMostProbed);
        outcome_.most_probed = std::max(outcome_.most_probed, images.size());
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
    const uint32_t left = build(photons.first(half), images, leaf_photons, depth + 1, regions);
    const uint32_t right =
        build(photons.subspan(half), std::move(images), leaf_photons, depth + 1, regions);
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
        if (cluster.size() < CausticImage::kFewestPhotons) continue;
        const uint64_t source = cluster[0].source;
        float light = 0;
        for (const CausticPhoton& p : cluster) light += p.weight / float(photons.size());
        std::erase_if(images, [source](const Image& i) { return i.source == source; });
        for (const CausticImage& seen : CausticImage::seen_by(cluster))
            images.push_back({seen, 0, source, light});
    }
}

void CausticGuide::keep_brightest(std::vector<Image>& images, size_t count) {
    if (images.size() <= count) return;
    std::stable_sort(images.begin(), images.end(),
                     [](const Image& a, const Image& b) { return a.light > b.light; });
    images.resize(count);
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
        std::vector<const CausticPhoton*> own;
        for (const CausticPhoton& p : region_.photons)
            if (p.source == image.source && is_nearest(image, p)) own.push_back(&p);
        double mean = 0, second_moment = 0;
        for (int i = 0; i < kProbes; ++i) {
            // Where photons came by this image, light is looked for around their own directions, at
            // several scales: a lamp may be far smaller than the lobe, and be missed by all probes.
            const bool known = !own.empty();
            const CausticPhoton& at = known ? *own[size_t(i) * own.size() / kProbes] : place(i);
            const Vec3 axis = known ? at.direction : image.seen.direction(at.position);
            const int scales = known ? kProbeScales : 1;
            const auto kappa = [&image](int scale) {
                return std::min(image.seen.kappa() * std::pow(kProbeScaleStep, float(scale)),
                                kMostKappa);
            };
            const Vec3 w = sample_fisher(axis, kappa(i % scales), rng_.next_2d());
            const float cosine = dot(at.normal, w);
            if (!(cosine > 0)) continue;
            const double l = radiance(at, w);
            double q = 0;
            const float h = 0.5f * length_squared(w - axis);
            for (int k = 0; k < scales; ++k) q += fisher_pdf(kappa(k), 1 - h) / scales;
            mean += l * cosine / q / kProbes;
            second_moment += l * l * cosine * kPi / q / kProbes;
        }
        image.irradiance = float(mean);
        return {image, mean > 0 ? second_moment : double(kInfinity), !own.empty()};
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
    /// Whether no other image of the photon's source is nearer to its direction.
    bool is_nearest(const Image& image, const CausticPhoton& photon) const {
        const float miss = image.seen.miss(photon);
        return std::none_of(region_.images.begin(), region_.images.end(), [&](const Image& other) {
            return other.source == photon.source && other.seen.miss(photon) < miss;
        });
    }
    const CausticPhoton& place(int i) const {
        return region_.photons[size_t(i) * region_.photons.size() / kProbes];
    }
    float radiance(const CausticPhoton& at, Vec3 w) {
        Sampler sampler(kProbeKey, int(key_), int(count_++), 0);
        const Ray ray{at.position, w, at.time, kInfinity, RayKind::diffuse};
        // Light behind panes is sampled, and no guide to it pays
        const float own = cosine_hemisphere_pdf(dot(at.normal, w));
        const float y = luminance(
            trace_path_from(scene_, {at.position, at.normal}, own, ray, sampler, kProbeDepth)
                .radiance);
        return std::isfinite(y) ? y : 0.0f;
    }
    double by_lamp(const CausticPhoton& at) {
        const float u_select = rng_.next_float();
        const auto light =
            scene_.lights.sample(at.position, at.normal, at.time, u_select, rng_.next_2d());
        if (!light || !(light->pdf > 0)) return 0;
        Ray shadow{at.position, light->wi, at.time, kInfinity, RayKind::shadow};
        if (!(aim(shadow, *light) > 0)) return 0;
        // The part of the light that the cosine finds as well is counted with the other paths.
        const float cosine = std::max(0.0f, dot(at.normal, light->wi));
        const float density = light->pdf + (light->is_delta ? 0.0f : cosine * kInvPi);
        if (light->is_delta ? scene_.geometry.occluded(shadow) : is_hidden(scene_, shadow))
            return 0;
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
        if (!(image.seen.kappa() > 0)) continue;
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
        if (f.second_moment > kHiddenBrightness * f.image.irradiance * total)
            region.hidden +=
                total > 0 ? f.image.irradiance / float(total) : 1 / static_cast<float>(all.size());
        // A part of the leaf that the probes missed may be lit brightly.
        f.image.irradiance = std::max(f.image.irradiance, float(kLeastShare * total));
        region.images.push_back(f.image);
        found += f.image.irradiance;
    }
    return std::min(kMostShare, float(found / (found + rest)));
}

const CausticGuide::Leaf* CausticGuide::find(Vec3 position) const {
    if (nodes_.empty()) return nullptr;
    const Node* node = &nodes_[0];
    while (node->axis >= 0)
        node = &nodes_[position[node->axis] < node->split ? node->left : node->right];
    const Leaf& leaf = leaves_[node->left];
    return leaf.count > 0 && leaf.bounds.contains(position) ? &leaf : nullptr;
}

bool CausticGuide::guides(Vec3 position) const {
    return find(position) != nullptr;
}

GuideMixture CausticGuide::at(Vec3 position, Vec3 n) const {
    GuideMixture mixture;
    const Leaf* leaf = find(position);
    if (leaf == nullptr) return mixture;
    const bool both_sides = n == Vec3{};
    float sum = 0, all = 0;
    for (uint32_t i = leaf->first; i < leaf->first + leaf->count; ++i) {
        const Image& image = images_[i];
        const Vec3 direction = image.seen.direction(position);
        const float cosine = both_sides ? 1.0f : dot(n, direction);
        all += image.irradiance;
        if (!(cosine > 0)) continue;
        const float weight = image.irradiance * cosine;
        mixture.lobes_[size_t(mixture.count_++)] = {direction.x, direction.y, direction.z,
                                                    image.seen.kappa(), weight};
        sum += weight;
    }
    if (!(sum > 0)) return {};
    for (int i = 0; i < mixture.count_; ++i) mixture.lobes_[size_t(i)].weight /= sum;
    mixture.share_ = leaf->share * sum / all;
    return mixture;
}

}  // namespace covtrace
