#include "image/ocio_view.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/colour_space.h"
#include "image/display.h"

namespace covtrace::test {
namespace {

std::string text_of(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

/// Two displays; the first has a matrix and an exponent in its view "Crossed", and a look.
const std::string kConfig = text_of(COVTRACE_OCIO_CONFIG);

/// The view "Crossed", computed here.
Rgb crossed(Rgb c) {
    const auto curve = [](float v) { return std::pow(v, 1 / 2.4f); };
    return {curve(0.75f * c.r + 0.25f * c.g), curve(0.125f * c.r + 0.75f * c.g + 0.125f * c.b),
            curve(0.5f * c.g + 0.5f * c.b)};
}

/// The text with the only occurrence of `part` replaced.
std::string with(const std::string& text, const std::string& part, const std::string& by) {
    const size_t at = text.find(part);
    EXPECT_NE(at, std::string::npos) << part;
    return std::string(text).replace(at, part.size(), by);
}

class OcioViews : public ::testing::Test {
  protected:
    OcioViews()
        : folder_(std::filesystem::path(::testing::TempDir()) /
                  ::testing::UnitTest::GetInstance()->current_test_info()->name()) {
        std::filesystem::create_directories(folder_);
    }
    ~OcioViews() override { std::filesystem::remove_all(folder_); }

    OcioChoice choice(const std::string& text = kConfig) const {
        std::ofstream(file()) << text;
        OcioChoice c;
        c.config = file();
        return c;
    }

    std::filesystem::path file() const { return folder_ / "config.ocio"; }

    static Error error_of(const OcioChoice& c) {
        try {
            const OcioView view(c);
        } catch (const Error& e) {
            return e;
        }
        ADD_FAILURE() << "no error";
        return {ErrorKind::internal, ""};
    }

    std::filesystem::path folder_;
};

void expect_near(Rgb shown, Rgb expected) {
    // The library's fast powers are within a ten-thousandth.
    constexpr float kTolerance = 3e-4f;
    EXPECT_NEAR(shown.r, expected.r, kTolerance);
    EXPECT_NEAR(shown.g, expected.g, kTolerance);
    EXPECT_NEAR(shown.b, expected.b, kTolerance);
}

constexpr std::array<Rgb, 4> kColours{{{0.25f, 0.5f, 0.75f}, {0.01f, 0, 0.3f}, {3, 1, 0}, {}}};

TEST_F(OcioViews, TheConfigsFirstDisplayAndViewAreItsDefault) {
    const OcioView view(choice());
    for (const Rgb c : kColours) expect_near(view.shown(c), crossed(c));
    EXPECT_TRUE(view.warnings().empty());
}

TEST_F(OcioViews, ADisplayHasItsOwnViews) {
    OcioChoice c = choice();
    c.display = "Projector";
    expect_near(OcioView(c).shown({1, 2, 3}), {0.25f, 0.5f, 0.75f});
    c.display = "Screen";
    c.view = "Untouched";
    expect_near(OcioView(c).shown({1, 2, 3}), {1, 2, 3});
}

TEST_F(OcioViews, LooksOfTheViewAndInItsPlace) {
    OcioChoice c = choice();
    c.view = "Warm";
    for (const Rgb k : kColours)
        expect_near(OcioView(c).shown(k), crossed({1.5f * k.r, k.g, 0.5f * k.b}));
    c.look = "dim - half";
    for (const Rgb k : kColours) expect_near(OcioView(c).shown(k), crossed(0.5f * k));
    c.look = "warm, +dim - half";
    for (const Rgb k : kColours)
        expect_near(OcioView(c).shown(k), crossed({0.75f * k.r, 0.5f * k.g, 0.25f * k.b}));
    c.look = "-dim - half";
    expect_near(OcioView(c).shown({0.2f, 0.1f, 0.3f}), crossed({0.4f, 0.2f, 0.6f}));
}

TEST_F(OcioViews, ColoursAreInTheSpaceThatIsNamed) {
    OcioChoice c = choice();
    c.source = "dark";
    expect_near(OcioView(c).shown({0.05f, 0.1f, 0.15f}), crossed({0.2f, 0.4f, 0.6f}));
}

TEST_F(OcioViews, RendersAreConvertedWhereTheConfigKnowsAces) {
    // The reference space is ACES2065-1, of which the renderers' space has red and green exchanged.
    const std::string tied =
        with(with(kConfig, "scene_linear: linear", "aces_interchange: linear\n  scene_linear: own"),
             "colorspaces:\n",
             "colorspaces:\n  - !<ColorSpace>\n    name: own\n    from_scene_reference: "
             "!<MatrixTransform> {matrix: [0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}\n");
    OcioChoice c = choice(tied);
    const Rgb in_aces{0.4f, 0.5f, 0.3f};
    expect_near(OcioView(c).shown(to_rec709(in_aces, ColourSpace::aces2065_1)), crossed(in_aces));
    // A view that leaves numbers as they are shows those of the renderers' space.
    c.view = "Untouched";
    expect_near(OcioView(c).shown(to_rec709(in_aces, ColourSpace::aces2065_1)),
                {in_aces.g, in_aces.r, in_aces.b});
    // Who names a space says what the numbers are.
    c.source = "own";
    expect_near(OcioView(c).shown({0.4f, 0.5f, 0.3f}), {0.4f, 0.5f, 0.3f});
}

TEST_F(OcioViews, TheEnvironmentIsNotAsked) {
    ::setenv("OCIO", "/nowhere/config.ocio", 1);
    const OcioView view(choice());
    ::unsetenv("OCIO");
    expect_near(view.shown({0.25f, 0.5f, 0.75f}), crossed({0.25f, 0.5f, 0.75f}));
}

TEST_F(OcioViews, FilesThatAreNoConfigs) {
    OcioChoice c = choice();
    c.config = folder_ / "none.ocio";
    EXPECT_STREQ(error_of(c).what(),
                 ("cannot open '" + c.config.string() + "': No such file or directory").c_str());
    c.config = folder_;
    EXPECT_EQ(error_of(c).kind(), ErrorKind::scene);
    const auto message = [this](const std::string& text) {
        const Error e = error_of(choice(text));
        EXPECT_EQ(e.kind(), ErrorKind::scene);
        return std::string(e.what());
    };
    const std::string name = file().string();
    EXPECT_TRUE(message("hello").starts_with(name + ":1:1: cannot read '" + name + "': "));
    EXPECT_TRUE(message(with(kConfig, "direction: inverse}", "direction: inverse"))
                    .starts_with(name + ":35:9: cannot read '" + name + "': "));
    message("");
    message(with(kConfig, "version: 2", "version: 9"));
    EXPECT_NE(message(with(kConfig, "colorspace: crossed}", "colorspace: gone}")).find("'gone'"),
              std::string::npos);
    EXPECT_NE(message(with(kConfig, "!<CDLTransform> {slope: [1.5, 1, 0.5]}",
                           "!<FileTransform> {src: none.spi1d}") +
                      "\nactive_views: [Warm]\n")
                  .find("none.spi1d"),
              std::string::npos);
    std::ofstream(folder_ / "bad.spi1d")
        << "Version 1\nFrom 0 1\nLength 2\nComponents 1\n{\n0\nx\n}\n";
    const std::string of_table = message(
        with(kConfig, "!<ExponentTransform> {value: [2.4, 2.4, 2.4, 1], direction: inverse}",
             "!<FileTransform> {src: ../bad.spi1d}"));
    EXPECT_TRUE(of_table.starts_with(name + ": cannot read '" + name + "': ")) << of_table;
    EXPECT_NE(of_table.find("bad.spi1d"), std::string::npos) << of_table;
    EXPECT_NE(message("ocio_profile_version: 2\nroles: {default: a, scene_linear: a}\n"
                      "colorspaces: [!<ColorSpace> {name: a}]\n")
                  .find("no display"),
              std::string::npos);
}

TEST_F(OcioViews, LongMessagesTellThatTheyAreCut) {
    const std::string name(3000, 'g');
    const Error e =
        error_of(choice(with(kConfig, "colorspace: crossed}", "colorspace: " + name + "}")));
    const std::string text = e.what();
    EXPECT_NE(text.find("ggg ... g"), std::string::npos) << text;
    EXPECT_LT(text.size(), 1300u);
    EXPECT_FALSE(text.ends_with("g")) << text;  // what follows the name is told
}

TEST_F(OcioViews, KnowTheFilesThatWereRead) {
    std::filesystem::create_directories(folder_ / "luts");
    for (const char* name : {"used", "other"})
        std::ofstream(folder_ / "luts" / (std::string(name) + ".spi1d"))
            << "Version 1\nFrom 0 1\nLength 2\nComponents 1\n{\n0\n0.5\n}\n";
    const OcioChoice c = choice(
        with(with(kConfig, "!<ExponentTransform> {value: [2.4, 2.4, 2.4, 1], direction: inverse}",
                  "!<FileTransform> {src: used.spi1d}"),
             "!<CDLTransform> {slope: [1.5, 1, 0.5]}", "!<FileTransform> {src: other.spi1d}"));
    const OcioView view(c);
    ASSERT_EQ(view.files().size(), 2u);
    EXPECT_EQ(view.files()[0], file());
    EXPECT_TRUE(std::filesystem::equivalent(view.files()[1], folder_ / "luts" / "used.spi1d"));
}

TEST_F(OcioViews, NamesThatTheConfigDoesNotHave) {
    const auto expect_refused = [](const OcioChoice& c, const std::string& option,
                                   const std::string& end) {
        const Error e = error_of(c);
        EXPECT_EQ(e.kind(), ErrorKind::usage) << e.what();
        EXPECT_EQ(e.option(), option);
        EXPECT_TRUE(std::string(e.what()).ends_with(end)) << e.what();
    };
    OcioChoice c = choice();
    c.display = "Cinema";
    expect_refused(c, "ocio_display", "; it has 'Screen', 'Projector'");
    c.display = "Projector";
    c.view = "Warm";
    expect_refused(c, "view",
                   "of the display 'Projector' of '" + file().string() + "'; it has 'Dark'");
    c = choice();
    c.look = "warm, cold";
    expect_refused(c, "ocio_look",
                   "'cold' is no look of '" + file().string() + "'; it has 'warm', 'dim - half'");
    for (const std::string& look : {std::string(" "), std::string("-"), std::string("warm, , warm"),
                                    std::string("- warm"), std::string(1000000, 'a')}) {
        c.look = look;
        expect_refused(c, "ocio_look", "it has 'warm', 'dim - half'");
    }
    c = choice();
    c.source = "log";
    expect_refused(c, "ocio_source", "; it has 'linear', 'untouched', 'crossed', 'dark'");
    c = choice(with(kConfig, "scene_linear", "reference"));
    expect_refused(c, "ocio_source", "; it has 'linear', 'untouched', 'crossed', 'dark'");
    c.source = "linear";
    expect_near(OcioView(c).shown({0.25f, 0.5f, 0.75f}), crossed({0.25f, 0.5f, 0.75f}));
}

TEST_F(OcioViews, WhatIsNotUnderstoodIsTold) {
    const OcioView view(choice(with(kConfig, "{value: [2.4, 2.4, 2.4, 1]", "{valu: 2.4")));
    ASSERT_EQ(view.warnings().size(), 1u);
    EXPECT_EQ(view.warnings()[0].where.to_string(), file().string() + ":33");
    EXPECT_NE(view.warnings()[0].text.find("'valu'"), std::string::npos);
}

TEST_F(OcioViews, TakeThePlaceOfTheOthersInPictures) {
    const OcioChoice c = choice();
    const Rgb colour{0.05f, 0.1f, 0.15f};
    const Rgb expected = 255.0f * crossed(2.0f * colour);
    const std::array<uint8_t, 3> shown = display_8bit(colour, display_options(1, "Crossed", c));
    EXPECT_NEAR(shown[0], expected.r, 0.6);
    EXPECT_NEAR(shown[1], expected.g, 0.6);
    EXPECT_NEAR(shown[2], expected.b, 0.6);
    EXPECT_EQ(display_8bit({-1, std::nanf(""), kInfinity}, display_options(0, "", c)),
              (std::array<uint8_t, 3>{0, 255, 255}));
    EXPECT_THROW(display_options(0, "agx", c), Error);
    EXPECT_THROW(display_options(0, "Crossed", {}), Error);
    EXPECT_THROW(display_options(0, "", {.look = "warm"}), Error);
}

}  // namespace
}  // namespace covtrace::test
