// The promise that every reader of images keeps: an image or one Error(scene) of one line, and
// nothing printed.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <string>

#include "core/error.h"
#include "image/image.h"
#include "image/raster.h"

namespace covtrace::test {

namespace fs = std::filesystem;

/// Sends everything that the process prints into a file while it lives.
class PrintCounter {
  public:
    explicit PrintCounter(const fs::path& file) : file_(file) {
        std::fflush(nullptr);
        const int to = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        for (int i : {0, 1}) {
            saved_[i] = ::dup(i + 1);
            ::dup2(to, i + 1);
        }
        ::close(to);
    }
    ~PrintCounter() {
        std::fflush(nullptr);
        for (int i : {0, 1}) {
            ::dup2(saved_[i], i + 1);
            ::close(saved_[i]);
        }
    }
    uintmax_t bytes() const {
        std::fflush(nullptr);
        return fs::file_size(file_);
    }

  private:
    fs::path file_;
    int saved_[2]{};
};

/// The problem of a reader; empty where reading ended as it may.
template <class Reader>
inline std::string problem_of_reading(const fs::path& file, Reader read) {
    try {
        read(file);
    } catch (const Error& e) {
        const std::string text = e.what();
        if (e.kind() != ErrorKind::scene) return "wrong kind of error: " + text;
        if (text.find('\n') != std::string::npos) return "several lines: " + text;
        const std::string named = "'" + file.string() + "': ";
        const size_t at = text.find(named);
        if (at == std::string::npos) return "the file is not named: " + text;
        if (at + named.size() == text.size()) return "no reason: " + text;
    } catch (const std::exception& e) {
        return std::string("an exception of another type: ") + e.what();
    }
    return {};
}

inline std::string problem_of(const fs::path& file) {
    const std::string problem = problem_of_reading(file, [](const fs::path& f) { read_image(f); });
    if (!problem.empty()) return problem;
    return problem_of_reading(file, [](const fs::path& f) { read_raster(f); });
}

}  // namespace covtrace::test
