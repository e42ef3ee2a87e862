#include "gltf/deformation.h"

#include <cmath>

#include "gltf/accessor.h"

namespace covtrace::gltf {
namespace {

/// Most sets of joints, of four each, that a vertex may have; files have one or two.
constexpr size_t kMostSets = 8;

using Matrix3x4 = std::array<std::array<double, 4>, 3>;

/// A number as the type T. Joints that are no index become one that no skin has.
template <typename T>
T number(float v) {
    if constexpr (std::is_same_v<T, uint32_t>)
        return v >= 0 && v < 65536 ? static_cast<uint32_t>(v) : ~uint32_t{0};
    else
        return v;
}

template <typename T>
std::vector<T> pick(const Numbers& n, std::span<const uint32_t> kept) {
    const size_t count = kept.empty() ? n.count() : kept.size();
    std::vector<T> result;
    result.reserve(count * n.components);
    for (size_t i = 0; i < count; ++i) {
        const float* v = n.element(kept.empty() ? i : kept[i]);
        if constexpr (std::is_same_v<T, Vec3>)
            result.push_back({v[0], v[1], v[2]});
        else
            for (size_t c = 0; c < n.components; ++c) result.push_back(number<T>(v[c]));
    }
    return result;
}

void blend(std::vector<Vec3>& values, const std::vector<Vec3>& differences, double weight) {
    for (size_t i = 0; i < std::min(values.size(), differences.size()); ++i)
        values[i] = values[i] + differences[i] * static_cast<float>(weight);
}

Vec3 transformed(const Matrix3x4& m, Vec3 p) {
    const auto row = [&](size_t i) {
        return static_cast<float>(m[i][0] * double(p.x) + m[i][1] * double(p.y) +
                                  m[i][2] * double(p.z) + m[i][3]);
    };
    return {row(0), row(1), row(2)};
}

/// The normal after the map m, by the cofactors of its upper left 3x3: these are the inverse
/// transpose up to a factor, without a division.
Vec3 transformed_normal(const Matrix3x4& m, Vec3 n) {
    const auto cofactor = [&](size_t i, size_t j) {
        const size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
        return m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
    };
    std::array<double, 3> r{};
    for (size_t i = 0; i < 3; ++i)
        r[i] = cofactor(i, 0) * double(n.x) + cofactor(i, 1) * double(n.y) +
               cofactor(i, 2) * double(n.z);
    const double length = std::hypot(r[0], r[1], r[2]);
    if (!(length > 0) || !std::isfinite(length)) return n;
    return {static_cast<float>(r[0] / length), static_cast<float>(r[1] / length),
            static_cast<float>(r[2] / length)};
}

void skin(TriangleMesh& mesh, const Deformation& deformation, std::span<const Matrix4> joints) {
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
        Matrix3x4 m{};
        for (size_t k = i * deformation.influences; k < (i + 1) * deformation.influences; ++k) {
            const double weight = double(deformation.weights[k]);
            if (weight == 0) continue;
            const Matrix4& joint = joints[deformation.joints[k]];
            for (size_t row = 0; row < 3; ++row)
                for (size_t column = 0; column < 4; ++column)
                    m[row][column] += weight * joint.m[row][column];
        }
        mesh.positions[i] = transformed(m, mesh.positions[i]);
        if (!mesh.normals.empty()) mesh.normals[i] = transformed_normal(m, mesh.normals[i]);
    }
}

/// Makes the weights of each vertex sum to 1, as the specification demands of files: then vertices
/// stay where all of their joints agree.
void normalise(Deformation& d, size_t vertices) {
    for (size_t i = 0; i < vertices; ++i) {
        const auto begin = d.weights.begin() + static_cast<std::ptrdiff_t>(i * d.influences);
        float sum = 0;
        for (size_t k = 0; k < d.influences; ++k) sum += std::max(begin[std::ptrdiff_t(k)], 0.0f);
        for (size_t k = 0; k < d.influences; ++k) {
            float& w = begin[std::ptrdiff_t(k)];
            w = sum > 0 ? std::max(w, 0.0f) / sum : (k == 0 ? 1.0f : 0.0f);
        }
    }
}

}  // namespace

