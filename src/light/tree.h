/// Chooses one of many finite lights by what each may contribute at a point: a bounding volume
/// hierarchy over lights (Conty Estevez and Kulla 2018, "Importance sampling of many lights with
/// adaptive tree splitting"), walked down at random by the importance of the children. Every node
/// has up to four children, side by side in memory, so that they are judged by the same vector
/// instructions.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
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
    /// Chooses a light for the point p. `n`: unit normal on the side that light is wanted for; the
    /// zero vector where there is none. `u` in [0, 1). Empty where no light can reach p.
    std::optional<Choice> sample(Vec3 p, Vec3 n, float u) const;
    /// Probability that `sample` returns this light.
    float probability(Vec3 p, Vec3 n, int light) const;
    /// Estimated irradiance at p (of a facing surface where n is zero), without shadows.
    float irradiance(Vec3 p, Vec3 n) const;

  private:
    static constexpr size_t kWidth = 4;
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
    };
    static constexpr uint32_t kLeaf = 1u << 31;
    static constexpr uint64_t kNotInTree = ~uint64_t{0};
    class Builder;

    std::vector<Node> nodes_;  ///< the first is the root
    /// Per light, the way from the root to it: two bits for each level say which child to take, the
    /// lowest bits at the root.
    std::vector<uint64_t> trails_;
};

}  // namespace covtrace
