/// The time that the image of `--method hybrid` takes once its samples are there.
#pragma once

#include <map>
#include <optional>

#include "reconstruction/denoiser.h"
#include "render/job.h"
#include "render/timed_denoiser.h"

namespace covtrace {

/// Seconds of the reconstruction and of writing the image.
struct ReconstructionTimes {
    double without_denoiser = 0;
    std::map<DenoiserQuality, double> denoised;  ///< empty where there is no denoiser
};

/// Tells the times by those of a part of the image. `prediction`: that of the whole image. The
/// times decide when to stop and how the samples are denoised, and nothing of the samples.
ReconstructionTimes reconstruction_times(RenderJob& job, const Prediction& prediction,
                                         const TimedDenoiser* denoiser);

/// Quality of the denoiser that `left` seconds allow: the one that was `asked` for or, without
/// that, high quality where it takes less than three tenths of them, or no more than what the
/// samples leave that are still to come, which take `sampling` seconds if no time ends them. None:
/// the image without a denoiser, which is quicker than one that takes longer than `left`.
std::optional<DenoiserQuality> affordable_quality(const ReconstructionTimes& times,
                                                  std::optional<DenoiserQuality> asked, double left,
                                                  double sampling);

}  // namespace covtrace
