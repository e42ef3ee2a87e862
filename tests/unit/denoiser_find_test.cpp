#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "core/parallel.h"
#include "denoiser/find_denoiser.h"

namespace covtrace {
namespace {

namespace fs = std::filesystem;

const fs::path kFakes = COVTRACE_FAKE_DENOISERS;

fs::path fake(const char* name) {
    return kFakes / name / "libOpenImageDenoise.so.2";
}

class FindDenoiser : public testing::Test {
  protected:
    void SetUp() override {
        ::unsetenv("COVTRACE_OIDN_LIBRARY");
        ::unsetenv("FAKE_OIDN_THREADS");
        const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::path(testing::TempDir()) / (std::string("covtrace-denoiser-") + test->name());
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    void TearDown() override {
        fs::remove_all(folder_);
        ::unsetenv("COVTRACE_OIDN_LIBRARY");
        ::unsetenv("FAKE_OIDN_THREADS");
    }
    /// The defect of the library, told as a warning and as an error alike.
    static std::string defect(const fs::path& library) {
        const FoundDenoiser found = find_denoiser({DenoiserChoice::automatic, library, {}});
        EXPECT_EQ(found.denoiser, nullptr) << library;
        EXPECT_TRUE(found.is_unusable) << library;
        try {
            find_denoiser({DenoiserChoice::oidn, library, {}});
            ADD_FAILURE() << library << ": no error";
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), ErrorKind::usage);
            EXPECT_EQ(e.what(), "denoiser: oidn: " + found.why_none);
        }
        return found.why_none;
    }
    fs::path folder_;
};

TEST_F(FindDenoiser, AGoodOne) {
    for (auto choice : {DenoiserChoice::automatic, DenoiserChoice::oidn}) {
        const FoundDenoiser found = find_denoiser({choice, fake("good"), {}});
        ASSERT_NE(found.denoiser, nullptr) << found.why_none;
        EXPECT_EQ(found.denoiser->name(), "Open Image Denoise 2.3.99");
        EXPECT_TRUE(fs::equivalent(found.library, fake("good")));
        EXPECT_FALSE(found.is_unusable);
    }
}

TEST_F(FindDenoiser, NoneIsNotLookedFor) {
    ::setenv("COVTRACE_OIDN_LIBRARY", "/damaged", 1);
    const FoundDenoiser found = find_denoiser({DenoiserChoice::none, fake("version-one"), {}});
    EXPECT_EQ(found.denoiser, nullptr);
    EXPECT_FALSE(found.is_unusable);
}

TEST_F(FindDenoiser, FileThenEnvironmentThenFoldersInOrder) {
    const DenoiserSearch folders{
        DenoiserChoice::automatic, {}, {folder_, kFakes / "good", kFakes / "version-one"}};
    EXPECT_NE(find_denoiser(folders).denoiser, nullptr);
    ::setenv("COVTRACE_OIDN_LIBRARY", "", 1);  // as good as none
    EXPECT_NE(find_denoiser(folders).denoiser, nullptr);
    ::setenv("COVTRACE_OIDN_LIBRARY", fake("commit-fails").c_str(), 1);
    EXPECT_NE(find_denoiser(folders).why_none.find("out of order"), std::string::npos);
    DenoiserSearch named = folders;
    named.library = fake("good");
    EXPECT_NE(find_denoiser(named).denoiser, nullptr);
}

TEST_F(FindDenoiser, NothingFoundIsNoWarningButAnError) {
    const FoundDenoiser found = find_denoiser({DenoiserChoice::automatic, {}, {folder_}});
    if (found.denoiser) GTEST_SKIP() << "the system has one: " << found.library;
    EXPECT_FALSE(found.is_unusable);
    EXPECT_NE(found.why_none.find("'" + folder_.string() + "'"), std::string::npos);
    EXPECT_THROW(find_denoiser({DenoiserChoice::oidn, {}, {folder_}}), Error);
}

TEST_F(FindDenoiser, WhatIsWrongIsTold) {
    EXPECT_NE(defect(fake("version-one")).find("is version 1.4.3"), std::string::npos);
    EXPECT_NE(defect(fake("lacks-a-function")).find("oidnCommitFilter"), std::string::npos);
    EXPECT_NE(defect(fake("no-device")).find("no CPU"), std::string::npos);
    EXPECT_NE(defect(fake("commit-fails")).find("the device is out of order"), std::string::npos);
    EXPECT_NE(defect(folder_).find("is no file"), std::string::npos);
    EXPECT_NE(defect(folder_ / "missing.so").find("is no file"), std::string::npos);
}

TEST_F(FindDenoiser, DamagedFiles) {
    const fs::path text = folder_ / "libOpenImageDenoise.so.2", cut = folder_ / "cut.so";
    std::ofstream(text) << "no library at all\n";
    EXPECT_NE(defect(text).find(text.string()), std::string::npos);
    std::ofstream(text).close();
    EXPECT_NE(defect(text).find(text.string()), std::string::npos);
    const auto size = fs::file_size(fake("good"));
    for (auto left : {size / 8, size / 4, size / 2}) {
        fs::copy_file(fake("good"), cut, fs::copy_options::overwrite_existing);
        fs::resize_file(cut, left);
        EXPECT_NE(defect(cut).find("its end is missing"), std::string::npos) << left;
    }
}

TEST_F(FindDenoiser, ADamagedPartBesideIt) {
    const fs::path library = folder_ / "libOpenImageDenoise.so.2",
                   part = folder_ / "libOpenImageDenoise_device_cpu.so.2.3.99";
    fs::copy_file(fake("good"), library);
    fs::copy_file(fake("good"), part);
    fs::resize_file(part, fs::file_size(part) / 2);
    EXPECT_NE(defect(library).find(part.string()), std::string::npos);
}

TEST_F(FindDenoiser, ThreadsAreThoseOfTheLimit) {
    const ThreadLimit limit(3);
    ::setenv("FAKE_OIDN_THREADS", "3", 1);
    EXPECT_NE(find_denoiser({DenoiserChoice::automatic, fake("good"), {}}).denoiser, nullptr);
    ::setenv("FAKE_OIDN_THREADS", "2", 1);
    EXPECT_EQ(find_denoiser({DenoiserChoice::automatic, fake("good"), {}}).denoiser, nullptr);
}

}  // namespace
}  // namespace covtrace
