#include "pbrt/ply_reader.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "pbrt/ply_header.h"
#include "scene/names.h"

namespace covtrace {

namespace {

/// Reads the numbers after the header, one by one, in any of the formats.
class NumberReader {
  public:
    NumberReader(std::string_view bytes, const PlyHeader& header,
                 std::shared_ptr<const std::string> file)
        : bytes_(bytes),
          format_(header.format),
          position_(header.size),
          last_(header.size),
          line_(header.lines + 1),
          line_begin_(header.size),
          file_(std::move(file)) {}

    /// The place of one word in the file.
    struct Place {
        int line = 0, column = 0;  ///< 0 where there are no lines
    };
    /// The place of the last number.
    Place last() const { return is_ascii() ? Place{line_, int(last_ - line_begin_) + 1} : Place{}; }
    [[noreturn]] void refuse(const std::string& text, Place at) const {
        throw Error(ErrorKind::scene, {file_, at.line, at.column}, text);
    }
    [[noreturn]] void refuse(const std::string& text) const { refuse(text, last()); }
    bool is_ascii() const { return format_ == PlyHeader::Format::ascii; }
    size_t left() const { return bytes_.size() - position_; }

    double next(PlyNumber type) {
        if (is_ascii()) return ascii();
        switch (type) {
            case PlyNumber::int8:
                return binary<int8_t>();
            case PlyNumber::uint8:
                return binary<uint8_t>();
            case PlyNumber::int16:
                return binary<int16_t>();
            case PlyNumber::uint16:
                return binary<uint16_t>();
            case PlyNumber::int32:
                return binary<int32_t>();
            case PlyNumber::uint32:
                return binary<uint32_t>();
            case PlyNumber::float32:
                return binary<float>();
            case PlyNumber::float64:
                return binary<double>();
        }
        return 0;
    }

  private:
    template <typename T>
    double binary() {
        std::array<char, sizeof(T)> raw;
        if (left() < sizeof(T))
            refuse("the PLY file is truncated: it ends in the middle of its data");
        std::memcpy(raw.data(), bytes_.data() + position_, sizeof(T));
        position_ += sizeof(T);
        const bool file_is_big = format_ == PlyHeader::Format::big_endian;
        if (file_is_big != (std::endian::native == std::endian::big))
            std::reverse(raw.begin(), raw.end());
        return static_cast<double>(std::bit_cast<T>(raw));
    }

    double ascii() {
        for (; position_ < bytes_.size(); ++position_) {
            const char c = bytes_[position_];
            if (c == '\n') {
                ++line_;
                line_begin_ = position_ + 1;
            }
            if (c != ' ' && c != '\t' && c != '\r' && c != '\n') break;
        }
        last_ = position_;
        if (left() == 0)
            refuse("the PLY file is truncated: it ends before its last element; expected a number");
        const char* begin = bytes_.data() + position_;
        const char* end = bytes_.data() + bytes_.size();
        double v = 0;
        const auto [rest, error] = std::from_chars(begin + (*begin == '+'), end, v);
        const bool ends_well =
            rest == end || *rest == ' ' || *rest == '\t' || *rest == '\r' || *rest == '\n';
        if (error == std::errc::invalid_argument || !ends_well) {
            const std::string_view word(begin, static_cast<size_t>(end - begin));
            refuse("expected a number, found " +
                   in_quotes(word.substr(0, word.find_first_of(" \t\r\n"))));
        }
        position_ = static_cast<size_t>(rest - bytes_.data());
        return v;
    }

    std::string_view bytes_;
    PlyHeader::Format format_;
    size_t position_, last_;  ///< of what follows; of the last number
    int line_;
    size_t line_begin_;
    std::shared_ptr<const std::string> file_;
};

/// Indices of the properties that are read among those of a vertex; -1 where one is missing.
struct VertexLayout {
    std::array<int, 3> position{-1, -1, -1}, normal{-1, -1, -1}, tangent{-1, -1, -1};
    std::array<int, 2> uv{-1, -1};

