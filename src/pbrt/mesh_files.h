/// The mesh files of a scene: noted while the scene is read, then read together, in parallel.
#pragma once

#include <filesystem>
#include <map>
#include <vector>

#include "pbrt/ply_reader.h"
#include "scene/scene_files.h"

namespace covtrace {

class MeshFiles {
  public:
    /// The number of a file, the same for the same file. `directive` orders its warnings.
    size_t add(const std::filesystem::path& file, const SourceLocation& where, int directive);

    /// Reads all files; their hashes and warnings count in the order of the numbers. Errors: those
    /// of read_whole_file and read_ply; if several files have errors, that of the first.
    void read_all(SceneFiles& files, WarningLog& log);

    /// The mesh of a file, after read_all.
    const PlyMesh& operator[](size_t number) const { return entries_[number].mesh; }

  private:
    struct Entry {
        std::filesystem::path file;
        SourceLocation where;
        int directive = 0;
        PlyMesh mesh;
    };
    std::vector<Entry> entries_;
    std::map<std::filesystem::path, size_t> numbers_;
};

}  // namespace covtrace
