/// The statistics that `render --stats` writes.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "denoiser/find_denoiser.h"
#include "render/session.h"

namespace covtrace::cli {

/// Makes the statistics of a finished render, as JSON.
nlohmann::json statistics_json(const RenderScene& scene, const RenderResult& result,
                               const FoundDenoiser& denoiser, const Monitor& monitor);

}  // namespace covtrace::cli
