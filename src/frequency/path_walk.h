/// One walk over a recorded path, from its far end to the sensor: the order of all operators. Only
/// for replay.cpp.
#pragma once

#include <array>
#include <optional>

#include "frequency/replay.h"

namespace covtrace {

/// Light that arrives at one place from one direction, and its amount.
struct ArrivingLight {
    std::optional<LightField> field;  ///< set where the weight is above 0
    double weight = 0;
    covariance::Emitter<double> emitter;

    ArrivingLight() {}  // not `= default`, which would set the field to zero first

    void add(const LightField& other, double other_weight);
    void clear();
    /// Adds the light that an even medium emits on the way: the same for all neighbouring rays.
    void add_glow(Vec3 travel, double glow);
};

/// The light of a path on its way to the sensor. `run` reads as the method does: light comes from
/// beyond the last vertex; every vertex scatters the light that has arrived, adds its own emission,
/// and the sum is carried to the next vertex.
class PathWalk {
  public:
    /// Prepares the walk. Light that carries less than `least` of the path's luminance is left out.
    /// Context and record must outlive this object.
    PathWalk(const ReplayedScene& context, const PathRecord& record, LightPart part, double least);
    PathCovariance run();
    /// Luminance of the light that was followed; only after `run`.
    double kept() const { return light_.weight; }

  private:
    /// A sampled light as it arrives at a vertex, and the emitter that a diffuse receiver sees.
    struct SampledLight {
        LightField field;
        covariance::Emitter<double> emitter;
    };
    using Owner = OccluderQuery::Owner;

    /// Luminance of all light of the part that is followed.
    double total() const;
    /// Fills in the distance of every vertex from the camera, and the camera's view of it.
    void find_visibilities();
    /// Does so for the mirror by which light is sampled at vertex i.
    void find_visibility_of_mirror(size_t i);
    void arrive_from_sky();
    /// Scatters at vertex i the light that arrives there and the light sampled there. Returns the
    /// outline of the surface that light leaves, where it has one and occluders are asked for.
    std::optional<OwnOutline> scatter_at(int i);
    std::optional<OwnOutline> scatter_on_surface(int i);
    void scatter_in_medium(int i);
    /// Calls scatter(field, emitter, lobes, weight) for the light that arrives at vertex i and for
    /// the lights sampled there, straight and by a mirror.
    template <class Scatter>
    void scatter_all(int i, const Scatter& scatter);
    /// Adds the emission of vertex i itself. Sets `own` where scattering did not.
    void emit_at(int i, std::optional<OwnOutline>& own);
    /// Adds the light of an unlit surface at a vertex, which is the path's last.
    void shine_unlit(int i, float emitted, std::optional<OwnOutline>& own);
    void carry_on(int i, const std::optional<OwnOutline>& own);
    PathCovariance at_sensor();

    SampledLight sampled_light(int i, double weight) const;
    /// Light sampled at vertex i by a flat mirror, once the mirror has sent it there.
    SampledLight mirrored_light(int i, double weight) const;
    /// Light of the sky from `w`, `seen_by` rays of a kind or only lighting something.
    LightField sky_field(Vec3 w, std::optional<RayKind> seen_by) const;
    /// The kind of the ray by which the path left the scene, all before it being specular.
    RayKind kind_of_escape() const;
    /// Carries light past occluders to vertex i, to the camera where i is below 0. `own` is the
    /// outline of the surface that it has left.
    void carry(LightField& field, Vec3 from, Owner owner_of_from, int i, double weight,
               const OwnOutline* own = nullptr) const;
    /// Carries light from infinity, from the direction w, to vertex i. Without occluders on the way
    /// nothing changes: such light has no variation in space.
    void carry_from_infinity(LightField& field, Vec3 w, int i, double weight) const;
    /// Carries light to a surface, past the occluders on the way where both are visible: `share`,
    /// this light's part of the path's luminance, and the features at the end.
    LightField to_surface(const LightField& field, const OccluderQuery::Segment& segment,
                          const Visibility& end, double share, const OwnOutline* own) const;
    LightField to_camera(const LightField& field, const OccluderQuery::Segment& segment,
                         double share, const OwnOutline* own) const;

    /// Number of the place on the mirror by which light is sampled at vertex i: such places have
    /// the numbers beyond those of the path's own vertices.
    static int mirror(int i) { return PathRecord::kCapacity + i; }
    const PathVertex& vertex(int i) const {
        return i < PathRecord::kCapacity ? record_.vertices[size_t(i)]
                                         : record_.mirrors[size_t(i - PathRecord::kCapacity)];
    }
    Vec3 position(int i) const;
    Owner owner(int i) const;
    /// Half a pixel's extent at vertex i, scene units: it grows with the distance travelled.
    float half_pixel(int i) const;
    /// The given luminance where it belongs to the part that is followed, 0 otherwise.
    float taken(float luminance, bool in_view) const;
    bool counts(double luminance) const { return luminance > 0 && luminance >= least_ * total_; }

    const ReplayedScene& context_;
    const LitScene& scene_;
    const SceneSpectra& spectra_;
    const PathRecord& record_;
    LightPart part_;
    double least_;
    double total_;
    SensorGeometry camera_;
    static constexpr int kPlaces = 2 * PathRecord::kCapacity;
    // To the previous vertex; to the camera, over all vertices between.
    std::array<float, kPlaces> ways_, distances_;
    std::array<Visibility, kPlaces> visible_;  // filled where there are occluders
    ArrivingLight light_;
};

}  // namespace covtrace
