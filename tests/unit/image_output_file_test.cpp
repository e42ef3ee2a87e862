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

}  // namespace
}  // namespace covtrace
