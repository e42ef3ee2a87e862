#include "integrator/displacement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <unordered_map>
#include <vector>

#include "core/parallel.h"

namespace covtrace {

namespace {

constexpr size_t kMostTriangles = size_t{1} << 26;

/// Unit normals of a mesh' vertices: the mean direction of those of the triangles around them.
std::vector<Vec3> vertex_normals(const TriangleMesh& mesh) {
    std::vector<Vec3> normals(mesh.positions.size());
    for (const auto& t : mesh.triangles) {
        const Vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
        const Vec3 n = normalize(cross(b - a, c - b));
        for (const uint32_t v : t) normals[v] += n;
    }
    for (Vec3& n : normals) n = normalize(n);
    return normals;
}

/// Splits triangles at the middle of their longest edge, again and again. Edges are split where
/// they are too long, whichever triangle they belong to, so that neighbours stay joined.
class Splitter {
  public:
    Splitter(TriangleMesh& mesh, const Transform& to_world, const Displacement& displacement,
             const SourceLocation& where)
        : mesh_(mesh), to_world_(to_world), longest_(displacement.edge_length), where_(where) {}

    void run() {
        // No triangle that is left is larger than one of three edges of full length
        const double largest = std::sqrt(3.0) / 4 * double(longest_) * double(longest_);
        if (area() > largest * double(kMostTriangles)) refuse();
        std::vector<std::array<uint32_t, 3>> open = std::move(mesh_.triangles);
        mesh_.triangles.clear();
        while (!open.empty()) {
            const std::array<uint32_t, 3> t = open.back();
            open.pop_back();
            split(t, open);
            if (open.size() + mesh_.triangles.size() > kMostTriangles) refuse();
        }
    }

  private:
    [[noreturn]] void refuse() const {
        throw Error(ErrorKind::limit, where_,
                    "the displacement makes more than 2^26 triangles; expected a longer "
                    "\"edgelength\"");
    }

    /// Area of the mesh in the world.
    double area() const {
        double sum = 0;
        for (const auto& t : mesh_.triangles) {
            const Vec3 a = to_world_.point(mesh_.positions[t[0]]);
            sum += 0.5 * double(length(cross(to_world_.point(mesh_.positions[t[1]]) - a,
                                             to_world_.point(mesh_.positions[t[2]]) - a)));
        }
        return sum;
    }

    void split(const std::array<uint32_t, 3>& t, std::vector<std::array<uint32_t, 3>>& open) {
        const std::array<float, 3> edges{length_of(t[0], t[1]), length_of(t[1], t[2]),
                                         length_of(t[2], t[0])};
        const auto longest = size_t(std::max_element(edges.begin(), edges.end()) - edges.begin());
        if (edges[longest] < longest_) {
            mesh_.triangles.push_back(t);
            return;
        }
        const uint32_t a = t[longest], b = t[(longest + 1) % 3], c = t[(longest + 2) % 3];
        const uint32_t middle = middle_of(a, b);
        open.push_back({a, middle, c});
        open.push_back({middle, b, c});
    }

    float length_of(uint32_t a, uint32_t b) const {
        return distance(to_world_.point(mesh_.positions[a]), to_world_.point(mesh_.positions[b]));
    }

    uint32_t middle_of(uint32_t a, uint32_t b) {
        const uint64_t edge = uint64_t(std::min(a, b)) << 32 | std::max(a, b);
        const auto [it, is_new] =
            middles_.try_emplace(edge, static_cast<uint32_t>(mesh_.positions.size()));
        if (is_new) {
            mesh_.positions.push_back((mesh_.positions[a] + mesh_.positions[b]) / 2);
            mesh_.normals.push_back(normalize(mesh_.normals[a] + mesh_.normals[b]));
            mesh_.uvs.push_back((mesh_.uvs[a] + mesh_.uvs[b]) * 0.5f);
        }
        return it->second;
    }

    TriangleMesh& mesh_;
    const Transform& to_world_;
    const float longest_;
    const SourceLocation& where_;
    std::unordered_map<uint64_t, uint32_t> middles_;
};

void displace(ShapeDescription& shape, const TextureStore& textures) {
    const Displacement displacement = *shape.displacement;
    shape.displacement.reset();
    auto mesh = std::make_shared<TriangleMesh>(
        *std::get<std::shared_ptr<const TriangleMesh>>(shape.geometry));
    const Transform& to_world = shape.object_to_world.start();
    if (mesh->normals.empty()) mesh->normals = vertex_normals(*mesh);
    Splitter(*mesh, to_world, displacement, shape.where).run();
    constexpr size_t kPerTask = 4096;
    const size_t count = mesh->positions.size();
    parallel_for(int64_t((count + kPerTask - 1) / kPerTask), [&](int64_t task) {
        const size_t first = size_t(task) * kPerTask;
        for (size_t i = first; i < std::min(first + kPerTask, count); ++i) {
            Vec3& p = mesh->positions[i];
            p += mesh->normals[i] *
                 textures.eval_float(displacement.height, {mesh->uvs[i], to_world.point(p)});
            if (!is_finite(p))
                throw Error(ErrorKind::scene, shape.where,
                            "the displacement is not finite everywhere");
        }
    });
    mesh->normals = vertex_normals(*mesh);
    shape.geometry = std::shared_ptr<const TriangleMesh>(std::move(mesh));
}

}  // namespace

SceneDescription& displace(SceneDescription& scene, const TextureStore& textures) {
    const auto all = [&](std::vector<ShapeDescription>& shapes) {
        for (ShapeDescription& s : shapes)
            if (s.displacement) displace(s, textures);
    };
    all(scene.shapes);
    for (ObjectDescription& o : scene.objects) all(o.shapes);
    return scene;
}

}  // namespace covtrace
