#include "light/environment_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/fast_math.h"
#include "core/hash.h"
#include "core/memory_limit.h"
#include "core/parallel.h"
#include "light/equal_area.h"
#include "light/texels.h"

namespace covtrace {

namespace {

/// Chooses one of two, the first with probability a / (a + b), and says whether it is the second; u
/// is stretched to be used again.
bool choose_second(float a, float b, float& u) {
    const float share = a + b > 0 ? a / (a + b) : 0.5f;
    const bool second = u >= share;
    u = second ? (u - share) / (1 - share) : u / share;
    u = std::min(u, kLargestBelowOne);
    return second;
}

/// A number in [0, 1] with density proportional to a + (b - a) x.
float sample_linear(float a, float b, float u) {
    if (!(a + b > 0)) return u;
    // The weights are taken relative to the larger: squares of a very bright sun would overflow.
    const float largest = std::max(a, b);
    a /= largest;
    b /= largest;
    const float root = std::sqrt(a * a + u * (b * b - a * a));
    return clamp01(u * (a + b) / (a + root));
}

int wrap_repeat(int i, int n) {
    const int r = i % n;
    return r < 0 ? r + n : r;
}

}  // namespace

EnvironmentMap EnvironmentMap::read(const std::filesystem::path& file, const SourceLocation& where,
                                    Warnings& warnings) {
    const LightTexels image = read_light_texels(file, LightChannels::colour, where, warnings);
    const int width = image.width(), height = image.height();
    if (width < 1 || (width != height && width != 2 * height))
        throw Error(ErrorKind::scene, where,
                    "environment image \"" + file.string() + "\" is " + std::to_string(width) +
                        " x " + std::to_string(height) +
                        " pixels; expected a square (equal-area map) or twice as wide as high "
                        "(lat-long map)");
    // Each texel takes a colour, and a number in the tables by which directions are drawn.
    const MemoryReservation room(image.size() * (sizeof(Rgb) + sizeof(float)),
                                 "the texels of '" + file.string() + "'", where);
    return made_of(file, where, [&] {
        EnvironmentMap map(width, height);
        map.build(image);
        return map;
    });
}

EnvironmentMap::EnvironmentMap(const std::vector<Rgb>& texels, int width, int height)
    : EnvironmentMap(width, height) {
    build(texels);
}

EnvironmentMap::EnvironmentMap(int width, int height)
    : width_(width),
      height_(height),
      layout_(width == height ? Layout::equal_area : Layout::lat_long) {
    row_sine_.resize(static_cast<size_t>(height_ + 2), 1.0f);
    if (layout_ == Layout::lat_long)
        for (int y = -1; y <= height_; ++y) {
            const double row = std::clamp(y, 0, height_ - 1) + 0.5;
            row_sine_[static_cast<size_t>(y + 1)] =
                static_cast<float>(std::sin(row * double(kPi) / height_));
        }
}

template <typename Texels>
void EnvironmentMap::build(const Texels& texels) {
    set_texels(texels);
    set_means();
    build_distribution();
}

template <typename Texels>
void EnvironmentMap::set_texels(const Texels& texels) {
    texels_.resize(static_cast<size_t>(width_ + 2) * static_cast<size_t>(height_ + 2));
    auto next = texels_.begin();
    for (int row = -1; row <= height_; ++row)
        for (int column = -1; column <= width_; ++column) {
            const int x = wrap_repeat(column, width_), y = std::clamp(row, 0, height_ - 1);
            *next++ = texels[static_cast<size_t>(y) * static_cast<size_t>(width_) +
                             static_cast<size_t>(x)];
        }
}

namespace {

/// The column or row of the texel whose centre lies at or before a coordinate, and how far beyond
/// that centre the coordinate lies, in texels.
struct Position {
    int index;
    float fraction;
};
Position position(float s, int n) {
    // A coordinate that is not a number gets any texel: its sample is rejected later.
    const float inside = s >= 0 ? std::min(s, 1.0f) : 0.0f;
    const float x = inside * static_cast<float>(n) - 0.5f, whole = std::floor(x);
    return {static_cast<int>(whole), x - whole};
}

}  // namespace

EnvironmentMap::Sight EnvironmentMap::look(Vec3 w) const {
    const Vec2 uv = to_square(w);
    return layout_ == Layout::equal_area ? nearest(uv)
                                         : interpolated(uv, std::sqrt(w.x * w.x + w.y * w.y));
}

void EnvironmentMap::prefetch(Vec3 w) const {
    const Vec2 uv = to_square(w);
    if (layout_ == Layout::equal_area) {
        __builtin_prefetch(&nearest_texel(uv));
        return;
    }
    const Rgb* upper = &texel(position(uv.x, width_).index, position(uv.y, height_).index);
    __builtin_prefetch(upper);
    __builtin_prefetch(upper + (width_ + 2));
}

const Rgb& EnvironmentMap::nearest_texel(Vec2 uv) const {
    // A coordinate that is not a number gets any texel: its sample is rejected later.
    const auto index = [](float s, int n) {
        return s > 0 ? static_cast<int>(std::min(s * float(n), float(n - 1))) : 0;
    };
    return texel(index(uv.x, width_), index(uv.y, height_));
}

EnvironmentMap::Sight EnvironmentMap::nearest(Vec2 uv) const {
    const Rgb& c = nearest_texel(uv);
    return {c, density_ * drawn(c)};
}

EnvironmentMap::Sight EnvironmentMap::interpolated(Vec2 uv, float polar_sine) const {
    const Position x = position(uv.x, width_), y = position(uv.y, height_);
    const Rgb* upper = &texel(x.index, y.index);
    const Rgb* lower = upper + (width_ + 2);
    const float* sine = &row_sine_[static_cast<size_t>(y.index + 1)];
    const auto weight = [&](const Rgb* row) {
        return std::lerp(drawn(row[0]), drawn(row[1]), x.fraction);
    };
    const float sum =
        weight(upper) * sine[0] * (1 - y.fraction) + weight(lower) * sine[1] * y.fraction;
    return {lerp(y.fraction, lerp(x.fraction, upper[0], upper[1]),
                 lerp(x.fraction, lower[0], lower[1])),
            polar_sine > 0 ? density_ * sum / polar_sine : 0.0f};
}

Vec2 EnvironmentMap::to_square(Vec3 w) const {
    if (layout_ == Layout::equal_area) return equal_area_sphere_to_square(w);
    const float phi = arctangent(w.y, w.x);
    const float theta = arctangent(std::sqrt(w.x * w.x + w.y * w.y), w.z);
    return {(phi < 0 ? phi + 2 * kPi : phi) / (2 * kPi), theta / kPi};
}

Vec3 EnvironmentMap::to_direction(Vec2 uv) const {
    if (layout_ == Layout::equal_area) return equal_area_square_to_sphere(uv);
    const SinCos phi = sin_cos(2 * kPi * uv.x), theta = sin_cos(kPi * uv.y);
    return {theta.sin * phi.cos, theta.sin * phi.sin, theta.cos};
}

float EnvironmentMap::solid_angle(int y) const {
    if (layout_ == Layout::equal_area) return 4 * kPi / (float(width_) * float(height_));
    const float d_theta = kPi / float(height_);
    return 2 * kPi / float(width_) * 2 * std::sin(d_theta / 2) *
           row_sine_[static_cast<size_t>(y + 1)];
}

void EnvironmentMap::set_means() {
    // Rows are summed first, each by one thread, and then added in their order, so that the sum
    // does not depend on threads.
    const auto mean = [&](const auto& of_texel) {
        std::vector<std::array<double, 3>> rows(static_cast<size_t>(height_));
        parallel_for(height_, [&](int64_t y) {
            std::array<double, 3> sum{};
            for (int x = 0; x < width_; ++x) {
                const Rgb c = of_texel(texel(x, static_cast<int>(y)));
                for (int k = 0; k < 3; ++k) sum[static_cast<size_t>(k)] += double(c[k]);
            }
            for (double& channel : sum) channel *= double(solid_angle(static_cast<int>(y)));
            rows[static_cast<size_t>(y)] = sum;
        });
        std::array<double, 3> all{};
        for (const auto& row : rows)
            for (size_t k = 0; k < 3; ++k) all[k] += row[k];
        for (double& channel : all) channel /= 4 * double(kPi);
        return Rgb(static_cast<float>(all[0]), static_cast<float>(all[1]),
                   static_cast<float>(all[2]));
    };
    mean_ = mean([](Rgb c) { return c; });
    const float whole = choice_weight(mean_);
    left_out_ = kLeftOut * whole;
    if (whole > 0) drawn_share_ = mean([&](Rgb c) { return Rgb(drawn(c)); }).r / whole;
}

void EnvironmentMap::build_distribution() {
    const auto w = static_cast<size_t>(width_), h = static_cast<size_t>(height_);
    columns_ = TableCdf(h, w);
    std::vector<double> rows(h);
    parallel_for(height_, [&](int64_t row) {
        const int y = static_cast<int>(row);
        // The weight of a texel is the mean, over its area, of the bilinear interpolation between
        // its centre's weight and its neighbours'.
        const auto column = [&](int x) {
            return 0.125 * weight(x, y - 1) + 0.75 * weight(x, y) + 0.125 * weight(x, y + 1);
        };
        std::vector<double> cumulated(w);
        double sum = 0;
        for (int x = 0; x < width_; ++x) {
            sum += layout_ == Layout::equal_area
                       ? double(weight(x, y))
                       : 0.125 * column(x - 1) + 0.75 * column(x) + 0.125 * column(x + 1);
            cumulated[static_cast<size_t>(x)] = sum;
        }
        columns_.set_row(static_cast<size_t>(row), cumulated);
        rows[static_cast<size_t>(row)] = sum;
    });
    std::partial_sum(rows.begin(), rows.end(), rows.begin());
    rows_ = TableCdf(rows);
    const double mean = rows.back() / (double(w) * double(h));
    const double sphere = layout_ == Layout::equal_area ? 4 * double(kPi) : 2 * sqr(double(kPi));
    if (mean > 0) density_ = static_cast<float>(1 / (sphere * mean));
}

EnvironmentMap::Draw EnvironmentMap::begin_draw(Vec2 u) const {
    Draw draw{u};
    draw.row = rows_.sample(draw.u.y);
    draw.column = columns_.begin(u.x, draw.row);
    return draw;
}

void EnvironmentMap::choose_texel(Draw& draw) const {
    draw.column = columns_.finish(draw.column, draw.u.x, draw.row);
    const int beside = layout_ == Layout::equal_area ? 0 : 1;
    for (int j = -beside; j <= beside; ++j)
        __builtin_prefetch(&texel(static_cast<int>(draw.column), static_cast<int>(draw.row) + j));
}

Vec3 EnvironmentMap::sample(Vec2 u) const {
    Draw draw = begin_draw(u);
    choose_texel(draw);
    return direction(draw);
}

Vec3 EnvironmentMap::direction(const Draw& draw) const {
    Vec2 u = draw.u;
    const size_t x = draw.column, y = draw.row;
    if (layout_ == Layout::equal_area)
        return to_direction({(float(x) + u.x) / float(width_), (float(y) + u.y) / float(height_)});
    // Interpolation is bilinear in each quarter of the texel: values at its corners, edges and
    // centre.
    std::array<std::array<float, 3>, 3> g;
    for (int j = -1; j <= 1; ++j) {
        const auto at = [&](int i) {
            return weight(static_cast<int>(x) + i, static_cast<int>(y) + j);
        };
        const float a = at(-1), b = at(0), c = at(1);
        g[static_cast<size_t>(j + 1)] = {(a + b) / 2, b, (b + c) / 2};
    }
    for (size_t i = 0; i < 3; ++i) {
        const float a = g[0][i], b = g[1][i], c = g[2][i];
        g[0][i] = (a + b) / 2;
        g[2][i] = (b + c) / 2;
    }
    const auto quarter = [&g](size_t j, size_t i) {
        return g[j][i] + g[j][i + 1] + g[j + 1][i] + g[j + 1][i + 1];
    };
    const size_t j =
        choose_second(quarter(0, 0) + quarter(0, 1), quarter(1, 0) + quarter(1, 1), u.y);
    const size_t i = choose_second(quarter(j, 0), quarter(j, 1), u.x);
    const float t = sample_linear(g[j][i] + g[j][i + 1], g[j + 1][i] + g[j + 1][i + 1], u.y);
    const float s = sample_linear(g[j][i] * (1 - t) + g[j + 1][i] * t,
                                  g[j][i + 1] * (1 - t) + g[j + 1][i + 1] * t, u.x);
    return to_direction({(float(x) + (float(i) + s) / 2) / float(width_),
                         (float(y) + (float(j) + t) / 2) / float(height_)});
}

Rgb EnvironmentMap::irradiance_from_above() const {
    double sum[3] = {};
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
            const Vec3 w = to_direction(
                {(float(x) + 0.5f) / float(width_), (float(y) + 0.5f) / float(height_)});
            const double projected = double(std::max(0.0f, w.z)) * solid_angle(y);
            for (int c = 0; c < 3; ++c) sum[c] += projected * texel(x, y)[c];
        }
    return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
}

}  // namespace covtrace
