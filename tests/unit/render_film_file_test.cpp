// Film files: written films are read back, and no other files are.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "film_fixtures.h"
#include "render/film_file.h"
#include "render/film_header.h"

namespace covtrace {
namespace {

namespace fs = std::filesystem;
using test::random_state;

class FilmFile : public testing::Test {
  protected:
    FilmFile() {
        const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
        folder_ = fs::temp_directory_path() /
                  ("covtrace-film-" + name + "-" + std::to_string(::getpid()));
        fs::create_directories(folder_);
        file_ = folder_ / "a.film";
    }
    ~FilmFile() override { fs::remove_all(folder_); }

    static std::string content(const fs::path& file) {
        std::ifstream in(file, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    void write(const std::string& bytes) const { std::ofstream(file_, std::ios::binary) << bytes; }
    /// The kind of error that reading gives; none where it succeeds.
    std::optional<ErrorKind> error() const {
        try {
            read_film(file_);
            return std::nullopt;
        } catch (const Error& e) {
            EXPECT_TRUE(std::string(e.what()).starts_with(file_.string())) << e.what();
            return e.kind();
        }
    }

    fs::path folder_, file_;
};

void expect_same(RenderState& a, RenderState& b) {
    EXPECT_EQ(film_header(a), film_header(b));
    const auto of_a = film_arrays(a), of_b = film_arrays(b);
    ASSERT_EQ(of_a.size(), of_b.size());
    for (size_t i = 0; i < of_a.size(); ++i)
        EXPECT_EQ(
            std::memcmp(of_a[i].records, of_b[i].records, of_a[i].count * of_a[i].record_size), 0)
            << of_a[i].name;
}

TEST_F(FilmFile, KeepsEveryBit) {
    for (Method method : {Method::uniform, Method::covariance, Method::hybrid})
        for (Stage stage : {Stage::first_paths, Stage::pilot, Stage::rounds})
            for (bool in_round : {true, false}) {
                if (method == Method::uniform && stage != Stage::rounds) continue;
                // Arrays have two blocks once.
                const bool large = method == Method::uniform && in_round && stage == Stage::rounds;
                RenderState s = random_state(method, stage, in_round,
                                             {-7, 3, large ? 293 : 20, large ? 233 : 11});
                write_film(s, file_);
                EXPECT_TRUE(is_film(file_));
                RenderState read = read_film(file_);
                expect_same(s, read);
                EXPECT_EQ(read.identity, s.identity);
                EXPECT_EQ(read.metadata, s.metadata);
                EXPECT_EQ(read.weight_limit, s.weight_limit);
                EXPECT_EQ(read.first_rejected[0].sample, s.first_rejected[0].sample);
            }
}

/// A film that covtrace 0.1.0 of commit 6aca4960848e wrote: 12x8 pixels, `hybrid`, 8 samples, of a
/// mirror ball above a diffuse one.
TEST_F(FilmFile, ReadsThatOfFormat3) {
    const RenderState film =
        read_film(std::filesystem::path(COVTRACE_TEST_FILES) / "hybrid-format-3.film");
    ASSERT_EQ(film.films.size(), 2u);
    EXPECT_EQ(film.mean_count(), 8);
    float most = 0, coloured = 0;
    for (const Film& half : film.films) {
        ASSERT_EQ(half.features.size(), 96u);
        ASSERT_EQ(half.feature_squares.size(), 96u);
        for (size_t i = 0; i < 96; ++i) {
            EXPECT_EQ(half.features[i].albedo, half.pixels[i].albedo);
            EXPECT_EQ(half.features[i].normal, half.pixels[i].normal);
            EXPECT_EQ(half.features[i].depth, half.pixels[i].depth);
            EXPECT_GE(half.feature_squares[i].normal, 0);
            most = std::max(most, half.feature_squares[i].normal);
            coloured = std::max(coloured, half.features[i].albedo.r - half.features[i].albedo.b);
        }
    }
    EXPECT_GT(most, 0.1f);  // at the borders of the balls
    EXPECT_NEAR(coloured, 0.7f, 0.01f);
}

TEST_F(FilmFile, KeepsTheEarlierOne) {
    RenderState first = random_state(Method::uniform, Stage::rounds, true, {0, 0, 20, 10});
    RenderState second = first;
    second.taken = 5;
    write_film(first, file_);
    EXPECT_FALSE(fs::exists(earlier_film(file_)));
    write_film(second, file_);
    RenderState is = read_film(file_), was = read_film(earlier_film(file_));
    expect_same(is, second);
    expect_same(was, first);

    EXPECT_TRUE(find_film(file_).damage.empty());
    write("damaged");
    EXPECT_NE(find_film(file_).damage, "");
    EXPECT_EQ(find_film(file_).state->taken, first.taken);
    fs::remove(file_);
    EXPECT_EQ(find_film(file_).state->taken, first.taken);
    EXPECT_FALSE(find_film(folder_ / "none.film").state);
}

TEST_F(FilmFile, AnyChangedByteIsFound) {
    write_film(random_state(Method::uniform, Stage::rounds, true, {0, 0, 2, 1}), file_);
    const std::string good = content(file_);
    for (size_t i = 0; i < good.size(); ++i) {
        std::string bad = good;
        bad[i] = char(bad[i] ^ (1 << (i % 8)));
        write(bad);
        EXPECT_EQ(error(), ErrorKind::scene) << "byte " << i;
    }
}

TEST_F(FilmFile, AnyOtherLengthIsFound) {
    write_film(random_state(Method::covariance, Stage::rounds, true, {0, 0, 3, 2}), file_);
    const std::string good = content(file_);
    for (size_t i = 0; i < good.size(); i += 3) {
        write(good.substr(0, i));
        EXPECT_TRUE(error()) << "length " << i;  // scene, or limit: too short for so many pixels
    }
    write(good + "x");
    EXPECT_EQ(error(), ErrorKind::scene);
    fs::remove(file_);
    EXPECT_EQ(error(), ErrorKind::scene);
}

TEST(Tiles, EveryTileHasOneOwner) {
    const Tiles tiles({5, 7, 205, 107});
    int64_t pixels = 0;
    for (int64_t t = 0; t < tiles.count(); ++t) {
        pixels += int64_t(tiles.bounds(t).width()) * tiles.bounds(t).height();
        int owners = 0;
        for (int k = 0; k < 6; ++k) owners += tiles.belongs_to(t, {k, 6});
        EXPECT_EQ(owners, 1);
    }
    EXPECT_EQ(pixels, 200 * 100);
    int64_t sum = 0;
    for (int k = 0; k < 6; ++k) sum += tiles.count({k, 6});
    EXPECT_EQ(sum, tiles.count());
}

}  // namespace
}  // namespace covtrace
