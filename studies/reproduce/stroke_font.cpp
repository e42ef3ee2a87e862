#include "reproduce/stroke_font.h"

#include <array>
#include <string_view>

namespace covtrace::reproduce {

namespace {

/// A letter as lines on a grid of 5 x 9 points: pairs of digits x y, y from 0, the top of capitals,
/// over 6, the base line, to 8; a space ends a line.
struct Glyph {
    std::string_view letter, lines;
};
constexpr std::array kGlyphs{Glyph{"0", "100105163645413010"},
                             Glyph{"1", "122026 1636"},
                             Glyph{"2", "01103041420646"},
                             Glyph{"3", "01103041423313 334445361605"},
                             Glyph{"4", "30044430 3136"},
                             Glyph{"5", "400003334445361605"},
                             Glyph{"6", "4130100105163645443303"},
                             Glyph{"7", "00404216"},
                             Glyph{"8", "13020110304142331304051636454433"},
                             Glyph{"9", "0516364541301001021343"},
                             Glyph{"A", "0602204246 0444"},
                             Glyph{"B", "06003041423303 334445360600"},
                             Glyph{"C", "4130100105163645"},
                             Glyph{"D", "00062644422000"},
                             Glyph{"E", "40000646 0333"},
                             Glyph{"F", "400006 0333"},
                             Glyph{"G", "41301001051636454323"},
                             Glyph{"H", "0006 4046 0343"},
                             Glyph{"I", "1030 2026 1636"},
                             Glyph{"J", "404536160504"},
                             Glyph{"K", "0006 400346"},
                             Glyph{"L", "000646"},
                             Glyph{"M", "0600234046"},
                             Glyph{"N", "06004640"},
                             Glyph{"O", "100105163645413010"},
                             Glyph{"P", "060030414233 3303"},
                             Glyph{"Q", "100105163645413010 2446"},
                             Glyph{"R", "060030414233 3303 2346"},
                             Glyph{"S", "413010010213334445361605"},
                             Glyph{"T", "0040 2026"},
                             Glyph{"U", "000516364540"},
                             Glyph{"V", "002640"},
                             Glyph{"W", "0016233640"},
                             Glyph{"X", "0046 4006"},
                             Glyph{"Y", "002340 2326"},
                             Glyph{"Z", "00400646"},
                             Glyph{"a", "123243463616051444"},
                             Glyph{"b", "0006 0312324345361605"},
                             Glyph{"c", "4332120305163645"},
                             Glyph{"d", "4046 4332120305163645"},
                             Glyph{"e", "04444332120305163645"},
                             Glyph{"f", "30202126 1232"},
                             Glyph{"g", "4248 4332120305163645 48381807"},
                             Glyph{"h", "0006 0312324346"},
                             Glyph{"i", "2020 122226 1636"},
                             Glyph{"j", "3030 22323828"},
                             Glyph{"k", "0006 420446"},
                             Glyph{"l", "10202636"},
                             Glyph{"m", "0602 03122326 23324346"},
                             Glyph{"n", "0206 0312324346"},
                             Glyph{"o", "120305163645433212"},
                             Glyph{"p", "0208 0312324345361605"},
                             Glyph{"q", "4248 4332120305163645"},
                             Glyph{"r", "0206 03123243"},
                             Glyph{"s", "433212031434453605"},
                             Glyph{"t", "20253646 0242"},
                             Glyph{"u", "020516364542 4246"},
                             Glyph{"v", "022642"},
                             Glyph{"w", "0216233642"},
                             Glyph{"x", "0246 4206"},
                             Glyph{"y", "0226 4218"},
                             Glyph{"z", "02420646"},
                             Glyph{".", "2626"},
                             Glyph{",", "2617"},
                             Glyph{":", "2323 2626"},
                             Glyph{";", "2323 2617"},
                             Glyph{"-", "1333"},
                             Glyph{"+", "2125 0343"},
                             Glyph{"=", "0242 0444"},
                             Glyph{"/", "0640"},
                             Glyph{"(", "30121436"},
                             Glyph{")", "10323416"},
                             Glyph{"%", "4006 1010 3636"},
                             Glyph{"'", "2022"},
                             Glyph{"<", "410345"},
                             Glyph{">", "014305"},
                             Glyph{"_", "0747"},
                             Glyph{"!", "2024 2626"},
                             Glyph{"?", "01103041422324 2626"},
                             Glyph{"*", "2125 0145 4105"},
                             Glyph{"²", "001020211303 1323"},
                             Glyph{"×", "1236 3216"},
                             Glyph{"·", "2323"},
                             Glyph{"°", "1020312111 1011"},
                             Glyph{"√", "03132640"},
                             Glyph{"σ", "4222120305163645433222"},
                             Glyph{"|", "2027"},
                             Glyph{"–", "0343"}};

/// Number of bytes of the letter that starts with `first`.
size_t letter_size(char first) {
    const auto byte = static_cast<unsigned char>(first);
    return byte < 0x80 ? 1 : byte < 0xe0 ? 2 : byte < 0xf0 ? 3 : 4;
}

std::string_view lines_of(std::string_view letter) {
    if (letter == " ") return {};
    std::string_view unknown;
    for (const Glyph& g : kGlyphs) {
        if (g.letter == letter) return g.lines;
        if (g.letter == "?") unknown = g.lines;
    }
    return unknown;
}

}  // namespace

std::vector<std::vector<Vec2>> strokes_of(const std::string& text) {
    std::vector<std::vector<Vec2>> strokes;
    float x = 0;
    for (size_t i = 0; i < text.size(); i += letter_size(text[i]), x += kAdvance) {
        std::vector<Vec2> points;
        const auto end_line = [&] {
            if (!points.empty()) strokes.push_back(std::move(points));
            points.clear();
        };
        const std::string_view lines =
            lines_of(std::string_view(text).substr(i, letter_size(text[i])));
        for (size_t k = 0; k < lines.size();) {
            if (lines[k] == ' ' || k + 1 >= lines.size()) {
                end_line();
                ++k;
                continue;
            }
            points.push_back({x + float(lines[k] - '0'), float(lines[k + 1] - '0') - kCapital});
            k += 2;
        }
        end_line();
    }
    return strokes;
}

size_t letters_in(const std::string& text) {
    size_t letters = 0;
    for (size_t i = 0; i < text.size(); i += letter_size(text[i])) ++letters;
    return letters;
}

}  // namespace covtrace::reproduce
