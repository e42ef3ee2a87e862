/// The errors of the standard library, as a reader of scenes tells them.
#pragma once

#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>

#include "core/error.h"

namespace covtrace {

/// Returns what `read` returns. Throws Error(limit) where the library has no memory or a container
/// would be too large, Error(scene) where a folder or link can't be followed, each as `name: …`.
template <typename Read>
auto with_limits(const std::string& name, const Read& read) {
    try {
        return read();
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::limit, name + ": not enough memory to read the scene");
    } catch (const std::length_error&) {
        throw Error(ErrorKind::limit, name + ": the scene is too large to read");
    } catch (const std::filesystem::filesystem_error& e) {
        throw Error(ErrorKind::scene, name + ": " + e.what());
    }
}

}  // namespace covtrace
