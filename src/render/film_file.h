/// Film files: a render's whole state on disk. docs/reference/film-format.md describes every byte.
#pragma once

#include <filesystem>
#include <istream>
#include <string>

#include "render/render_state.h"

namespace covtrace {

/// The name under which write_film keeps the older film beside the newer one; where `file` is a
/// symbolic link, beside the file that it leads to.
std::filesystem::path earlier_film(const std::filesystem::path& file);

/// Writes the film beside `file` and renames it (OutputFile): at any moment `file` is the older or
/// the newer film, and whole; where the file system has no hard links it may be missing for a
/// moment, and earlier_film(file) is there. The older film lives on as earlier_film(file). Blocks
/// are compressed in parallel; the bytes do not depend on the number of threads. Throws Error(io).
void write_film(const RenderState& state, const std::filesystem::path& file);

/// Whether a file begins as a film does; false where it can't be read.
bool is_film(const std::filesystem::path& file);

/// Error(scene) for a film that is whole, but that another version of the program wrote. The
/// message says which one, and what this one reads.
class FilmOfOtherVersion : public Error {
  public:
    explicit FilmOfOtherVersion(const std::string& message) : Error(ErrorKind::scene, message) {}
};

/// Reads a film. Throws Error(scene), whose message begins with the file's name, for a file that is
/// no film or is damaged, FilmOfOtherVersion, and Error(limit) for a film that this machine's
/// memory can't hold. Whatever the file says, nothing is allocated before its length makes it
/// plausible.
RenderState read_film(const std::filesystem::path& file);

/// Reads a film from `size` bytes of a stream, called `name` in messages. Throws as read_film(file)
/// does.
RenderState read_film(std::istream& in, uint64_t size, const std::string& name);

/// The film that find_film found.
struct FoundFilm {
    std::optional<RenderState> state;  ///< none where there is no film
    std::string damage;  ///< why the earlier film had to do; empty: the film itself was read
};

/// Finds the film of a render that goes on: `file`, or the earlier film where `file` is damaged or
/// missing. Throws as read_film does where there is no earlier film to take, and
/// FilmOfOtherVersion for `file` in any case.
FoundFilm find_film(const std::filesystem::path& file);

/// Moves a damaged film out of the way, so that the next film that is written does not take the
/// place of the good earlier one. Returns its new name. Throws Error(io).
std::filesystem::path set_aside(const std::filesystem::path& file);

/// Removes the leftovers beside `file` of processes of this machine that were killed while they
/// wrote it.
void remove_leftovers(const std::filesystem::path& file);

}  // namespace covtrace
