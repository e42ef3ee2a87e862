/// Chooses one of many finite lights by what each may contribute at a point: a bounding volume
/// hierarchy over lights (Conty Estevez and Kulla 2018, "Importance sampling of many lights with
/// adaptive tree splitting"), walked down at random by the importance of the children. Every node
/// has up to four children, side by side in memory, so that they are judged by the same vector
/// instructions.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/vec.h"

namespace covtrace {

/// Where one or several lights are and which way they shine.
struct LightBounds {
    Bounds3 box;
    Vec3 axis{0, 0, 1};       ///< unit, of the cone of normals
    float theta_o = 0;        ///< half angle of the cone of normals, radians
    float theta_e = kPi / 2;  ///< how far from a normal light is emitted, radians
    float intensity = 0;  ///< bound on the radiant intensity in any direction, mean of the channels
    bool two_sided = false;  ///< shines along -axis as well
};

/// Bounds of two groups of lights together; one without intensity leaves the other unchanged.
LightBounds merge(const LightBounds& a, const LightBounds& b);

class LightTree {
  public:
    LightTree() = default;
    /// Builds the tree. `lights` has one entry per light, whose index names it; those without
    /// intensity are never chosen.
    explicit LightTree(const std::vector<LightBounds>& lights);

    struct Choice {
        int light = -1;
        float probability = 0;
    };
    /// Factors on the importance of the children of the first nodes, all above 0: kWidth of them
    /// for each node, of as many nodes as they are given for. None: the importance alone decides.
    using Factors = std::span<const float>;
    /// Chooses a light for the point p. `n`: unit normal on the side that light is wanted for; the
    /// zero vector where there is none. `u` in [0, 1). Empty where no light can reach p.
    std::optional<Choice> sample(Vec3 p, Vec3 n, float u, Factors factors = {}) const;
    /// Probability that `sample` returns this light.
    float probability(Vec3 p, Vec3 n, int light, Factors factors = {}) const;

    /// A sphere around a light.
    struct Ball {
        Vec3 center;
        float radius = 0;
    };
    /// Chooses a light for a piece of a ray, from its origin over `length` (finite, above 0) along
    /// the unit direction, in proportion to its intensity times the integral of 1 / r^2 over the
    /// piece; which way it shines does not count. `u` in [0, 1) becomes its place within what leads
    /// to that light, and can be used again. Empty without lights.
    std::optional<Ball> choose_beside(Vec3 origin, Vec3 direction, float length, float& u) const;

    /// A step from a node to one of its children.
    struct Step {
        uint32_t child = 0;     ///< index of the child's factor
        float importance = 0;   ///< of the child, without a factor
        float probability = 0;  ///< of the child, by importance alone
        float tried = 0;        ///< probability with which `explore` took the step
    };
    /// Chooses a light to learn from: half of the choices at every node are even among the children
    /// that may light p, so that weak ones are not missed. `way` gets the steps to it.
    std::optional<Choice> explore(Vec3 p, Vec3 n, float u, std::vector<Step>& way) const;
    /// Number of factors that are worth having: for all nodes, or for those nearest to the root.
    size_t factor_count() const {
        constexpr size_t kMostNodes = 64;
        return kWidth * std::min(nodes_.size(), kMostNodes);
    }
    static constexpr size_t kWidth = 4;  ///< most children of a node
    /// Estimated irradiance at p (of a facing surface where n is zero), without shadows.
    float irradiance(Vec3 p, Vec3 n) const;

  private:
    /// How the cosine at the surface counts. `bound`, for choosing among lights, leaves out none
    /// that may shine; `mean` estimates the irradiance of all of them together.
    enum class Estimate { bound, mean };
    using Lanes = std::array<float, kWidth>;
    /// Up to four children, each a light or a node; those that are not there have no intensity.
    struct Node {
        Lanes center_x{}, center_y{}, center_z{};
        Lanes radius_squared{};  ///< of the sphere around the box
        Lanes axis_x{}, axis_y{}, axis_z{};
        Lanes cos_o{}, sin_o{}, cos_e{};
        Lanes intensity{};
        std::array<uint32_t, kWidth> two_sided{};  ///< 0 or 1
        std::array<uint32_t, kWidth> link{};       ///< kLeaf and a light, or a node

        /// Estimated irradiance by each child.
        template <Estimate kEstimate>
        Lanes importance(Vec3 p, Vec3 n) const;
        /// Importance of each child for a piece of a ray.
        Lanes importance_beside(Vec3 origin, Vec3 direction, float length) const;
        Vec3 center(size_t i) const { return {center_x[i], center_y[i], center_z[i]}; }
    };
    static constexpr uint32_t kLeaf = 1u << 31;
    static constexpr uint64_t kNotInTree = ~uint64_t{0};
    class Builder;

    /// Importance of a node's children with their factors.
    Lanes weights(uint32_t node, Vec3 p, Vec3 n, Factors factors) const;
    /// Takes the share u of the weights' sum: the child that it falls on, of those that have any
    /// weight; u becomes its place within that child.
    static size_t choose(const Lanes& weights, float total, float& u);

    std::vector<Node> nodes_;  ///< level by level; the first is the root
    /// Per light, the way from the root to it: two bits for each level say which child to take, the
    /// lowest bits at the root.
    std::vector<uint64_t> trails_;
};

}  // namespace covtrace
