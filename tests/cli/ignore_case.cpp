// Preloaded into the program by test_taken_names.py: a file system that takes the names of files in
// folders called "folding" for one whatever their capitals, as FAT and APFS do.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cctype>
#include <cstdarg>
#include <string>

namespace {

template <typename Function>
Function next(const char* name) {
    return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

std::string folded(const char* path) {
    std::string name = path;
    const size_t folder = name.find("folding/");
    if (folder == std::string::npos) return name;
    for (size_t i = folder; i < name.size(); ++i)
        name[i] = static_cast<char>(std::tolower(static_cast<unsigned char>(name[i])));
    return name;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
    va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = va_arg(arguments, mode_t);
    va_end(arguments);
    return next<int (*)(const char*, int, ...)>("open")(folded(path).c_str(), flags, mode);
}

int stat(const char* path, struct stat* status) {
    return next<int (*)(const char*, struct stat*)>("stat")(folded(path).c_str(), status);
}

int lstat(const char* path, struct stat* status) {
    return next<int (*)(const char*, struct stat*)>("lstat")(folded(path).c_str(), status);
}

int unlink(const char* path) {
    return next<int (*)(const char*)>("unlink")(folded(path).c_str());
}

int rename(const char* from, const char* to) {
    return next<int (*)(const char*, const char*)>("rename")(folded(from).c_str(),
                                                             folded(to).c_str());
}

}  // extern "C"