    explicit VertexLayout(const PlyElement& e) {
        const auto index = [&](std::string_view name) {
            const auto it =
                std::find_if(e.properties.begin(), e.properties.end(),
                             [&](const PlyProperty& p) { return p.name == name && !p.is_list; });
            return it == e.properties.end() ? -1 : static_cast<int>(it - e.properties.begin());
        };
        position = {index("x"), index("y"), index("z")};
        normal = {index("nx"), index("ny"), index("nz")};
        tangent = {index("sx"), index("sy"), index("sz")};
        constexpr std::array<std::array<const char*, 2>, 4> pairs{
            {{"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}}};
        for (const auto& [u, v] : pairs)
            if (!has_uv()) uv = {index(u), index(v)};
    }
    bool has_position() const { return *std::min_element(position.begin(), position.end()) >= 0; }
    bool has_normal() const { return *std::min_element(normal.begin(), normal.end()) >= 0; }
    bool has_tangent() const { return *std::min_element(tangent.begin(), tangent.end()) >= 0; }
    bool has_uv() const { return uv[0] >= 0 && uv[1] >= 0; }
};

class BodyReader {
  public:
    BodyReader(NumberReader numbers, const PlyHeader& header, SourceLocation file, WarningLog& log)
        : numbers_(std::move(numbers)), header_(header), file_(std::move(file)), log_(log) {}

    PlyMesh read() {
        bool has_vertices = false, has_faces = false;
        for (const PlyElement& e : header_.elements) {
            check_count(e);
            if (e.name == "vertex" && !has_vertices) {
                read_vertices(e);
                has_vertices = true;
            } else if (e.name == "face" && !has_faces) {
                read_faces(e);
                has_faces = true;
            } else if (!e.properties.empty()) {
                for (uint64_t i = 0; i < e.count; ++i)
                    for (const PlyProperty& p : e.properties) skip(p);
            }
        }
        if (!has_vertices || !has_faces)
            throw Error(ErrorKind::scene, {file_.file, header_.lines, 1},
                        "the header of the PLY file ends without an element \"vertex\" or without "
                        "an element \"face\"; expected both");
        check_indices();
        return mesh();
    }

  private:
    /// Refuses a count that the file is too short for, before anything is allocated by it.
    void check_count(const PlyElement& e) const {
        const uint64_t size = e.smallest_size(numbers_.is_ascii());
        const uint64_t room = numbers_.left() + (numbers_.is_ascii() ? 1 : 0);
        if (size > 0 && e.count > room / size)
            throw Error(
                ErrorKind::scene, e.where,
                "the PLY file is truncated or its header is wrong: " + std::to_string(e.count) +
                    " of element " + in_quotes(e.name) + " can't be in the " +
                    std::to_string(numbers_.left()) + " bytes that follow");
    }

    size_t list_length(const PlyProperty& p) {
        const double n = numbers_.next(p.count_type);
        const double size = numbers_.is_ascii() ? 2.0 : static_cast<double>(size_of(p.type));
        if (!(n >= 0) || n != std::floor(n))
            numbers_.refuse("the length of a list is not a whole number >= 0");
        if (n * size > static_cast<double>(numbers_.left()) + 1)
            numbers_.refuse(
                "the PLY file is truncated: a list is longer than the rest of the file");
        return static_cast<size_t>(n);
    }

    void skip(const PlyProperty& p) {
        const size_t n = p.is_list ? list_length(p) : 1;
        for (size_t i = 0; i < n; ++i) numbers_.next(p.type);
    }

    float finite(double v, NumberReader::Place at) const {
        const auto f = static_cast<float>(v);
        if (!std::isfinite(f))
            numbers_.refuse("a vertex has a number that is not finite; expected a finite one", at);
        return f;
    }

    void read_vertices(const PlyElement& e) {
        const VertexLayout layout(e);
        if (!layout.has_position())
            throw Error(ErrorKind::scene, e.where,
                        "the vertices of the PLY file have no position; expected x, y and z");
        std::vector<double> values(e.properties.size());
        std::vector<NumberReader::Place> places(values.size());
        positions_.reserve(e.count);
        if (layout.has_normal()) normals_.reserve(e.count);
        if (layout.has_tangent()) tangents_.reserve(e.count);
        if (layout.has_uv()) uvs_.reserve(e.count);
        const auto at = [&](int i) {
            return finite(values[static_cast<size_t>(i)], places[static_cast<size_t>(i)]);
        };
        for (uint64_t i = 0; i < e.count; ++i) {
            for (size_t j = 0; j < values.size(); ++j) {
                if (e.properties[j].is_list) {
                    skip(e.properties[j]);
                } else {
                    values[j] = numbers_.next(e.properties[j].type);
                    places[j] = numbers_.last();
                }
            }
            const auto triple = [&](const std::array<int, 3>& k) {
                return Vec3{at(k[0]), at(k[1]), at(k[2])};
            };
            // A normal that is not a number, as exporters write it at vertices without area,
            // becomes zero: then the face's own takes its place, as in pbrt-v4.
            const auto normal = [&](const std::array<int, 3>& k) {
                for (const int property : k)
                    if (std::isnan(values[static_cast<size_t>(property)])) return Vec3{};
                return triple(k);
            };
            positions_.push_back(triple(layout.position));
            if (layout.has_normal()) normals_.push_back(normal(layout.normal));
            if (layout.has_tangent()) tangents_.push_back(triple(layout.tangent));
            if (layout.has_uv()) uvs_.push_back({at(layout.uv[0]), at(layout.uv[1])});
        }
    }

    void read_faces(const PlyElement& e) {
        const auto indices =
            std::find_if(e.properties.begin(), e.properties.end(), [](const PlyProperty& p) {
                return p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index");
            });
        if (indices == e.properties.end())
            throw Error(ErrorKind::scene, e.where,
                        "the faces of the PLY file have no list; expected \"vertex_indices\"");
        reserve_faces(e, *indices);
        std::vector<uint32_t> corners;
        for (uint64_t i = 0; i < e.count; ++i) {
            for (const PlyProperty& p : e.properties) {
                if (&p != &*indices) {
                    skip(p);
                    continue;
                }
                corners.resize(list_length(p));
                for (uint32_t& c : corners) c = index(numbers_.next(p.type));
            }
            add_face(corners);
        }
    }

    /// Reserves room for triangles, which most files hold only; never for more than the file has
    /// bytes for.
    void reserve_faces(const PlyElement& e, const PlyProperty& indices) {
        const size_t bytes =
            numbers_.is_ascii() ? 8 : size_of(indices.count_type) + 3 * size_of(indices.type);
        triangles_.reserve(std::min<uint64_t>(e.count, numbers_.left() / bytes));
    }

    uint32_t index(double v) {
        if (!(v >= 0 && v < double(std::numeric_limits<uint32_t>::max())) || v != std::floor(v))
            numbers_.refuse("a face has an index that is not a whole number >= 0");
        if (v > double(largest_index_)) {
            largest_index_ = static_cast<uint32_t>(v);
            at_largest_ = numbers_.last();
        }
        return static_cast<uint32_t>(v);
    }

    void add_face(const std::vector<uint32_t>& c) {
        if (c.size() < 3) {
            log_.add(file_, "faces with fewer than three corners are ignored");
        } else if (c.size() == 4) {
            quads_.push_back({c[0], c[1], c[3], c[2]});
        } else {
            if (c.size() > 4)
                log_.add(file_, "faces with more than four corners are cut into triangles");
            for (size_t i = 2; i < c.size(); ++i) triangles_.push_back({c[0], c[i - 1], c[i]});
        }
    }

    void check_indices() const {
        if ((triangles_.empty() && quads_.empty()) || largest_index_ < positions_.size()) return;
        numbers_.refuse("a face has the vertex index " + std::to_string(largest_index_) +
                            ", which is out of range; there are " +
                            std::to_string(positions_.size()) + " vertices, counted from 0",
                        at_largest_);
    }

    PlyMesh mesh() {
        PlyMesh m;
        quads_.shrink_to_fit();
        triangles_.shrink_to_fit();
        if (!quads_.empty()) {
            BilinearMesh b;
            b.patches = std::move(quads_);
            if (triangles_.empty()) {
                b.positions = std::move(positions_);
                b.normals = std::move(normals_);
                b.uvs = std::move(uvs_);
            } else {
                b.positions = positions_;
                b.normals = normals_;
                b.uvs = uvs_;
            }
            m.quads = std::make_shared<const BilinearMesh>(std::move(b));
        }
        if (!triangles_.empty()) {
            TriangleMesh t{std::move(positions_), std::move(normals_), std::move(uvs_),
                           std::move(triangles_), std::move(tangents_)};
            m.triangles = std::make_shared<const TriangleMesh>(std::move(t));
        }
        return m;
    }

    NumberReader numbers_;
    const PlyHeader& header_;
    SourceLocation file_;
    WarningLog& log_;
    std::vector<Vec3> positions_, normals_, tangents_;
    std::vector<Vec2> uvs_;
    std::vector<std::array<uint32_t, 3>> triangles_;
    std::vector<std::array<uint32_t, 4>> quads_;
    uint32_t largest_index_ = 0;
    NumberReader::Place at_largest_;
};

}  // namespace

std::shared_ptr<const TriangleMesh> triangles_of(const PlyMesh& mesh) {
    if (!mesh.quads) return mesh.triangles;
    const BilinearMesh& quads = *mesh.quads;
    TriangleMesh t{quads.positions, quads.normals, quads.uvs, {}};
    if (mesh.triangles) t.triangles = mesh.triangles->triangles;
    for (const auto& q : quads.patches) {
        t.triangles.push_back({q[0], q[1], q[3]});
        t.triangles.push_back({q[0], q[3], q[2]});
    }
    return std::make_shared<const TriangleMesh>(std::move(t));
}

PlyMesh read_ply(std::string_view bytes, const std::string& file, WarningLog& log) {
    const auto name = std::make_shared<const std::string>(file);
    const PlyHeader header = read_ply_header(bytes, name);
    return BodyReader(NumberReader(bytes, header, name), header, {name, 0, 0}, log).read();
}

}  // namespace covtrace
