/// Support for the tests of the scene reader.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "pbrt/read_scene.h"

namespace covtrace::test {

/// Reads text that starts in the world; its first line is line 2.
inline SceneDescription read_world(const std::string& text) {
    return read_pbrt_string("WorldBegin\n" + text, "test.pbrt");
}
/// Reads text that stands before WorldBegin.
inline SceneDescription read_options(const std::string& text) {
    return read_pbrt_string(text + "\nWorldBegin\n", "test.pbrt");
}

/// The message and kind of the error that reading throws; fails where it doesn't.
struct Failure {
    ErrorKind kind{};
    std::string message;
};
template <typename Read>
Failure failure_of(Read read) {
    try {
        read();
    } catch (const Error& e) {
        return {e.kind(), e.what()};
    }
    ADD_FAILURE() << "expected an error";
    return {};
}
inline std::string world_error(const std::string& text) {
    const Failure f = failure_of([&] { read_world(text); });
    EXPECT_EQ(f.kind, ErrorKind::scene) << f.message;
    return f.message;
}
inline std::string options_error(const std::string& text) {
    const Failure f = failure_of([&] { read_options(text); });
    EXPECT_EQ(f.kind, ErrorKind::scene) << f.message;
    return f.message;
}

/// All warnings, one per line, as "line: text".
inline std::string warnings_of(const SceneDescription& scene) {
    std::string all;
    for (const Warning& w : scene.warnings)
        all += std::to_string(w.where.line) + ": " + w.text + "\n";
    return all;
}

inline ::testing::AssertionResult contains(const std::string& text, const std::string& part) {
    if (text.find(part) != std::string::npos) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "\"" << part << "\" is not in \"" << text << "\"";
}

/// A folder that is gone at the end of the test.
class TemporaryFolder {
  public:
    explicit TemporaryFolder(const std::string& suffix = {}) {
        const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
        path_ = std::filesystem::path(::testing::TempDir()) /
                (std::string("covtrace_") + info->test_suite_name() + "_" + info->name() + suffix);
        std::filesystem::remove_all(path_);
        std::filesystem::create_directories(path_);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path write(const std::string& name, const std::string& content) const {
        const std::filesystem::path file = path_ / name;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file, std::ios::binary) << content;
        return file;
    }

  private:
    std::filesystem::path path_;
};

template <typename T>
const T& constant_as(const SceneDescription& scene, TextureId id) {
    return std::get<T>(scene.textures.at(static_cast<size_t>(id)).value);
}
inline Rgb constant_value(const SceneDescription& scene, TextureId id) {
    return constant_as<ConstantTexture>(scene, id).value;
}
inline void expect_near(Rgb a, Rgb b, float tolerance) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << "channel " << c;
}
inline void expect_near(Vec3 a, Vec3 b, float tolerance) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << "axis " << c;
}

/// A scene with one material, and that material.
struct Made {
    SceneDescription scene;
    MaterialDescription material;
};
inline Made material_of(const std::string& text) {
    Made m{read_world("Material " + text + "\nShape \"sphere\""), {}};
    m.material = m.scene.materials.at(static_cast<size_t>(m.scene.shapes.at(0).material));
    return m;
}
template <typename Model>
Model model_of(const std::string& text) {
    return std::get<Model>(material_of(text).material.value);
}

}  // namespace covtrace::test
