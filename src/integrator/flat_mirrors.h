/// Flat mirrors of a scene, by which light is sampled.
///
/// What a place sees in a flat mirror, its own image behind the mirror sees straight through it:
/// a sample of a light for the image is one for the place, of the same density per solid angle.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/geometry.h"

namespace covtrace {

/// A part of a plane that reflects, on both sides.
class FlatMirror {
  public:
    Vec3 center, normal;  ///< of the rectangle around it; unit
    Vec3 x, y;            ///< half of the rectangle's sides
    /// The triangles that it consists of, as shares of x and y; empty where there are many.
    std::vector<std::array<Vec2, 3>> triangles;
    /// Share of the rectangle that reflects, times what it is taken to reflect of light.
    float brightness = 0;

    float area() const { return 4 * length(x) * length(y); }
    Vec3 reflect_direction(Vec3 w) const { return w - normal * (2 * dot(w, normal)); }
    Vec3 reflect_point(Vec3 p) const { return p - normal * (2 * dot(p - center, normal)); }
    /// Distance along a ray to where it crosses the mirror; empty where it does not. All hits are
    /// within it, and a few places beside the border or in the rectangle.
    std::optional<float> crossing(Vec3 origin, Vec3 direction) const;

  private:
    bool may_hold(Vec2 place) const;
};

class FlatMirrors {
  public:
    FlatMirrors() = default;
    /// Finds the mirrors of a scene that rest, are no parts of instances and lie flat: the largest
    /// ones, triangles and patches of one plane together. `geometry` is the scene's.
    FlatMirrors(const SceneDescription& scene, const Geometry& geometry);

    bool is_empty() const { return mirrors_.empty(); }
    size_t size() const { return mirrors_.size(); }
    const FlatMirror& operator[](int i) const { return mirrors_[size_t(i)]; }

    /// The mirror that a hit lies on; -1: none.
    int at(const SurfaceHit& hit) const {
        if (hit.shape >= mirror_of_.size()) return -1;
        const auto& parts = mirror_of_[hit.shape];
        return hit.primitive < parts.size() ? parts[hit.primitive] : -1;
    }

    struct Choice {
        int mirror = -1;
        float probability = 0;
    };
    /// Chooses one of the mirrors that the point p sees, `n` being the normal on the side that
    /// light is wanted for, or 0. `u` in [0, 1) becomes a number of its own within the choice.
    /// Empty where none is seen.
    std::optional<Choice> choose(Vec3 p, Vec3 n, float& u) const;
    /// Probability that `choose` returns this mirror.
    float probability(int mirror, Vec3 p, Vec3 n) const;

  private:
    static constexpr size_t kMost = 8;
    /// The light that a mirror may bring to p: about the solid angle of its rectangle times its
    /// brightness.
    float weight(const FlatMirror& mirror, Vec3 p, Vec3 n) const;

    std::vector<FlatMirror> mirrors_;
    /// Per shape and primitive (triangle or patch), the mirror that it is part of; -1: none. Empty
    /// for shapes without.
    std::vector<std::vector<int8_t>> mirror_of_;
};

}  // namespace covtrace
