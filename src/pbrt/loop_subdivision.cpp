#include "pbrt/loop_subdivision.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace covtrace {

namespace {

using Triangle = std::array<uint32_t, 3>;

struct Edge {
    uint32_t a = 0, b = 0;  ///< a < b
    int faces = 0;
    Vec3 opposite_sum;  ///< sum of the third corners of its first two faces
    bool is_border() const { return faces != 2; }
};

/// Neighbours of a vertex, as far as the rules of subdivision need them.
struct Ring {
    int valence = 0, borders = 0;
    Vec3 sum, border_sum;
};

struct Topology {
    std::vector<Edge> edges;
    std::vector<Triangle> edge_of;  ///< for each triangle, the edges from corner i to corner i + 1
    std::vector<Ring> rings;
};

Topology topology(const std::vector<Vec3>& p, const std::vector<Triangle>& triangles) {
    struct HalfEdge {
        uint32_t a, b, triangle, corner;
    };
    std::vector<HalfEdge> half;
    half.reserve(3 * triangles.size());
    for (uint32_t t = 0; t < triangles.size(); ++t)
        for (uint32_t c = 0; c < 3; ++c) {
            const uint32_t v = triangles[t][c], w = triangles[t][(c + 1) % 3];
            half.push_back({std::min(v, w), std::max(v, w), t, c});
        }
    std::sort(half.begin(), half.end(), [](const HalfEdge& x, const HalfEdge& y) {
        return std::tie(x.a, x.b, x.triangle, x.corner) < std::tie(y.a, y.b, y.triangle, y.corner);
    });
    Topology m;
    m.edge_of.resize(triangles.size());
    m.rings.resize(p.size());
    for (const HalfEdge& h : half) {
        if (m.edges.empty() || m.edges.back().a != h.a || m.edges.back().b != h.b)
            m.edges.push_back({h.a, h.b, 0, {}});
        Edge& e = m.edges.back();
        if (++e.faces <= 2) e.opposite_sum += p[triangles[h.triangle][(h.corner + 2) % 3]];
        m.edge_of[h.triangle][h.corner] = static_cast<uint32_t>(m.edges.size() - 1);
    }
    for (const Edge& e : m.edges)
        for (const auto& [self, other] : {std::pair{e.a, e.b}, std::pair{e.b, e.a}}) {
            Ring& r = m.rings[self];
            ++r.valence;
            r.sum += p[other];
            if (!e.is_border()) continue;
            ++r.borders;
            r.border_sum += p[other];
        }
    return m;
}

float neighbour_weight(int valence) {
    return valence == 3 ? 3.0f / 16 : 3.0f / (8 * static_cast<float>(valence));
}

/// Moves a vertex by weights for its neighbours, one weight inside and one on a border.
Vec3 moved(Vec3 p, const Ring& r, float inside_weight, float border_weight) {
    if (r.valence == 0) return p;
    if (r.borders == 0)
        return (1 - static_cast<float>(r.valence) * inside_weight) * p + inside_weight * r.sum;
    if (r.borders == 2) return (1 - 2 * border_weight) * p + border_weight * r.border_sum;
    return p;
}

void refine(std::vector<Vec3>& p, std::vector<Triangle>& triangles) {
    const Topology m = topology(p, triangles);
    std::vector<Vec3> finer(p.size() + m.edges.size());
    for (size_t i = 0; i < p.size(); ++i)
        finer[i] = moved(p[i], m.rings[i], neighbour_weight(m.rings[i].valence), 1.0f / 8);
    for (size_t i = 0; i < m.edges.size(); ++i) {
        const Edge& e = m.edges[i];
        const Vec3 ends = p[e.a] + p[e.b];
        finer[p.size() + i] = e.is_border() ? 0.5f * ends : 0.375f * ends + 0.125f * e.opposite_sum;
    }
    std::vector<Triangle> split;
    split.reserve(4 * triangles.size());
    const auto first_edge_vertex = static_cast<uint32_t>(p.size());
    for (size_t t = 0; t < triangles.size(); ++t) {
        const Triangle& v = triangles[t];
        Triangle e = m.edge_of[t];
        for (uint32_t& i : e) i += first_edge_vertex;
        split.push_back({v[0], e[0], e[2]});
        split.push_back({e[0], v[1], e[1]});
        split.push_back({e[2], e[1], v[2]});
        split.push_back({e[0], e[1], e[2]});
    }
    p = std::move(finer);
    triangles = std::move(split);
}

/// The neighbours of each vertex in order around it; empty where they make no single fan.
class OrderedRings {
  public:
    OrderedRings(size_t vertices, const std::vector<Triangle>& triangles) : begin_(vertices + 1) {
        for (const Triangle& t : triangles)
            for (const uint32_t v : t) ++begin_[v + 1];
        for (size_t i = 0; i < vertices; ++i) begin_[i + 1] += begin_[i];
        links_.resize(begin_.back());
        std::vector<size_t> next = begin_;
        for (const Triangle& t : triangles)
            for (size_t c = 0; c < 3; ++c) links_[next[t[c]]++] = {t[(c + 1) % 3], t[(c + 2) % 3]};
        for (size_t v = 0; v < vertices; ++v) std::sort(first(v), last(v));
    }

