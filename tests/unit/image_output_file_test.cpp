#include "image/output_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace covtrace {
namespace {

namespace fs = std::filesystem;

// A process that is killed between its two renames leaves the older file with both names.
TEST(OutputFile, LeavesNoThirdNameWhereTheOlderFileHasTwo) {
    const fs::path folder =
        fs::temp_directory_path() / ("output-file-" + std::to_string(::getpid()));
    fs::create_directory(folder);
    const fs::path file = folder / "a.film", earlier = folder / "a.film.prev";
    std::ofstream(file) << "old";
    fs::create_hard_link(file, earlier);
    OutputFile out(file);
    out.write("new", 3);
    out.commit(earlier);
    size_t files = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder)) ++files;
    EXPECT_EQ(files, 2u);
    std::string now, before;
    std::ifstream(file) >> now;
    std::ifstream(earlier) >> before;
    EXPECT_EQ(now, "new");
    EXPECT_EQ(before, "old");
    fs::remove_all(folder);
}

TEST(OutputFile, FollowsLinksToFilesThatAreNotThere) {
    const fs::path folder =
        fs::temp_directory_path() / ("output-link-" + std::to_string(::getpid()));
    fs::create_directories(folder / "far");
    fs::create_symlink("b", folder / "a");
    fs::create_symlink("far/c", folder / "b");
    OutputFile out(folder / "a");
    out.write("new", 3);
    out.commit();
    EXPECT_TRUE(fs::is_symlink(folder / "a") && fs::is_symlink(folder / "b"));
    EXPECT_TRUE(fs::is_regular_file(folder / "far/c"));
    // A link that leads to itself leads nowhere.
    fs::create_symlink("loop", folder / "loop");
    EXPECT_EQ(OutputFile::resolved(folder / "loop"), folder / "loop");
    fs::remove_all(folder);
}

}  // namespace
}  // namespace covtrace
