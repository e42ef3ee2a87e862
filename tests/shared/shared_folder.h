// Test data that is not part of the project: scenes, references, damaged files. The tests in this
// folder are built only where CMake finds it (COVTRACE_SHARED, default: the folder `shared` beside
// the project).
#pragma once

#include <filesystem>

namespace covtrace::test {

inline std::filesystem::path shared_folder() {
    return COVTRACE_SHARED_FOLDER;
}

}  // namespace covtrace::test
