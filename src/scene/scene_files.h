/// The files that a scene names: finding them, reading them whole, and a hash of everything read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"

namespace covtrace {

class WarningLog;

class SceneFiles {
  public:
    /// Starts without files. `folder` is the main scene's, which relative names refer to (also
    /// those in included files, as in pbrt).
    SceneFiles(std::filesystem::path folder, std::vector<std::filesystem::path> search_paths,
               WarningLog& log)
        : folder_(std::move(folder)), search_paths_(std::move(search_paths)), log_(log) {}

    /// Finds an existing regular file: in the scene's folder, the search paths, the working folder,
    /// then once more with backslashes as slashes and without regard to upper and lower case (with
    /// a warning). Names that lead out of the scene's folder are warned of, unless a search path
    /// holds the file. Errors: Error(scene) with the places looked at, or for a folder, a pipe or a
    /// device of that name.
    std::filesystem::path find(const std::string& name, const SourceLocation& where);
    /// Finds a file as `find` does; empty where there is no such file.
    std::optional<std::filesystem::path> find_optional(const std::string& name,
                                                       const SourceLocation& where);

    /// Reads a whole file, decompressed where its name ends in ".gz"; counts in the hash. Errors:
    /// those of read_whole_file; Error(limit) where files that are read again and again add up to
    /// more than any scene needs.
    std::string read(const std::filesystem::path& file, const SourceLocation& where);

    void add_to_hash(uint64_t hash_of_a_file);
    uint64_t content_hash() const { return hash_; }
    /// All files that were found or read, each once, in the order of their names.
    std::vector<std::filesystem::path> files() const { return {files_.begin(), files_.end()}; }

  private:
    /// The folders that names refer to, in the order in which they are looked at.
    std::vector<std::filesystem::path> roots() const;
    /// Notes a file that was found, with the warning of its place.
    std::filesystem::path found(const std::string& name, const std::filesystem::path& file,
                                const SourceLocation& where);
    /// Warns of names that lead out of the scene's folder and of the search paths.
    void warn_outside(const std::string& name, const std::filesystem::path& file,
                      const SourceLocation& where);

    std::filesystem::path folder_;
    std::vector<std::filesystem::path> search_paths_;
    WarningLog& log_;
    uint64_t hash_ = 0;
    std::set<std::filesystem::path> read_, files_;
    uint64_t read_again_ = 0;  ///< bytes of files that were read before
};

/// Throws Error(scene) for a folder, a pipe, a device: reading those would fail or never end.
void require_regular(const std::filesystem::path& file, const SourceLocation& where);

/// The bytes of a file, decompressed where its name ends in ".gz". Thread-safe. Errors:
/// Error(scene) where it can't be opened or decompressed, Error(io) where reading fails in the
/// middle, Error(limit) for compressed files that grow beyond measure.
std::string read_whole_file(const std::filesystem::path& file, const SourceLocation& where);

uint64_t hash_of(std::string_view bytes);

}  // namespace covtrace
