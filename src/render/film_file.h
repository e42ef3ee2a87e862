/// Film files: a render's whole state on disk. docs/reference/film-format.md describes every byte.
#pragma once

#include <filesystem>
#include <istream>
#include <string>

#include "render/render_state.h"

namespace covtrace {

/// The name that an older film of the same name keeps beside a newer one; beside the file that a
/// symbolic link leads to.
std::filesystem::path earlier_film(const std::filesystem::path& file);

/// Writes beside and renames (OutputFile): at any moment `file` is the older or the newer film, and
/// whole; where the file system has no hard links it may be missing for a moment, and
/// earlier_film(file) is there. The older one lives on as earlier_film(file). Blocks are compressed
/// in parallel; the bytes do not depend on the number of threads. Throws Error(io).
void write_film(const RenderState& state, const std::filesystem::path& file);

/// Whether a file begins as a film does. False where it can't be read.
bool is_film(const std::filesystem::path& file);

/// Error(scene) for a film that is whole, but that another version of the program wrote. The
/// message says which one, and what this one reads.
class FilmOfOtherVersion : public Error {
  public:
    explicit FilmOfOtherVersion(const std::string& message) : Error(ErrorKind::scene, message) {}
};

/// Throws Error(scene), whose message begins with the file's name, for what is no film or is
/// damaged, FilmOfOtherVersion, Error(limit) for one that this machine's memory can't hold.
/// Whatever the file says, nothing is allocated before its length makes it plausible.
RenderState read_film(const std::filesystem::path& file);

/// The same from `size` bytes of a stream; `name`: for messages.
RenderState read_film(std::istream& in, uint64_t size, const std::string& name);

/// The film, or the earlier one where it is damaged or missing: `damage` then says why. None where
/// there is neither. Throws FilmOfOtherVersion.
struct FoundFilm {
    std::optional<RenderState> state;
    std::string damage;  ///< empty: the film itself was read
};
FoundFilm find_film(const std::filesystem::path& file);

/// Moves a damaged film out of the way, so that the next one that is written does not take the
/// place of the good earlier one. Returns its new name. Throws Error(io).
std::filesystem::path set_aside(const std::filesystem::path& file);

/// Removes what processes of this machine that were killed while they wrote `file` have left beside
/// it.
void remove_leftovers(const std::filesystem::path& file);

}  // namespace covtrace
