#include "reproduce/settings.h"

namespace covtrace::reproduce {

namespace {

const Settings kTiny{{64, 36}, {160, 72}, {32, 18}, {48, 27}, 4, 4, 16, 64, 16, 14, {1}};
const Settings kQuick{{240, 135}, {300, 135}, {240, 135}, {320, 180}, 8,     16,
                      256,        1024,       512,        453,        {1, 2}};
const Settings kFull{{640, 360}, {800, 360}, {640, 360}, {640, 360}, 16,       64,
                     1024,       8192,       512,        453,        {1, 2, 3}};

}  // namespace

const Settings& settings_of(Size size) {
    return size == Size::tiny ? kTiny : size == Size::quick ? kQuick : kFull;
}

std::string text_of(const std::vector<uint64_t>& seeds) {
    std::string s;
    for (const uint64_t seed : seeds) s += (s.empty() ? "" : ", ") + std::to_string(seed);
    return s;
}

std::string name_of(Size size) {
    return size == Size::tiny ? "tiny" : size == Size::quick ? "quick" : "full";
}

}  // namespace covtrace::reproduce
