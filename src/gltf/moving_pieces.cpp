#include "gltf/moving_pieces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <queue>

#include "core/decomposition.h"
#include "core/symmetric_eigen.h"

namespace covtrace::gltf {
namespace {

using Matrix3 = SquareMatrix<3>;
using Triangle = std::array<uint32_t, 3>;

/// Most pieces of a mesh. Joints bend in a few steps each; every piece is an instance that moves.
constexpr size_t kMostPieces = 256;
/// Ridge of the regression: square of a share of a piece's extent. Directions below a tenth of the
/// extent hardly stretch: noise would make of them stretches that turn normals until patches go
/// dark (docs/decisions/0057).
constexpr double kRidge = 1e-2;
/// Most that a piece's volume may be stretched or squeezed; a piece that is squeezed to nothing
/// can't be undone.
constexpr double kMostStretch = 20;

std::array<double, 3> mean(std::span<const Vec3> points) {
    std::array<double, 3> sum{};
    for (const Vec3& p : points) sum = {sum[0] + p.x, sum[1] + p.y, sum[2] + p.z};
    const auto n = static_cast<double>(points.size());
    return {sum[0] / n, sum[1] / n, sum[2] / n};
}

std::array<double, 3> offset(Vec3 p, const std::array<double, 3>& from) {
    return {double(p.x) - from[0], double(p.y) - from[1], double(p.z) - from[2]};
}

/// The rotation that takes start nearest to end: its quaternion is the eigenvector of the largest
/// eigenvalue of Horn's matrix. `s`: sums of products of the start's i and the end's j, both from
/// their means.
Matrix4 nearest_rotation(const Matrix3& s) {
    const SymmetricEigen<4> e = symmetric_eigen<4>(
        {{{s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]},
          {s[1][2] - s[2][1], s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2]},
          {s[2][0] - s[0][2], s[0][1] + s[1][0], s[1][1] - s[0][0] - s[2][2], s[1][2] + s[2][1]},
          {s[0][1] - s[1][0], s[2][0] + s[0][2], s[1][2] + s[2][1], s[2][2] - s[0][0] - s[1][1]}}});
    const auto largest = std::max_element(e.values.begin(), e.values.end()) - e.values.begin();
    const auto& [w, x, y, z] = e.vectors[static_cast<size_t>(largest)];
    Matrix4 m;
    m.m[0] = {1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 0};
    m.m[1] = {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), 0};
    m.m[2] = {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), 0};
    return m;
}

/// The rotation `turn` followed by the least squares stretch of what it leaves: across^T - turn
/// spread over spread.
Matrix4 stretched(const Matrix4& turn, const Matrix3& across, const Matrix3& spread) {
    const double trace = spread[0][0] + spread[1][1] + spread[2][2];
    if (!(trace > 0)) return turn;
    Matrix4 left, ridged;
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j) {
            double turned = 0;
            for (size_t k = 0; k < 3; ++k) turned += turn.m[i][k] * spread[k][j];
            left.m[i][j] = across[j][i] - turned;
            ridged.m[i][j] = spread[i][j] / trace + (i == j ? kRidge : 0);
        }
    left.m[3][3] = 0;
    const auto inverted = inverse(ridged);
    if (!inverted) return turn;
    const Matrix4 difference = left * *inverted;
    Matrix4 m = turn;
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j) m.m[i][j] += difference.m[i][j] / trace;
    const auto& r = m.m;
    const double volume = r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1]) -
                          r[0][1] * (r[1][0] * r[2][2] - r[1][2] * r[2][0]) +
                          r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]);
    return volume > 1 / kMostStretch && volume < kMostStretch ? m : turn;
}

