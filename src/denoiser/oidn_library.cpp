#include "denoiser/oidn_library.h"

#include <dlfcn.h>

#include <algorithm>
#include <string>
#include <system_error>
#include <vector>

#include "core/error.h"
#include "denoiser/whole_library.h"

namespace covtrace::oidn {

namespace {

namespace fs = std::filesystem;

constexpr int kPrivate = RTLD_NOW | RTLD_LOCAL;

/// Paths of the library's other parts in the folder of `file`, in the order of their names.
std::vector<fs::path> parts_beside(const fs::path& file) {
    std::vector<fs::path> parts;
    std::error_code error;
    for (fs::directory_iterator it(file.parent_path(), error), end; !error && it != end;
         it.increment(error)) {
        const std::string name = it->path().filename().string();
        if (name.starts_with("libOpenImageDenoise") && name.find(".so") != std::string::npos &&
            it->path() != file)
            parts.push_back(it->path());
    }
    std::sort(parts.begin(), parts.end());
    return parts;
}

void* load(const fs::path& file) {
    const bool is_path = file.has_parent_path();
    if (is_path) {
        if (!fs::is_regular_file(file))
            throw Error(ErrorKind::usage, file.string() + ": is no file");
        require_whole(file);
        for (const fs::path& part : parts_beside(file)) require_whole(part);
    }
    if (void* library = ::dlopen(file.c_str(), kPrivate)) return library;
    std::string why = ::dlerror();
    // Load the core first and try again: builds look for their core in a folder `lib`, but find one
    // that is loaded already
    if (is_path)
        for (const fs::path& part : parts_beside(file))
            if (part.filename().string().find("_core.so") != std::string::npos)
                if (::dlopen(part.c_str(), kPrivate))
                    if (void* library = ::dlopen(file.c_str(), kPrivate)) return library;
    throw Error(ErrorKind::usage, why);
}

template <typename Function>
void find(void* library, const fs::path& file, const char* name, Function& function) {
    void* symbol = ::dlsym(library, name);
    if (!symbol)
        throw Error(ErrorKind::usage, file.string() + ": has no function " + name +
                                          "; expected Open Image Denoise 2");
    function = reinterpret_cast<Function>(symbol);
}

Api functions_of(void* library, const fs::path& file) {
    Api api{};
    find(library, file, "oidnNewDevice", api.new_device);
    find(library, file, "oidnReleaseDevice", api.release_device);
    find(library, file, "oidnSetDeviceBool", api.set_device_bool);
    find(library, file, "oidnSetDeviceInt", api.set_device_int);
    find(library, file, "oidnGetDeviceInt", api.get_device_int);
    find(library, file, "oidnCommitDevice", api.commit_device);
    find(library, file, "oidnGetDeviceError", api.get_device_error);
    find(library, file, "oidnNewFilter", api.new_filter);
    find(library, file, "oidnReleaseFilter", api.release_filter);
    find(library, file, "oidnSetSharedFilterImage", api.set_image);
    find(library, file, "oidnSetFilterBool", api.set_filter_bool);
    find(library, file, "oidnSetFilterInt", api.set_filter_int);
    find(library, file, "oidnCommitFilter", api.commit_filter);
    find(library, file, "oidnExecuteFilter", api.execute_filter);
    return api;
}

fs::path place_of(const void* symbol, const fs::path& otherwise) {
    Dl_info info{};
    return ::dladdr(symbol, &info) && info.dli_fname ? info.dli_fname : otherwise;
}

}  // namespace

Library load_library(const fs::path& file) {
    const Api api = functions_of(load(file), file);
    return {api, place_of(reinterpret_cast<const void*>(api.new_device), file)};
}

}  // namespace covtrace::oidn
