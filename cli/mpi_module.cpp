#include "cli/mpi_module.h"

#include <dlfcn.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "core/error.h"

namespace covtrace::cli {

namespace {

using Join = Ranks* (*)();

/// Loads the function from the module, beside the program or where it is installed.
Join load_join() {
    namespace fs = std::filesystem;
    std::error_code ignored;
    const fs::path folder = fs::read_symlink("/proc/self/exe", ignored).parent_path();
    for (const fs::path& file :
         {folder / "covtrace_mpi.so", folder / "../lib/covtrace/modules/covtrace_mpi.so"}) {
        if (!fs::exists(file, ignored)) continue;
        // Symbols are made known to all, among which MPI looks for its own parts.
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
    const char* size = std::getenv("OMPI_COMM_WORLD_SIZE");
    if (!size || std::atoi(size) < 2) return nullptr;
    return std::unique_ptr<Ranks>(load_join()());
}

}  // namespace covtrace::cli
