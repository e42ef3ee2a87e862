// Films of other versions of the program, of the same format.
#define XXH_INLINE_ALL
#include <gtest/gtest.h>
#include <unistd.h>
#include <xxhash.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "film_fixtures.h"
#include "render/film_file.h"
#include "render/film_header.h"
#include "render/merge.h"

namespace covtrace {
namespace {

namespace fs = std::filesystem;
using test::random_state;

/// The file of a film of that version whose header this version cannot know.
std::string film_of(const std::string& version, const fs::path& folder) {
    RenderState state = random_state(Method::uniform, Stage::rounds, false, {0, 0, 4, 3});
    state.identity["version"] = version;
    const fs::path file = folder / "written.film";
    write_film(state, file);
    std::ifstream in(file, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(in), {}};
    // Magic, format, size of the header, its hash, the header.
    constexpr size_t kSize = 12, kHash = 16, kHeader = 24;
    uint32_t size = 0;
    std::memcpy(&size, &bytes[kSize], sizeof size);
    const size_t stage = bytes.find("\"rounds\"", kHeader);
    EXPECT_LT(stage, kHeader + size);
    bytes.replace(stage, 8, "\"photon\"");
    const uint64_t hash = XXH3_64bits(&bytes[kHeader], size);
    std::memcpy(&bytes[kHash], &hash, sizeof hash);
    return bytes;
}

class FilmVersions : public testing::Test {
  protected:
    FilmVersions()
        : folder_(fs::temp_directory_path() / ("covtrace-versions-" + std::to_string(::getpid()))) {
        fs::create_directories(folder_);
    }
    ~FilmVersions() override { fs::remove_all(folder_); }

    fs::path written(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
        return folder_ / name;
    }

    fs::path folder_;
};

TEST_F(FilmVersions, AHeaderOfAnotherVersionIsToldAsOne) {
    const fs::path file = written("a.film", film_of("9.9 (abc)", folder_));
    try {
        read_film(file);
        FAIL();
    } catch (const FilmOfOtherVersion& e) {
        EXPECT_EQ(e.kind(), ErrorKind::scene);
        const std::string begin = file.string() +
                                  ": a film of version 9.9 (abc), which this version, " +
                                  program_version() + ", cannot read: ";
        EXPECT_EQ(std::string(e.what()).substr(0, begin.size()), begin);
    }
    // Nor is an earlier film gone on from in its place.
    fs::copy_file(file, earlier_film(file));
    EXPECT_THROW(find_film(file), FilmOfOtherVersion);
}

TEST_F(FilmVersions, AWrongHeaderOfThisVersionIsDamage) {
    const fs::path file = written("a.film", film_of(program_version(), folder_));
    try {
        read_film(file);
        FAIL();
    } catch (const FilmOfOtherVersion& e) {
        FAIL() << e.what();
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::scene);
    }
}

TEST_F(FilmVersions, FilmsOfTwoVersionsAreNotMerged) {
    const auto part = [](const char* version, int shard) {
        RenderState s = random_state(Method::uniform, Stage::rounds, true, {0, 0, 40, 20});
        s.present = {shard};
        s.identity["version"] = version;
        return s;
    };
    FilmMerge merge;
    merge.add("a", part("1.0 (a)", 0));
    try {
        merge.add("b", part("1.1 (b)", 1));
        FAIL();
    } catch (const Error& e) {
        const std::string text = e.what();
        for (const char* told : {"b", "version", "1.0 (a)", "1.1 (b)"})
            EXPECT_NE(text.find(told), std::string::npos) << text;
    }
}

}  // namespace
}  // namespace covtrace