Deformation read_deformation(const Document& document, const tinygltf::Primitive& primitive,
                             size_t count, std::span<const uint32_t> kept,
                             const std::string& place) {
    Deformation result;
    const auto read = [&](const std::map<std::string, int>& attributes, const std::string& name,
                          size_t components, const std::string& where) {
        const auto it = attributes.find(name);
        if (it == attributes.end()) return Numbers{};
        Numbers n = read_numbers(document, it->second, components, where + name);
        if (n.count() != count)
            document.refuse(where + name, "has " + std::to_string(n.count()) +
                                              " elements; expected " + std::to_string(count) +
                                              ", one per position");
        return n;
    };
    for (size_t t = 0; t < primitive.targets.size(); ++t) {
        const std::string where = place + "." + element("targets", t) + ".";
        const auto vectors = [&](const char* name) {
            const Numbers n = read(primitive.targets[t], name, 3, where);
            return n.components == 0 ? std::vector<Vec3>{} : pick<Vec3>(n, kept);
        };
        result.targets.push_back({vectors("POSITION"), vectors("NORMAL")});
    }
    const size_t vertices = kept.empty() ? count : kept.size();
    for (size_t set = 0; set < kMostSets; ++set) {
        const std::string number = std::to_string(set), where = place + ".attributes.";
        const Numbers joints = read(primitive.attributes, "JOINTS_" + number, 4, where);
        const Numbers weights = read(primitive.attributes, "WEIGHTS_" + number, 4, where);
        if (joints.components == 0 || weights.components == 0) break;
        const auto j = pick<uint32_t>(joints, kept);
        const auto w = pick<float>(weights, kept);
        // Sets of four joints lie one behind the other in the file; here a vertex has all of its
        // joints side by side.
        const size_t before = result.influences;
        std::vector<uint32_t> all_joints;
        std::vector<float> all_weights;
        for (size_t i = 0; i < vertices; ++i) {
            for (size_t k = 0; k < before; ++k) {
                all_joints.push_back(result.joints[i * before + k]);
                all_weights.push_back(result.weights[i * before + k]);
            }
            all_joints.insert(all_joints.end(), &j[4 * i], &j[4 * i] + 4);
            all_weights.insert(all_weights.end(), &w[4 * i], &w[4 * i] + 4);
        }
        result.joints = std::move(all_joints);
        result.weights = std::move(all_weights);
        result.influences = before + 4;
    }
    normalise(result, vertices);
    return result;
}

TriangleMesh deform(const Document& document, const TriangleMesh& rest,
                    const Deformation& deformation, std::span<const double> weights,
                    std::span<const Matrix4> joints, const std::string& place) {
    TriangleMesh mesh = rest;
    // Tangents are not deformed: those of the texture coordinates take their place.
    mesh.tangents.clear();
    mesh.map_signs.clear();
    for (size_t t = 0; t < std::min(deformation.targets.size(), weights.size()); ++t) {
        if (weights[t] == 0) continue;
        blend(mesh.positions, deformation.targets[t].positions, weights[t]);
        blend(mesh.normals, deformation.targets[t].normals, weights[t]);
    }
    if (deformation.influences > 0 && !joints.empty()) {
        for (size_t k = 0; k < deformation.joints.size(); ++k)
            if (deformation.weights[k] > 0 && deformation.joints[k] >= joints.size())
                document.refuse(place, "joint " + std::to_string(deformation.joints[k]) +
                                           " is beyond the skin's " +
                                           std::to_string(joints.size()) + " joints");
        skin(mesh, deformation, joints);
    }
    for (const Vec3& p : mesh.positions)
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
            document.refuse(place, "a vertex is moved to where no number is finite");
    return mesh;
}

}  // namespace covtrace::gltf
