#include "cli/mpi_module.h"

#include <dlfcn.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "core/error.h"

namespace covtrace::cli {

namespace {

/// Beside the program, or where it is installed.
void* open_module() {
    namespace fs = std::filesystem;
    std::error_code ignored;
    const fs::path folder = fs::read_symlink("/proc/self/exe", ignored).parent_path();
    for (const fs::path& file :
         {folder / "covtrace_mpi.so", folder / "../lib/covtrace/modules/covtrace_mpi.so"})
        // MPI looks for its own parts among the symbols of all.
        if (fs::exists(file, ignored))
            if (void* module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_GLOBAL)) return module;
    return nullptr;
}

}  // namespace

std::unique_ptr<Ranks> join_ranks() {
    const char* size = std::getenv("OMPI_COMM_WORLD_SIZE");
    if (!size || std::atoi(size) < 2) return nullptr;
    void* module = open_module();
    if (!module)
        throw Error(ErrorKind::usage,
                    "started by mpirun, but without the module covtrace_mpi.so beside the program: "
                    "it is built where MPI is found");
    const auto join = reinterpret_cast<Ranks* (*)()>(::dlsym(module, "covtrace_join_ranks"));
    return std::unique_ptr<Ranks>(join());
}

}  // namespace covtrace::cli
