// The laboratory's table: a scene with prediction and measurement around one ray of its camera.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <span>
#include <string>

#include "laboratory/edge_spread.h"
#include "laboratory/local_spectrum.h"
#include "laboratory/prediction.h"
#include "pbrt/read_scene.h"

namespace covtrace::test {

inline constexpr double kPiD = 3.14159265358979323846;

/// A scene given as text, looked at through the middle of its film of 32 x 32 pixels.
class Table {
  public:
    /// Reads the scene. `occlusion`: whether the outlines of the geometry are looked at.
    explicit Table(const std::string& text, bool occlusion = false, Vec2 film = {16, 16})
        : scene_(read_pbrt_string(text, "test", ".")), spectra_(scene_), rays_(scene_, film) {
        if (occlusion) query_.emplace(scene_.geometry);
        replay_.emplace(scene_, spectra_, Occluders{nullptr, query_ ? &*query_ : nullptr},
                        BrdfCovariance::local);
    }
    Table(const Table&) = delete;
    Table& operator=(const Table&) = delete;

    int depth() const { return scene_.description.max_depth; }
    LocalField radiance() const { return radiance_field(scene_, rays_, depth(), 7); }
    PathCovariance predicted(uint32_t paths = 256) const {
        return predict(scene_, *replay_, rays_, depth(), paths, 0);
    }
    PathCovariance predicted_over_lens_and_shutter(uint32_t paths = 1024) const {
        return predict_over_lens_and_shutter(scene_, *replay_, rays_, depth(), paths, 0);
    }

    /// The first path whose `mirrors` specular events lead to a lit texture, as the replay and as
    /// real rays see it.
    struct Probe {
        covariance::SymmetricMatrix5<double> predicted;
        LocalField field;
    };
    std::optional<Probe> probe(int mirrors) const {
        PathRecord record;
        for (uint32_t i = 0; i < 256; ++i) {
            Sampler sampler(0, 16, 16, i);
            sampler.camera();
            trace_path(scene_, rays_({}), sampler, mirrors + 1, &record);
            if (record.count != mirrors + 1) continue;
            const PathVertex& end = record.vertices[size_t(mirrors)];
            if (!(end.direct > 0) || !end.seen_sharply) continue;
            const auto spot = spectra_.textures.uv_covariance(
                scene_.materials.textures(end.material).reflectance, {end.hit.uv, end.hit.position},
                end.hit.dpdu, end.hit.dpdv, 0);
            return Probe{(*replay_)(record).sigma, probe_field(scene_, rays_, record, spot)};
        }
        return std::nullopt;
    }

  private:
    RenderScene scene_;
    SceneSpectra spectra_;
    SensorRays rays_;
    std::optional<OccluderQuery> query_;
    std::optional<PathReplay> replay_;
};

/// Ratios of bandwidths, predicted over measured, along the axes on which either is resolved.
struct Ratios {
    double worst = 1;  ///< the ratio farthest from 1, as a factor
    std::string text;

    void add(const char* axis, double ratio) {
        if (std::abs(std::log(ratio)) > std::abs(std::log(worst))) worst = ratio;
        text += fmt::format(" {} {:.4f}", axis, ratio);
    }
    bool within(double factor) const {
        return std::isfinite(worst) && worst <= factor && worst >= 1 / factor;
    }
};

inline Ratios compare(const covariance::SymmetricMatrix5<double>& predicted,
                      const MeasuredSpectrum& measured, const MeasureOptions& options) {
    constexpr const char* kAxes[]{"x", "y", "u", "v", "t"};
    Ratios r;
    for (size_t i = 0; i < 5; ++i)
        if (is_resolved(predicted(i, i), i, options) ||
            is_resolved(measured.sigma(i, i), i, options))
            r.add(kAxes[i], std::sqrt(predicted(i, i) / measured.sigma(i, i)));
    EXPECT_FALSE(r.text.empty()) << "nothing is resolved";
    return r;
}

/// Keeps the worst case of a class of set-ups and prints it at the end.
class WorstCase {
  public:
    explicit WorstCase(std::string name) : name_(std::move(name)) {}
    ~WorstCase() {
        if (!where_.empty())
            fmt::print("[ laboratory ] worst of {}: {:.4f} times the measured bandwidth, {}\n",
                       name_, worst_, where_);
    }
    WorstCase(const WorstCase&) = delete;
    WorstCase& operator=(const WorstCase&) = delete;
    void add(const std::string& where, const Ratios& r) {
        fmt::print("[ laboratory ] {}:{}\n", where, r.text);
        if (where_.empty() || std::abs(std::log(r.worst)) > std::abs(std::log(worst_)))
            worst_ = r.worst, where_ = where;
    }

  private:
    std::string name_, where_;
    double worst_ = 1;
};

}  // namespace covtrace::test
