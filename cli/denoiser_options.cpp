#include "cli/denoiser_options.h"

#include <filesystem>
#include <system_error>

#include "cli/message.h"
#include "cli/options.h"

namespace covtrace::cli {

void add_denoiser_options(CLI::App* c, DenoiserArguments& a) {
    add_choice(c, "--denoiser", a.choice, "hybrid: Open Image Denoise, too");
    add_choice(c, "--denoiser-quality", a.quality, "fast: the denoiser alone, in little time");
    c->add_option("--denoiser-library", a.library, "its file: libOpenImageDenoise.so.2")
        ->check(not_empty())
        ->option_text("FILE");
}

FoundDenoiser find(const DenoiserArguments& a) {
    namespace fs = std::filesystem;
    std::error_code ignored;
    const fs::path folder = fs::read_symlink("/proc/self/exe", ignored).parent_path();
    return find_denoiser(
        {a.choice.value_or(DenoiserChoice::automatic),
         a.library,
         {folder / "denoiser", folder / "../denoiser", folder / "../lib/covtrace/denoiser"}});
}

void warn_of_unusable(const FoundDenoiser& found) {
    if (found.is_unusable) say("warning: no denoiser is used: {}\n", found.why_none);
}

bool is_denoised_fast(const Image& image) {
    const auto quality = image.metadata.find("covtrace:denoiserQuality");
    return quality != image.metadata.end() &&
           std::get<std::string>(quality->second) == name_of(DenoiserQuality::fast);
}

void warn_of_failed_denoiser(const Image& image) {
    const auto failure = image.metadata.find("covtrace:denoiserFailure");
    if (failure != image.metadata.end())
        say("warning: the image is without the denoiser: {}\n",
            std::get<std::string>(failure->second));
}

}  // namespace covtrace::cli
