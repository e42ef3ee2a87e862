#include "reproduce/scene_source.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <vector>

#include "core/error.h"
#include "image/output_file.h"

namespace covtrace::reproduce {

namespace {

/// Runs a program with its output in a file. Returns its exit code; -1 where it could not be
/// started or was ended by a signal.
int run(std::vector<std::string> words, const fs::path& log) {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0666);
    posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
    pid_t child = 0;
    const int failed =
        posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed != 0) return -1;
    int status = 0;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR) return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string last_line(const fs::path& file) {
    std::ifstream in(file);
    std::string line, last;
    while (std::getline(in, line))
        if (!line.empty()) last = line;
    return last;
}

void make_folder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error)
        throw Error(ErrorKind::io,
                    "cannot make the folder '" + folder.string() + "': " + error.message());
}

/// Path of scenes/generate.py: beside the installed program (../share/covtrace/scenes), else in the
/// source that it was built from; empty where neither is there.
fs::path find_generator() {
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    for (const fs::path& file :
         {program.parent_path().parent_path() / COVTRACE_INSTALLED_SCENES / "generate.py",
          fs::path(COVTRACE_SOURCE_SCENES) / "generate.py"})
        if (fs::is_regular_file(file, error)) return file;
    return {};
}

}  // namespace

SceneSource::SceneSource(fs::path given, fs::path made_in)
    : given_(std::move(given)), made_in_(std::move(made_in)) {}

fs::path SceneSource::generated(const std::string& name) {
    std::error_code error;
    if (!given_.empty()) {
        const fs::path file = given_ / name / "scene.pbrt";
        if (!fs::is_regular_file(file, error))
            throw Error(ErrorKind::scene, file.string() +
                                              ": no such file; expected the folder of --scenes to "
                                              "be as 'scenes/generate.py --output DIR' writes it");
        return file;
    }
    const fs::path file = made_in_ / name / "scene.pbrt";
    if (made_.contains(name)) return file;
    const fs::path generator = find_generator();
    if (generator.empty())
        throw Error(ErrorKind::scene,
                    "the generator of the scenes is neither beside the program "
                    "(" COVTRACE_INSTALLED_SCENES
                    ") nor in the source that it was built from "
                    "(" COVTRACE_SOURCE_SCENES "); expected --scenes DIR with generated scenes");
    make_folder(made_in_);
    const fs::path log = made_in_ / (name + ".log");
    const int code = run({"python3", generator.string(), "--output", made_in_.string(), name}, log);
    const std::string reason = last_line(log);
    fs::remove(log, error);
    if (code != 0 || !fs::is_regular_file(file, error))
        throw Error(ErrorKind::scene,
                    "the scene '" + name + "' could not be made by 'python3 " + generator.string() +
                        "': " + (code < 0 ? "it could not be run; Python 3 is needed" : reason));
    made_.insert(name);
    return file;
}

fs::path SceneSource::written(const std::string& name, const std::string& text,
                              const std::map<std::string, std::string>& beside) {
    make_folder(made_in_ / name);
    for (const auto& [file_name, bytes] : beside) {
        OutputFile other(made_in_ / name / file_name);
        other.write(bytes.data(), bytes.size());
        other.commit();
    }
    OutputFile file(made_in_ / name / "scene.pbrt");
    file.write(text.data(), text.size());
    file.commit();
    return file.target();
}

}  // namespace covtrace::reproduce
