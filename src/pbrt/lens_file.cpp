#include "pbrt/lens_file.h"

#include <cmath>
#include <sstream>

#include "scene/names.h"

namespace covtrace {

namespace {

constexpr double kMillimetre = 1e-3;  // in scene units

/// Refuses what no ray could be traced through. `refuse` makes the error.
template <typename Refuse>
LensSurface surface(const double* row, size_t number, const Refuse& refuse) {
    const double index = row[2] == 0 ? 1 : row[2];
    const std::string nth = "element " + std::to_string(number);
    // The limit is far from what a lens is made of, and squares of it are numbers still
    constexpr double kLargest = 1e9;
    for (int i = 0; i < 4; ++i)
        if (!(std::abs(row[i]) <= kLargest)) throw refuse(nth + " is larger than any lens");
    if (!(index > 0)) throw refuse(nth + " has a negative index of refraction");
    if (!(row[3] > 0)) throw refuse(nth + " has no diameter; expected one above 0");
    return {float(row[0] * kMillimetre), float(row[1] * kMillimetre), float(index),
            float(0.5 * row[3] * kMillimetre)};
}

}  // namespace

std::vector<LensSurface> read_lens(std::string_view text, const std::string& name,
                                   const SourceLocation& where) {
    const auto refuse = [&](const std::string& why) {
        return Error(ErrorKind::scene, where, "lens file " + in_quotes(name) + ": " + why);
    };
    std::vector<double> numbers;
    std::istringstream lines{std::string(text)};
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line.substr(0, line.find('#')));
        double v = 0;
        while (words >> v) numbers.push_back(v);
        if (!words.eof()) throw refuse("it holds something else than numbers");
    }
    if (numbers.empty() || numbers.size() % 4 != 0)
        throw refuse("it has " + std::to_string(numbers.size()) +
                     " numbers; expected four for each element");
    std::vector<LensSurface> surfaces;
    for (size_t i = 0; i < numbers.size(); i += 4)
        surfaces.push_back(surface(&numbers[i], surfaces.size() + 1, refuse));
    const ParaxialLens lens = paraxial_lens(surfaces);
    if (!(lens.focal_length > 0) || !std::isfinite(lens.focal_length) ||
        (aperture_stop(surfaces) && !(lens.stop_per_pupil > 0)) || !(lens.widest_pupil > 0))
        throw refuse("it does not focus light");
    return surfaces;
}

}  // namespace covtrace
