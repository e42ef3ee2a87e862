/// The workshop of the experiments: scenes, renders whose time is taken, and the folder of results.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/session.h"
#include "reproduce/scene_source.h"
#include "reproduce/settings.h"

namespace covtrace::reproduce {

/// User and system seconds of all threads of this process so far.
double cpu_seconds();

struct Timed {
    RenderResult result;
    double cpu = 0, wall = 0;  ///< seconds, the scene being loaded already
    std::string command;       ///< command that renders the same image
};

/// A scene at one resolution, loaded once.
struct LoadedScene {
    std::string name;
    fs::path file;
    std::array<int, 2> resolution;
    std::unique_ptr<RenderScene> scene;
    double load_cpu = 0;  ///< seconds to read and build the scene
};

class Workshop {
  public:
    using Say = std::function<void(const std::string&)>;

    /// Makes a workshop. `output` is an existing folder. `interrupted` ends the render that is
    /// running and all that follow once it is true, whoever sets it.
    Workshop(Size size, fs::path output, const fs::path& scenes,
             const std::atomic<bool>& interrupted, Say say);

    const Size size;
    const Settings& settings;
    const fs::path output;
    SceneSource scenes;

    /// Tells in one line what is being done.
    void tell(const std::string& line) const { say_(line); }

    /// Loads a scene; with a shutter in place of its own where one is given.
    LoadedScene load(const std::string& name, const fs::path& file, std::array<int, 2> resolution,
                     std::optional<std::array<float, 2>> shutter = std::nullopt);
    /// Renders a scene. Throws Error(interrupted) once the workshop is interrupted. `watcher` is
    /// called as Monitor's.
    Timed render(LoadedScene& scene, const RenderOptions& options,
                 std::function<void(Monitor&, Image)> watcher = {});

    /// Seconds of rendering so far, scene loading included.
    double cpu() const { return cpu_seconds() - start_; }

    /// An object that experiments share: made by `make` at the first call with this key.
    template <typename T>
    T& shared(const std::string& key, const std::function<T()>& make) {
        auto& entry = shared_[key];
        if (!entry) entry = std::make_shared<T>(make());
        return *std::static_pointer_cast<T>(entry);
    }

  private:
    const Say say_;
    const double start_;
    const std::atomic<bool>& interrupted_;
    std::map<std::string, std::shared_ptr<void>> shared_;
};

/// The command that runs one experiment again into the same folder.
std::string reproduce_command(const Workshop& workshop, const std::string& experiment);

/// The command `covtrace render …` with all options that are not the defaults.
std::string render_command(const LoadedScene& scene, const RenderOptions& options);

}  // namespace covtrace::reproduce
