/// References in two independent halves, and the errors of images against them.
#pragma once

#include <optional>

#include "reproduce/workshop.h"

namespace covtrace::reproduce {

/// A reference: two renders of the plain path tracer with seeds of their own. Their difference is
/// twice the noise of either, whatever the scene: so an image's error against both, less that
/// noise, is its error against the truth.
class Reference {
  public:
    /// Reads the halves from the output's folder `references` where an earlier run left them for
    /// the same scene, images, size and counts by the same commit of this program, without changes;
    /// else renders and keeps them.
    Reference(Workshop& workshop, LoadedScene& scene);

    /// Trimmed relMSE against the truth; may be a little below 0 for an image as good as the
    /// reference.
    double error(const Image& image, std::optional<PixelBounds> crop = std::nullopt) const;
    /// Trimmed relMSE that the noise of one half makes, which error() has taken away.
    double noise(std::optional<PixelBounds> crop = std::nullopt) const;
    /// Trimmed relMSE of the mean of both halves: the reference's own error.
    double own_error() const { return 0.5 * noise(); }

    const Image& half(int k) const { return halves_[size_t(k)]; }
    /// The mean of both halves, its root colour only.
    const Image& mean() const { return mean_; }
    std::string command(int k) const { return commands_[size_t(k)]; }

  private:
    std::array<Image, 2> halves_;
    std::array<std::string, 2> commands_;
    Image mean_;
    double noise_ = 0;
};

/// The generated scene of the snooker table.
inline constexpr const char* kSnookerScene = "snooker-frame";

/// A generated scene at the settings' size for scenes, and its reference: made once per workshop.
LoadedScene& shared_scene(Workshop& workshop, const std::string& name);
Reference& shared_reference(Workshop& workshop, const std::string& name);

}  // namespace covtrace::reproduce
