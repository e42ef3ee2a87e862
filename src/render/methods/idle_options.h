/// Options that a render does not look at, for messages: who gives them believes that they count.
#pragma once

#include <string>
#include <vector>

#include "render/options.h"

namespace covtrace {

/// One sentence for each option that is not its default and changes nothing, by the names that the
/// program has for them: "--even-counts changes nothing: it is for the method hybrid, and this is
/// uniform". `insists_on_denoiser`: the caller asks for Open Image Denoise, whatever is found.
std::vector<std::string> idle_options(const RenderOptions& options, bool insists_on_denoiser);

}  // namespace covtrace