    std::vector<uint32_t> around(size_t v) {
        const auto count = static_cast<size_t>(last(v) - first(v));
        if (count == 0 || count > kLargestFan) return {};
        uint32_t start = first(v)->from;
        for (auto it = first(v); it != last(v); ++it) {
            // A neighbour that no triangle leads to begins the fan of a border vertex.
            const bool is_target =
                std::any_of(first(v), last(v), [&](const Link& l) { return l.to == it->from; });
            if (!is_target) start = it->from;
        }
        std::vector<uint32_t> ring{start};
        for (size_t i = 0; i < count; ++i) {
            const auto it = std::lower_bound(first(v), last(v), Link{ring.back(), 0});
            if (it == last(v) || it->from != ring.back()) return {};
            if (it->to == start) return i + 1 == count ? ring : std::vector<uint32_t>{};
            ring.push_back(it->to);
        }
        return ring;
    }

  private:
    /// Most neighbours of a vertex for which a smooth normal is worth the search.
    static constexpr size_t kLargestFan = 1024;
    struct Link {
        uint32_t from = 0, to = 0;
        bool operator<(const Link& o) const { return from != o.from ? from < o.from : to < o.to; }
    };
    std::vector<Link>::iterator first(size_t v) {
        return links_.begin() + static_cast<std::ptrdiff_t>(begin_[v]);
    }
    std::vector<Link>::iterator last(size_t v) {
        return links_.begin() + static_cast<std::ptrdiff_t>(begin_[v + 1]);
    }
    std::vector<size_t> begin_;
    std::vector<Link> links_;
};

/// Cross product of the limit surface's tangents, on the side that pbrt calls outside: the one from
/// which the corners of triangles are seen clockwise. `ring`: the neighbours in the triangles'
/// order, open at a border.
Vec3 limit_normal(const std::vector<Vec3>& p, Vec3 centre, const std::vector<uint32_t>& ring,
                  bool is_border) {
    const size_t n = ring.size();
    if (n < (is_border ? 2u : 3u)) return {};
    Vec3 s, t;
    if (!is_border) {
        for (size_t i = 0; i < n; ++i) {
            const float angle = 2 * kPi * static_cast<float>(i) / static_cast<float>(n);
            s += std::cos(angle) * p[ring[i]];
            t += std::sin(angle) * p[ring[i]];
        }
        return cross(t, s);  // pbrt goes around the other way
    }
    const auto at = [&](size_t i) { return p[ring[i]]; };
    s = at(n - 1) - at(0);
    if (n == 2) {
        t = at(0) + at(1) - 2 * centre;
    } else if (n == 3) {
        t = at(1) - centre;
    } else if (n == 4) {
        t = 2 * at(1) + 2 * at(2) - at(0) - at(3) - 2 * centre;
    } else {
        const float angle = kPi / static_cast<float>(n - 1);
        t = -std::sin(angle) * (at(0) + at(n - 1));
        for (size_t i = 1; i + 1 < n; ++i)
            t += (2 - 2 * std::cos(angle)) * std::sin(static_cast<float>(i) * angle) * at(i);
    }
    return cross(s, t);
}

/// Normals of the limit surface from the control points `p`; where there is no tangent plane, the
/// mean of the faces of `limit`. They are opposite to (p1 - p0) x (p2 - p0), as in pbrt, for which
/// vertex normals decide which side is outside.
std::vector<Vec3> normals(const std::vector<Vec3>& p, const std::vector<Vec3>& limit,
                          const std::vector<Triangle>& triangles, const Topology& m) {
    std::vector<Vec3> face_normals(p.size());
    for (const Triangle& t : triangles) {
        const Vec3 n = cross(limit[t[2]] - limit[t[0]], limit[t[1]] - limit[t[0]]);
        for (const uint32_t v : t) face_normals[v] += n;
    }
    OrderedRings rings(p.size(), triangles);
    std::vector<Vec3> all(p.size());
    for (size_t v = 0; v < p.size(); ++v) {
        Vec3 n = normalize(limit_normal(p, p[v], rings.around(v), m.rings[v].borders > 0));
        const Vec3 faces = normalize(face_normals[v]);
        if (!(length(n) > 0.5f) || !is_finite(n)) n = faces;
        if (!(length(n) > 0.5f) || !is_finite(n)) n = {0, 0, 1};
        all[v] = n;
    }
    return all;
}

}  // namespace

TriangleMesh loop_subdivide(const std::vector<Vec3>& positions,
                            const std::vector<Triangle>& triangles, int levels,
                            const SourceLocation& where) {
    TriangleMesh mesh;
    mesh.positions = positions;
    mesh.triangles = triangles;
    for (int i = 0; i < levels; ++i) refine(mesh.positions, mesh.triangles);
    const Topology m = topology(mesh.positions, mesh.triangles);
    std::vector<Vec3> limit(mesh.positions.size());
    for (size_t i = 0; i < limit.size(); ++i) {
        const Ring& r = m.rings[i];
        const float n = static_cast<float>(r.valence);
        limit[i] =
            moved(mesh.positions[i], r, 1 / (n + 3 / (8 * neighbour_weight(r.valence))), 1.0f / 5);
        if (!is_finite(limit[i]))
            throw Error(ErrorKind::scene, where,
                        "the subdivided surface has coordinates that are too large");
    }
    mesh.normals = normals(mesh.positions, limit, mesh.triangles, m);
    mesh.positions = std::move(limit);
    return mesh;
}

}  // namespace covtrace
