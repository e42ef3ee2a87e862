/// A guide to light that comes over a mirror or through glass.
///
/// A diffuse point that is lit by a small lamp over a near-mirror finds that light by chance alone:
/// neither sampling its own lobe nor sampling the lamp aims at the mirror's image of it. The guide
/// knows those images. It is learnt once per scene, from light sent over the glossy surfaces that
/// camera paths meet, and mixed with the BSDF's own sampling, so that estimates stay unbiased
/// whatever it holds (Jensen 1995, "Importance driven path tracing using the photon map", with
/// clusters of photons fitted by one lobe each instead of a histogram). It leads paths only where
/// it takes away more than a fifth of their noise, or where that light is so rare that they would
/// hardly ever meet it: elsewhere the samples that it takes from other light cost more than they
/// save.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"
#include "integrator/guides/caustic_image.h"
#include "integrator/guides/caustic_photons.h"
#include "integrator/guides/guide_outcome.h"

namespace covtrace {

struct LitScene;
class LampGuide;
struct PathLesson;
class SkyGuide;

/// A density over directions: von Mises-Fisher lobes at one point.
class GuideMixture {
  public:
    static constexpr int kMostLobes = 8;

    GuideMixture() {}  // not `= default`, which would let `{}` clear lobes that nobody reads

    /// Share of the samples that should follow the guide; 0 where there is nothing to be found.
    float share() const { return share_; }
    /// Samples a direction; `u_choice` chooses the lobe.
    Vec3 sample(float u_choice, Vec2 u) const;
    /// Density of `sample`, per solid angle.
    float pdf(Vec3 w) const;

  private:
    friend class CausticGuide;
    struct Lobe {
        float x, y, z;        ///< direction
        float kappa, weight;  ///< von Mises-Fisher concentration; share of the mixture
        Vec3 direction() const { return {x, y, z}; }
    };
    std::array<Lobe, kMostLobes> lobes_;  ///< lobes, of which only `count_` are set
    int count_ = 0;
    float share_ = 0;
};

/// The guide of a scene: a tree over the places that photons reached, whose leaves know the images
/// of lights that are seen from there.
class CausticGuide {
  public:
    /// Makes an empty guide: shares are 0 everywhere.
    CausticGuide() = default;
    /// Learns from a scene. `sky` and `lamps` lead the paths that its outcome is measured on beside
    /// it. The result is deterministic; it is empty where a guide would not pay.
    CausticGuide(const LitScene& scene, const SkyGuide& sky, const LampGuide& lamps);

    /// The guide at a point with the normal `n` on the side that is to be lit; n is zero where
    /// light counts from both sides.
    GuideMixture at(Vec3 position, Vec3 n) const;
    const GuideOutcome& outcome() const { return outcome_; }

  private:
    /// A light's image, and how much light it brings.
    struct Image {
        CausticImage seen;
        float irradiance = 0;  ///< luminance of the irradiance on the surfaces of the leaf
        uint64_t source = 0;   ///< CausticPhoton::source
        /// Weight of the photons that came this way for each one that came anyhow, in the smallest
        /// region about the leaf where they were enough to fit an image.
        float light = 0;
    };
    struct Leaf {
        Bounds3 bounds;   ///< box of its photons with a margin; no guide beyond it
        float share = 0;  ///< share of the samples that should follow all the leaf's images
        uint32_t first = 0, count = 0;  ///< the leaf's images, in images_
    };
    struct Node {
        int axis = -1;  ///< -1: a leaf
        float split = 0;
        uint32_t left = 0, right = 0;  ///< nodes; for a leaf `left` is the index into leaves_
    };

    /// A leaf in the making: its photons, and the images that may be seen from it.
    struct Region {
        std::span<const CausticPhoton> photons;
        std::vector<Image> images;
        float hidden = 0;  ///< share of its light that paths without a guide hardly ever meet
    };
    class Probes;
    /// Adds to the guide what photons tell, in leaves of at most `leaf_photons`. Returns the share
    /// of hidden light, mean over the leaves.
    double learn(const LitScene& scene, std::vector<CausticPhoton> photons, size_t leaf_photons);
    uint32_t build(std::span<CausticPhoton> photons, std::vector<Image> images, size_t leaf_photons,
                   int depth, std::vector<Region>& regions);
    /// Fits an image to each source that the photons suffice for; other images stay as they are.
    static void refine(std::span<const CausticPhoton> photons, std::vector<Image>& images);
    /// Keeps the `count` images of the most light, where there are more.
    static void keep_brightest(std::vector<Image>& images, size_t count);
    /// Measures how much light there is to be found in each image, drops images that bring nothing,
    /// notes how much is hidden, and returns the share of the samples for the others. `key` seeds
    /// the leaf's random numbers.
    static float measure(const LitScene& scene, Region& region, uint64_t key);
    /// The leaf that guides at a place; null where none does.
    const Leaf* find(Vec3 position) const;
    bool guides(Vec3 position) const;
    /// Second moment of the light of paths, which this guide has led, over that without it.
    double second_moment(const PathLesson& lesson) const;

    std::vector<Node> nodes_;
    std::vector<Leaf> leaves_;
    std::vector<Image> images_;
    GuideOutcome outcome_;
};

}  // namespace covtrace
