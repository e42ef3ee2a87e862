/// Open Image Denoise (github.com/RenderKit/oidn) as a `Denoiser`.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "reconstruction/denoiser.h"

namespace covtrace {

/// Open Image Denoise 2 where its library is found while the program runs: the filter for ray
/// tracing, HDR, at high quality, with albedo and normal that it has freed of noise before where
/// that is asked for.
class OidnDenoiser : public Denoiser {
  public:
    /// Loads the library `file`: a path, or a bare name that the dynamic linker looks for. It uses
    /// as many threads as ThreadLimit allows now. Throws Error(usage) where the library cannot be
    /// loaded, is no version 2 or finds no CPU that it supports; the message says what and why.
    explicit OidnDenoiser(const std::filesystem::path& file);
    ~OidnDenoiser() override;

    /// Denoises images, as Denoiser says. Results are finite whatever the images hold; all-black
    /// images stay black.
    std::vector<ColorPlanes> denoise(const NoisyFeatures& features,
                                     std::vector<NoisyImage> images) const override;

    /// Bytes as measured with version 2.5.1.
    size_t memory(size_t pixels) const override;

    /// Name with version: "Open Image Denoise 2.5.1".
    std::string name() const override;
    /// File of the library, where the dynamic linker found it.
    const std::filesystem::path& file() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace covtrace
