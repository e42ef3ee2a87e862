/// Chooses one of many finite lights by what each may contribute at a point: a bounding volume
/// hierarchy over lights (Conty Estevez and Kulla 2018, "Importance sampling of many lights with
/// adaptive tree splitting"), walked down at random by the importance of the two children.
#pragma once

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

/// Bounds of both; one without intensity leaves the other unchanged.
LightBounds merge(const LightBounds& a, const LightBounds& b);

class LightTree {
  public:
    LightTree() = default;
    /// One entry per light, whose index names it; those without intensity are never chosen.
    explicit LightTree(const std::vector<LightBounds>& lights);

    struct Choice {
        int light = -1;
        float probability = 0;
    };
    /// `n`: unit normal on the side that light is wanted for; the zero vector where there is none.
    /// Empty where no light can reach p. `u` in [0, 1).
    std::optional<Choice> sample(Vec3 p, Vec3 n, float u) const;
    /// Probability that `sample` returns this light.
    float probability(Vec3 p, Vec3 n, int light) const;
    /// Estimated irradiance at p (of a facing surface where n is zero): an upper bound, roughly.
    float irradiance(Vec3 p, Vec3 n) const;

  private:
    struct Node {
        Vec3 center;
        float radius_squared = 0;  ///< of the sphere around the box
        Vec3 axis;
        float intensity = 0;
        float cos_o = 1, sin_o = 0, cos_e = 0;
        bool two_sided = false;
        bool is_leaf = true;
        uint32_t link = 0;  ///< a leaf's light, or the second child; the first child comes next
        float importance(Vec3 p, Vec3 n) const;
    };
    struct Item {
        LightBounds bounds;
        uint32_t light = 0;
    };
    static constexpr uint64_t kNotInTree = ~uint64_t{0};

    LightBounds build(std::vector<Item>& items, size_t begin, size_t end, uint64_t trail,
                      int depth);
    static Node make_node(const LightBounds& bounds, bool is_leaf, uint32_t link);

    std::vector<Node> nodes_;
    std::vector<uint64_t> trails_;  ///< per light: bit i says which child to take at depth i
};

}  // namespace covtrace