double distance_after(const Matrix4& m, Vec3 start, Vec3 end) {
    const std::array<double, 3> p{start.x, start.y, start.z}, q{end.x, end.y, end.z};
    double sum = 0;
    for (size_t i = 0; i < 3; ++i) {
        const double d = m.m[i][0] * p[0] + m.m[i][1] * p[1] + m.m[i][2] * p[2] + m.m[i][3] - q[i];
        sum += d * d;
    }
    return std::sqrt(sum);
}

/// Cuts a mesh into pieces: the worst one is halved next.
class Cutter {
  public:
    Cutter(std::span<const Vec3> start, std::span<const Vec3> end,
           std::span<const Triangle> triangles)
        : start_(start), end_(end), triangles_(triangles) {}

    MovingPieces cut() {
        double way = 0;
        for (size_t i = 0; i < start_.size(); ++i)
            way = std::max(way, distance_after({}, start_[i], end_[i]));
        for (auto& group : connected()) queue_.push(fit(std::move(group)));
        while (queue_.size() < kMostPieces && queue_.top().gain() > kLeft * way) {
            std::vector<uint32_t> worst = queue_.top().piece.triangles;
            queue_.pop();
            for (auto& half : halves(std::move(worst))) queue_.push(fit(std::move(half)));
        }
        MovingPieces result;
        for (; !queue_.empty(); queue_.pop()) {
            if (way > 0) result.left = std::max(result.left, queue_.top().left / way);
            result.pieces.push_back(queue_.top().piece);
        }
        std::sort(result.pieces.begin(), result.pieces.end(),
                  [](const auto& a, const auto& b) { return a.triangles[0] < b.triangles[0]; });
        return result;
    }

  private:
    struct Fitted {
        double left = 0;
        MovingPiece piece;
        /// The error that halving the piece may remove.
        double gain() const { return piece.triangles.size() > 1 ? left : 0; }
        /// Ties are broken by place, so that the order is the same everywhere.
        bool operator<(const Fitted& other) const {
            return gain() != other.gain() ? gain() < other.gain()
                                          : piece.triangles[0] > other.piece.triangles[0];
        }
    };

    /// Groups of connected triangles: those that share vertices, or have vertices that are at one
    /// place at both times, as files split these at creases and seams. One group of all triangles
    /// where there would be more groups than pieces may be.
    std::vector<std::vector<uint32_t>> connected() const {
        std::vector<uint32_t> parent(start_.size());
        std::iota(parent.begin(), parent.end(), 0);
        const auto root = [&](uint32_t i) {
            while (parent[i] != i) i = parent[i] = parent[parent[i]];
            return i;
        };
        const auto join = [&](uint32_t a, uint32_t b) {
            a = root(a), b = root(b);
            parent[std::max(a, b)] = std::min(a, b);
        };
        std::vector<uint32_t> order(start_.size());
        std::iota(order.begin(), order.end(), 0);
        const auto key = [&](uint32_t i) {
            const Vec3 &a = start_[i], &b = end_[i];
            return std::array{a.x, a.y, a.z, b.x, b.y, b.z};
        };
        std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
            const auto ka = key(a), kb = key(b);
            return ka != kb ? ka < kb : a < b;
        });
        for (size_t i = 1; i < order.size(); ++i)
            if (key(order[i]) == key(order[i - 1])) join(order[i], order[i - 1]);
        for (const Triangle& t : triangles_) join(t[0], t[1]), join(t[1], t[2]);
        std::map<uint32_t, std::vector<uint32_t>> groups;
        for (uint32_t i = 0; i < triangles_.size(); ++i)
            groups[root(triangles_[i][0])].push_back(i);
        std::vector<std::vector<uint32_t>> result;
        if (groups.size() <= kMostPieces) {
            for (auto& [_, group] : groups) result.push_back(std::move(group));
            return result;
        }
        result.emplace_back(triangles_.size());
        std::iota(result[0].begin(), result[0].end(), 0);
        return result;
    }

    Fitted fit(std::vector<uint32_t> triangles) const {
        std::vector<uint32_t> used;
        for (const uint32_t t : triangles)
            used.insert(used.end(), triangles_[t].begin(), triangles_[t].end());
        std::sort(used.begin(), used.end());
        used.erase(std::unique(used.begin(), used.end()), used.end());
        std::vector<Vec3> a(used.size()), b(used.size());
        for (size_t i = 0; i < used.size(); ++i) a[i] = start_[used[i]], b[i] = end_[used[i]];
        Fitted fitted{0, {std::move(triangles), {}}};
        if (a == b) return fitted;
        fitted.piece.motion = nearest_motion(a, b);
        for (size_t i = 0; i < a.size(); ++i)
            fitted.left = std::max(fitted.left, distance_after(fitted.piece.motion, a[i], b[i]));
        return fitted;
    }

    /// Halves a piece at the median along the longest side of the box of its triangles' middles.
    std::array<std::vector<uint32_t>, 2> halves(std::vector<uint32_t> triangles) const {
        const auto middle = [&](uint32_t t) {
            const Triangle& i = triangles_[t];
            return (start_[i[0]] + start_[i[1]] + start_[i[2]]) / 3.0f;
        };
        Bounds3 box;
        for (const uint32_t t : triangles) box.extend(middle(t));
        const Vec3 size = box.hi - box.lo;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const auto half = triangles.begin() + static_cast<std::ptrdiff_t>(triangles.size() / 2);
        std::nth_element(triangles.begin(), half, triangles.end(), [&](uint32_t a, uint32_t b) {
            const float x = middle(a)[axis], y = middle(b)[axis];
            return x != y ? x < y : a < b;
        });
        std::array<std::vector<uint32_t>, 2> result{std::vector(triangles.begin(), half),
                                                    std::vector(half, triangles.end())};
        for (auto& part : result) std::sort(part.begin(), part.end());
        return result;
    }

    std::span<const Vec3> start_, end_;
    std::span<const Triangle> triangles_;
    std::priority_queue<Fitted> queue_;
};

}  // namespace

