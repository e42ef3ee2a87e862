#include "denoiser/find_denoiser.h"

#include <dlfcn.h>

#include <cstdlib>
#include <system_error>

#include "core/error.h"
#include "denoiser/oidn_denoiser.h"

namespace covtrace {

namespace {

namespace fs = std::filesystem;

constexpr const char* kName = "libOpenImageDenoise.so.2";

/// The library to be tried: the one that is named, by the search or COVTRACE_OIDN_LIBRARY, else the
/// first in the search's folders, else the bare name of the system's; empty where there is none.
fs::path place(const DenoiserSearch& search) {
    std::error_code error;
    if (!search.library.empty()) return fs::absolute(search.library, error);
    if (const char* named = std::getenv("COVTRACE_OIDN_LIBRARY"); named && *named)
        return fs::absolute(named, error);
    for (const fs::path& folder : search.folders)
        if (fs::exists(folder / kName, error)) return (folder / kName).lexically_normal();
    return ::dlopen(kName, RTLD_NOW | RTLD_LOCAL) ? kName : "";
}

std::string not_found(const DenoiserSearch& search) {
    std::string text = std::string("no ") + kName + " in ";
    for (const fs::path& folder : search.folders)
        text += "'" + folder.lexically_normal().string() + "', ";
    return text +
           "nor where the system has its libraries; ./scripts/install-dependencies fetches it, "
           "the denoiser's library and COVTRACE_OIDN_LIBRARY name one";
}

}  // namespace

FoundDenoiser find_denoiser(const DenoiserSearch& search) {
    if (search.choice == DenoiserChoice::none) return {nullptr, {}, "not asked for"};
    const fs::path file = place(search);
    try {
        if (file.empty()) throw Error(ErrorKind::usage, not_found(search));
        const auto oidn = std::make_shared<OidnDenoiser>(file);
        return {oidn, oidn->file(), {}};
    } catch (const Error& e) {
        if (search.choice == DenoiserChoice::oidn)
            throw Error(ErrorKind::usage, OptionName{"denoiser"}, std::string("oidn: ") + e.what());
        return {nullptr, {}, e.what(), !file.empty()};
    }
}

}  // namespace covtrace
