/// Loader of the library Open Image Denoise (OIDN) into this process.
#pragma once

#include <filesystem>

#include "denoiser/oidn_api.h"

namespace covtrace::oidn {

struct Library {
    Api api;                     ///< the library's functions
    std::filesystem::path file;  ///< path at which the dynamic linker found the library
};

/// Loads `file`: a path, or a bare name that the dynamic linker looks for. The parts of the library
/// are found beside it, in whatever folder they are. The library stays loaded: its own threads may
/// outlive every use of it. Throws Error(usage), which says what and why, where it cannot be loaded
/// or lacks a function of version 2.
Library load_library(const std::filesystem::path& file);

}  // namespace covtrace::oidn