Matrix4 nearest_motion(std::span<const Vec3> start, std::span<const Vec3> end) {
    const auto from = mean(start), to = mean(end);
    // Sums of products: `across` of the start's i with the end's j, `spread` of the start's i and
    // j.
    Matrix3 across{}, spread{};
    for (size_t k = 0; k < start.size(); ++k) {
        const auto a = offset(start[k], from), b = offset(end[k], to);
        for (size_t i = 0; i < 3; ++i)
            for (size_t j = 0; j < 3; ++j) {
                across[i][j] += a[i] * b[j];
                spread[i][j] += a[i] * a[j];
            }
    }
    const Matrix4 turn = nearest_rotation(across);
    Matrix4 m = stretched(turn, across, spread);
    for (size_t i = 0; i < 3; ++i)
        m.m[i][3] = to[i] - m.m[i][0] * from[0] - m.m[i][1] * from[1] - m.m[i][2] * from[2];
    return m;
}

Vec3 pivot(const Transform& motion, Vec3 middle) {
    constexpr float kLeastTurn = 0.01f;  // radian; its arc is 1/800 of the way off the chord
    const Quaternion q = polar_decomposition(motion.matrix()).rotation;
    const double sine = std::hypot(q.x, q.y, q.z);
    if (sine < kLeastTurn / 2) return middle;
    const double tangent = sine / q.w;  // of half the angle; infinite for half a turn
    const Vec3 axis = Vec3{float(q.x), float(q.y), float(q.z)} / static_cast<float>(sine);
    const Vec3 way = motion.point(middle) - middle, across = way - axis * dot(axis, way);
    return middle + across * 0.5f + cross(axis, across) * static_cast<float>(0.5 / tangent);
}

MovingPieces moving_pieces(std::span<const Vec3> start, std::span<const Vec3> end,
                           std::span<const Triangle> triangles) {
    return Cutter(start, end, triangles).cut();
}

}  // namespace covtrace::gltf
