#include "pbrt/lens_file.h"

#include <array>
#include <cmath>
#include <sstream>
#include <vector>

#include "scene/names.h"

namespace covtrace {

LensSummary read_lens(std::string_view text, const std::string& name, const SourceLocation& where) {
    const auto refuse = [&](const std::string& why) {
        return Error(ErrorKind::scene, where, "lens file " + in_quotes(name) + " " + why);
    };
    std::vector<double> numbers;
    std::istringstream lines{std::string(text)};
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line.substr(0, line.find('#')));
        double v = 0;
        while (words >> v) numbers.push_back(v);
        if (!words.eof()) throw refuse("holds something else than numbers");
    }
    if (numbers.empty() || numbers.size() % 4 != 0)
        throw refuse("has " + std::to_string(numbers.size()) +
                     " numbers; expected four for each element");

    LensSummary lens;
    // Trace a paraxial ray (height, slope times index) through all elements: its height changes
    // over a thickness, its slope at a curved border.
    double height = 1, slope = 0, index = 1;
    for (size_t i = 0; i < numbers.size(); i += 4) {
        const double radius = numbers[i], thickness = numbers[i + 1];
        const double next = numbers[i + 2] == 0 ? 1 : numbers[i + 2];
        if (radius == 0) {
            lens.aperture_diameter = static_cast<float>(numbers[i + 3]);
            lens.stop_per_pupil = static_cast<float>(height);
        } else {
            slope -= height * (next - index) / radius;
            index = next;
        }
        if (i + 4 < numbers.size()) height += thickness * slope / index;
    }
    lens.focal_length = static_cast<float>(-1 / slope);
    if (!(lens.focal_length > 0) || !std::isfinite(lens.focal_length) || !(lens.stop_per_pupil > 0))
        throw refuse("does not focus light");
    return lens;
}

}  // namespace covtrace
