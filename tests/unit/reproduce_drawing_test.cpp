// Pictures that are described before they are drawn.
#include "reproduce/drawing.h"

#include <gtest/gtest.h>

#include "reproduce/colour_map.h"
#include "reproduce/panels.h"
#include "reproduce/stroke_font.h"

namespace covtrace::reproduce {
namespace {

/// Darkness of a pixel, 0 on white.
int ink_at(const Picture& p, int x, int y) {
    return 255 - p.rgb[(size_t(y) * size_t(p.width) + size_t(x)) * 3];
}

TEST(Drawing, EscapesWhatMarkupTakesForItsOwn) {
    EXPECT_EQ(escaped("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
    Drawing d(10, 10);
    d.text(0, 0, 5, "</text><script>");
    EXPECT_EQ(d.svg().find("<script>"), std::string::npos);
    EXPECT_NE(d.svg().find("&lt;/text&gt;&lt;script&gt;"), std::string::npos);
}

TEST(Drawing, EllipseReachesTheDeviationsOfItsMatrix) {
    Drawing d(101, 101);
    // The ellipse has deviations 40 and 10 along the axes (3, 4)/5 and (-4, 3)/5.
    const float a = 1600, b = 100, c = 0.6f, s = 0.8f;
    d.ellipse(50.5f, 50.5f, {a * c * c + b * s * s, (a - b) * c * s, a * s * s + b * c * c}, kBlack,
              2);
    const Picture p = d.pixels();
    const auto on_axis = [&](float length, float x, float y) {
        return ink_at(p, int(50.5f + length * x), int(50.5f + length * y));
    };
    EXPECT_GT(on_axis(40, c, s), 128);
    EXPECT_GT(on_axis(-40, c, s), 128);
    EXPECT_GT(on_axis(10, -s, c), 128);
    EXPECT_EQ(on_axis(35, c, s), 0);
    EXPECT_EQ(on_axis(16, -s, c), 0);
    EXPECT_EQ(on_axis(0, c, s), 0);
}

TEST(Drawing, MagnifiesAnImageWithoutSmoothing) {
    Picture two(2, 1);
    two.rgb = {0, 0, 0, 255, 255, 255};
    Drawing d(10, 4);
    d.image(two, 1, 0, 4);
    const Picture p = d.pixels();
    EXPECT_EQ(ink_at(p, 0, 1), 0);
    EXPECT_EQ(ink_at(p, 1, 1), 255);
    EXPECT_EQ(ink_at(p, 4, 3), 255);
    EXPECT_EQ(ink_at(p, 5, 1), 0);
}

size_t count(const std::string& text, const std::string& word) {
    size_t n = 0;
    for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
    return n;
}

TEST(Sheet, DrawsNoEllipsesThatOverlapAndKeepsTheSmallOnes) {
    const auto drawn = [](const std::vector<covariance::Sym2<float>>& filters) {
        Sheet sheet({40, 20}, 2, 1, 1);
        sheet.ellipses(0, 0, filters, 20, 2, kBlack);
        return count(sheet.drawing.svg(), "<polygon");
    };
    std::vector<covariance::Sym2<float>> filters(40 * 20, {0.09f, 0, 0.09f});
    // 2 pixels apart and 1.2 across; the last of a row and of a column would leave the panel.
    EXPECT_EQ(drawn(filters), 19u * 9u);
    std::fill(filters.begin(), filters.end(), covariance::Sym2<float>{9, 0, 9});
    const size_t wide = drawn(filters);  // 12 across: three beside each other
    EXPECT_GE(wide, 1u);
    EXPECT_LE(wide, 3u);
    // A row of small ones through the middle leaves no room for wide ones.
    for (int y = 9; y < 12; ++y)
        for (int x = 0; x < 40; ++x) filters[size_t(40 * y + x)] = {0.09f, 0, 0.09f};
    EXPECT_GE(drawn(filters), 20u);
}

TEST(ColourMap, LabelsStayWithinTheBarAndApart) {
    Drawing drawing(400, 60);
    draw_legend(drawing, {0.0001f, 0.2f, "a quantity"}, 100, 10, 200);
    const Picture p = drawing.pixels();
    for (int y = 0; y < p.height; ++y)
        for (int x = 0; x < p.width; ++x)
            if (x < 98 || x > 302) {
                ASSERT_EQ(ink_at(p, x, y), 0) << x << " " << y;
            }
    EXPECT_GE(count(drawing.svg(), "<text"), 4u);
}

TEST(StrokeFont, HasLettersDigitsAndSigns) {
    const auto missing = strokes_of("\x01");  // drawn as '?'
    for (char c = 'a'; c <= 'z'; ++c) EXPECT_NE(strokes_of(std::string(1, c)), missing) << c;
    for (char c = 'A'; c <= 'Z'; ++c) EXPECT_NE(strokes_of(std::string(1, c)), missing) << c;
    for (char c = '0'; c <= '9'; ++c) EXPECT_NE(strokes_of(std::string(1, c)), missing) << c;
    for (const char* sign : {".", ",", ":", "-", "²", "°", "√", "×", "|", "/", "(", ")"})
        EXPECT_NE(strokes_of(sign), missing) << sign;
    EXPECT_TRUE(strokes_of(" ").empty());
    EXPECT_EQ(letters_in("1 px²"), 5u);
}

TEST(ColourMap, GetsLighterAllTheWay) {
    const ColourMap map{0.1f, 100, "samples"};
    int last = -1;
    for (float v = 0.1f; v < 100; v *= 1.1f) {
        const Ink c = map(v);
        const int light = 2126 * c.r + 7152 * c.g + 722 * c.b;
        EXPECT_GE(light, last) << v;
        last = light;
    }
    EXPECT_EQ(map(0.01f), map(0.1f));
    EXPECT_EQ(map(1000), map(100));
    EXPECT_EQ(map(std::numeric_limits<float>::quiet_NaN()), map(0.1f));
}

TEST(ColourMap, SpansADecadeAtLeast) {
    const std::vector<float> even(100, 3.0f);
    const ColourMap map = map_for(even, "pixels");
    EXPECT_LE(map.least, 1);
    EXPECT_GE(map.most, 9);
    const ColourMap none = map_for(std::vector<float>(10, 0.0f), "pixels");
    EXPECT_LT(none.least, none.most);
}

}  // namespace
}  // namespace covtrace::reproduce
