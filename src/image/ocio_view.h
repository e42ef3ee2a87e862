/// Views of OpenColorIO configs: how studios and other programs say what a display shall show.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/vec.h"

namespace covtrace {

/// A choice among what a config has, by the names in it. Empty names are the config's own choice.
struct OcioChoice {
    std::filesystem::path config = {};
    std::string display = {};
    std::string view = {};    ///< of the display
    std::string look = {};    ///< in place of the view's own; several as the library reads them
    std::string source = {};  ///< the colour space, or role, that colours are said to be in
};

/// A display and a view of a config, ready for use. Nothing but the config says what they are: the
/// variable OCIO is not read.
///
/// Colours are linear Rec.709. Where the config has the role aces_interchange, which ties its
/// spaces to ACES2065-1, they are converted to the space of its role scene_linear; else they are
/// said to be in that space. `OcioChoice::source` says so of another one.
class OcioView {
  public:
    /// Throws Error(scene), with the line where one is known, where the config or a file that it
    /// names cannot be read or is no such; Error(usage) for a name that it does not have, with
    /// those that it has.
    explicit OcioView(const OcioChoice& choice);
    ~OcioView();
    OcioView(const OcioView&) = delete;
    OcioView& operator=(const OcioView&) = delete;

    /// The display's values of a colour without negative components, encoded, in [0, 1] where they
    /// are in the display's range. Any number of threads may call it.
    Rgb shown(Rgb linear) const;
    /// Parts of the config that the library did not understand.
    const Warnings& warnings() const { return warnings_; }
    /// The files that were read: the config, and its tables for this display and view.
    const std::vector<std::filesystem::path>& files() const { return files_; }

  private:
    struct Processor;
    Warnings warnings_;
    std::vector<std::filesystem::path> files_;
    std::unique_ptr<const Processor> processor_;
};

}  // namespace covtrace
