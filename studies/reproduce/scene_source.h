/// The source of the experiments' scenes.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>

namespace covtrace::reproduce {

namespace fs = std::filesystem;

/// Scenes by name, as folders with a scene.pbrt.
class SceneSource {
  public:
    /// Scenes are taken from `given`, a folder that holds the generated ones already; where it is
    /// empty, they are made in `made_in` by the generator, which comes with the source and is
    /// installed with the program.
    SceneSource(fs::path given, fs::path made_in);

    /// A generated scene, made once per run, or found in the given folder. Throws Error(scene)
    /// where it is not there or the generator fails.
    fs::path generated(const std::string& name);
    /// A scene of the given text, written to a file, with the files beside it, bytes by name.
    /// Throws Error(io).
    fs::path written(const std::string& name, const std::string& text,
                     const std::map<std::string, std::string>& beside = {});

  private:
    fs::path given_, made_in_;
    std::set<std::string> made_;
};

}  // namespace covtrace::reproduce
