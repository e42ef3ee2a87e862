/// The film files of one render: read before it, written while it runs and when it ends.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "core/error.h"
#include "render/keeping.h"

namespace covtrace {

/// The films of a render as people choose them.
struct FilmChoice {
    std::string film;             ///< file of the final film; empty: none
    std::string checkpoint;       ///< file of the film that is kept now and then; empty: none
    std::optional<double> every;  ///< seconds between checkpoints
    std::optional<Shard> shard;
    bool resume = false;
};

/// Reads and writes the films of a render. A render does not end because its film can't be kept:
/// the image may still become one. Failures are told at once, and again by finish().
class FilmFiles {
  public:
    /// Begins with no film. `tell` is called with what people should know at once; `choice`
    /// must outlive this object.
    FilmFiles(const FilmChoice& choice, std::function<void(const std::string&)> tell);

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

    const FilmChoice& choice_;
    std::function<void(const std::string&)> tell_;
    std::optional<Error> failure_;
    std::set<std::filesystem::path> failing_;  ///< whose last writing failed, as was told
};

}  // namespace covtrace
