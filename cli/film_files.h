/// The film files of one render: read before it, written while it runs and when it ends.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>

#include "cli/film_options.h"
#include "core/error.h"
#include "render/keeping.h"

namespace covtrace::cli {

/// Reads and writes the films of a render. A render does not end because its film can't be kept:
/// the image may still become one. Failures are told at once, and again by finish().
class FilmFiles {
  public:
    /// Begins with no film. `clear_line` is called before anything is said.
    FilmFiles(const FilmArguments& arguments, std::function<void()> clear_line);

    /// Reads the film to go on from, if it is asked for and there is one, and says where the render
    /// stands. Throws as read_film does. With `writes` the returned `keep` writes the files; it is
    /// valid while this object lives.
    FilmKeeping keeping(bool writes);

    /// Throws the error of a file whose last writing failed.
    void finish() const;

  private:
    void keep(const RenderState& state, KeepReason reason);
    void write(const RenderState& state, const std::filesystem::path& file);
    /// The film in a file, or the earlier one; null where there is none. `writes`: this process
    /// writes the file, and sets it aside where it is damaged.
    std::shared_ptr<const RenderState> found(const std::filesystem::path& file, bool writes) const;

    const FilmArguments& arguments_;
    std::function<void()> clear_line_;
    std::optional<Error> failure_;
    std::set<std::filesystem::path> failing_;  ///< whose last writing failed, as was told
};

}  // namespace covtrace::cli
