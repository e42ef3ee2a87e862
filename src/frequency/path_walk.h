/// One walk over a recorded path, from its far end to the sensor: the order of all operators. Only
/// for replay.cpp.
#pragma once

#include <array>
#include <optional>

#include "frequency/replay.h"

namespace covtrace {

/// Light that arrives at one place from one direction, and how much of it.
struct ArrivingLight {
    std::optional<LightField> field;  ///< where the weight is above 0
    double weight = 0;
    covariance::Emitter<double> emitter;

    ArrivingLight() {}  // not one that sets the field to zero first

    void add(const LightField& other, double other_weight);
    void clear();
    /// Adds what an even medium emits on the way: the same for all neighbouring rays.
    void add_glow(Vec3 travel, double glow);
};

/// The light of a path on its way to the sensor. `run` reads as the method does: light comes from
/// beyond the last vertex; every vertex scatters what has arrived, adds what it emits itself, and
/// the sum is carried to the next one.
class PathWalk {
  public:
    /// Leaves out light that carries less than `least` of the path's luminance. What is given must
    /// outlive this.
    PathWalk(const ReplayedScene& context, const PathRecord& record, LightPart part, double least);
    PathCovariance run();
    /// Luminance of the light that was followed. Only after `run`.
    double kept() const { return light_.weight; }

  private:
    /// A sampled light as it arrives at a vertex, and what a diffuse receiver knows of it.
    struct SampledLight {
        LightField field;
        covariance::Emitter<double> emitter;
    };
    using Owner = OccluderQuery::Owner;

    /// Luminance of all light of the part that is followed.
    double total() const;
    /// Fills in how far every vertex is from the camera, and what the camera can see there.
    void find_visibilities();
    void arrive_from_sky();
    /// Scatters at vertex i what arrives there and the light sampled there. Returns the outline of
    /// the surface that light leaves, where it has one and occluders are asked for.
    std::optional<OwnOutline> scatter_at(int i);
    std::optional<OwnOutline> scatter_on_surface(int i);
    void scatter_in_medium(int i);
    /// Calls scatter(field, emitter, lobes, weight) for each of the two.
    template <class Scatter>
    void scatter_all(int i, const Scatter& scatter);
    /// Adds what vertex i itself emits. Sets `own` where scattering did not.
    void emit_at(int i, std::optional<OwnOutline>& own);
    void carry_on(int i, const std::optional<OwnOutline>& own);
    PathCovariance at_sensor();

    SampledLight sampled_light(int i, double weight) const;
    LightField sky_field(Vec3 w) const;
    /// Carries light past occluders to vertex i, to the camera where i is below 0. `own`: of the
    /// surface it has left.
    void carry(LightField& field, Vec3 from, Owner owner_of_from, int i, double weight,
               const OwnOutline* own = nullptr) const;
    /// The same from infinity, in direction w from there. Without occluders on the way nothing
    /// changes: such light has no variation in space.
    void carry_from_infinity(LightField& field, Vec3 w, int i, double weight) const;
    /// Travel, past the occluders on the way where `share`, this light's part of the path's
    /// luminance, is large enough to be seen and the end's features can be.
    LightField to_surface(const LightField& field, const OccluderQuery::Segment& segment,
                          const Visibility& end, double share, const OwnOutline* own) const;
    LightField to_camera(const LightField& field, const OccluderQuery::Segment& segment,
                         double share, const OwnOutline* own) const;

    const PathVertex& vertex(int i) const { return record_.vertices[size_t(i)]; }
    Vec3 position(int i) const;
    Owner owner(int i) const;
    /// Half a pixel's extent at vertex i, scene units: it grows with the distance travelled.
    float half_pixel(int i) const;
    /// `luminance` where it belongs to the part that is followed, 0 otherwise.
    float taken(float luminance, bool in_view) const;
    bool counts(double luminance) const { return luminance > 0 && luminance >= least_ * total_; }

    const ReplayedScene& context_;
    const RenderScene& scene_;
    const PathRecord& record_;
    LightPart part_;
    double least_;
    double total_;
    SensorGeometry camera_;
    std::array<float, PathRecord::kCapacity> ways_, distances_;  // to the previous vertex, to all
    std::array<Visibility, PathRecord::kCapacity> visible_;      // where there are occluders
    ArrivingLight light_;
};

}  // namespace covtrace
