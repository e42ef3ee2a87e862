/// The choice of a render's denoiser, by the options and by the libraries found on this machine.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/enum_names.h"
#include "reconstruction/denoiser.h"

namespace covtrace {

enum class DenoiserChoice {
    automatic,  ///< Open Image Denoise where it is found and works
    oidn,       ///< Open Image Denoise, or an error
    none
};

template <>
inline constexpr auto kEnumNames<DenoiserChoice> =
    enum_names<DenoiserChoice>({{DenoiserChoice::automatic, "auto"},
                                {DenoiserChoice::oidn, "oidn"},
                                {DenoiserChoice::none, "none"}});

struct DenoiserSearch {
    DenoiserChoice choice = DenoiserChoice::automatic;
    /// The library's file, and no other. Empty: that of the environment's COVTRACE_OIDN_LIBRARY,
    /// else libOpenImageDenoise.so.2 in the first of the folders that has it, else the system's.
    std::filesystem::path library;
    std::vector<std::filesystem::path> folders;
};

struct FoundDenoiser {
    std::shared_ptr<const Denoiser> denoiser;  ///< null: none
    std::filesystem::path library;             ///< file of the denoiser
    std::string why_none;                      ///< reason where the denoiser is null
    /// Whether one was found but cannot be used; `why_none` is then a warning's text.
    bool is_unusable = false;
};

/// Loads the denoiser, with as many threads as ThreadLimit allows now. Throws Error(usage) where
/// the choice is `oidn` and it cannot be used; the message names the option --denoiser.
FoundDenoiser find_denoiser(const DenoiserSearch& search);

}  // namespace covtrace
