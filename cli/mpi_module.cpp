#include "cli/mpi_module.h"

#include <dlfcn.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "core/error.h"

namespace covtrace::cli {

namespace {

/// The type of `covtrace_join_ranks` (src/ranks/mpi_ranks.cpp); the caller owns the result.
using Join = Ranks* (*)();

/// Loads `covtrace_join_ranks` from the module covtrace_mpi.so, which is beside the program in a
/// build and in lib/covtrace/modules where it is installed. Throws Error(usage) where it is in
/// neither place or does not load.
Join load_join() {
    namespace fs = std::filesystem;
    std::error_code ignored;
    const fs::path folder = fs::read_symlink("/proc/self/exe", ignored).parent_path();
    for (const fs::path& file :
         {folder / "covtrace_mpi.so", folder / "../lib/covtrace/modules/covtrace_mpi.so"}) {
        if (!fs::exists(file, ignored)) continue;
        // Open MPI loads plug-ins that look for its own symbols: RTLD_GLOBAL lets them find these.
        void* module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_GLOBAL);
        void* join = module ? ::dlsym(module, "covtrace_join_ranks") : nullptr;
        if (join) return reinterpret_cast<Join>(join);
        const char* why = ::dlerror();
        throw Error(ErrorKind::usage, "started by mpirun, but the module '" + file.string() +
                                          "' cannot be used: " + (why ? why : "unknown"));
    }
    throw Error(ErrorKind::usage,
                "started by mpirun, but without the module covtrace_mpi.so beside the program: it "
                "is built where MPI is found");
}

}  // namespace

std::unique_ptr<Ranks> join_ranks() {
    // Open MPI's mpirun sets this variable; launchers of other MPI libraries go unnoticed.
    const char* size = std::getenv("OMPI_COMM_WORLD_SIZE");
    if (!size || std::atoi(size) < 2) return nullptr;
    return std::unique_ptr<Ranks>(load_join()());
}

}  // namespace covtrace::cli
