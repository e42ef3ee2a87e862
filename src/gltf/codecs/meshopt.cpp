#include "gltf/codecs/meshopt.h"

#include <meshoptimizer.h>

#include <cstdio>
#include <optional>

#include "core/memory_limit.h"
#include "gltf/codecs/decoded.h"

namespace covtrace::gltf {
namespace {

enum class Mode { attributes, triangles, indices };
enum class Filter { none, octahedral, quaternion, exponential, colour };

/// A stream, and what the extension's object says of it.
struct Stream {
    std::span<const unsigned char> bytes;
    size_t stride = 0, count = 0;
    Mode mode{};
    Filter filter = Filter::none;
    std::string place;
};

template <typename Choice, size_t n>
Choice choice(const Document& document, const tinygltf::Value& object, const char* key,
              const std::array<std::pair<const char*, Choice>, n>& choices,
              const std::string& place) {
    const std::string found = object.Get(key).IsString() ? object.Get(key).Get<std::string>() : "";
    std::string names;
    for (const auto& [name, value] : choices) {
        if (found == name) return value;
        names += (names.empty() ? "" : ", ") + std::string(name);
    }
    document.refuse(place + "." + key, "expected one of " + names);
}

/// Refuses layouts that the specification excludes: the library ends the process over some.
void check_layout(const Document& document, const Stream& s) {
    const auto require = [&](bool condition, const std::string& text) {
        if (!condition) document.refuse(s.place, "expected " + text);
    };
    if (s.mode == Mode::attributes)
        require(s.stride % 4 == 0 && s.stride >= 4 && s.stride <= 256,
                "a byteStride of 4, 8, ... 256 for attributes");
    else
        require((s.stride == 2 || s.stride == 4) && s.filter == Filter::none,
                "a byteStride of 2 or 4 and no filter for indices");
    require(s.mode != Mode::triangles || s.count % 3 == 0, "three indices for each triangle");
    if (s.filter == Filter::octahedral || s.filter == Filter::colour)
        require(s.stride == 4 || s.stride == 8, "a byteStride of 4 or 8 for this filter");
    require(s.filter != Filter::quaternion || s.stride == 8, "a byteStride of 8 for this filter");
}

Stream read_stream(const Document& document, const tinygltf::BufferView& view,
                   const tinygltf::Value& object, const std::string& place) {
    Stream s;
    s.place = place;
    const uint64_t offset =
        object.Has("byteOffset") ? whole_number(document, object, "byteOffset", place) : 0;
    s.bytes =
        buffer_bytes(document, static_cast<int>(whole_number(document, object, "buffer", place)),
                     offset, whole_number(document, object, "byteLength", place), place);
    s.stride = whole_number(document, object, "byteStride", place);
    s.count = whole_number(document, object, "count", place);
    s.mode = choice(
        document, object, "mode",
        std::array{std::pair{"ATTRIBUTES", Mode::attributes},
                   std::pair{"TRIANGLES", Mode::triangles}, std::pair{"INDICES", Mode::indices}},
        place);
    if (object.Has("filter"))
        s.filter = choice(
            document, object, "filter",
            std::array{std::pair{"NONE", Filter::none}, std::pair{"OCTAHEDRAL", Filter::octahedral},
                       std::pair{"QUATERNION", Filter::quaternion},
                       std::pair{"EXPONENTIAL", Filter::exponential},
                       std::pair{"COLOR", Filter::colour}},
            place);
    check_layout(document, s);
    // Both factors are below 2^32.
    if (view.byteLength != s.count * s.stride ||
        (view.byteStride != 0 && view.byteStride != s.stride))
        document.refuse(place, "its " + std::to_string(s.count) + " elements of " +
                                   std::to_string(s.stride) +
                                   " bytes are not those of its buffer view");
    return s;
}

/// The library that a stream needs; empty where this one reads it.
std::optional<std::string> lack(const Stream& s) {
    constexpr unsigned char kAttributes = 0xa0;
    constexpr int kVersion1 = 230;
    if (s.mode == Mode::attributes && !s.bytes.empty() && s.bytes[0] == (kAttributes | 1) &&
        MESHOPTIMIZER_VERSION < kVersion1)
        return "version 1 of its attributes needs libmeshoptimizer 0.23";
    if (s.filter == Filter::colour) return "its filter COLOR needs libmeshoptimizer 1.0";
    return std::nullopt;
}

/// The version of the library, 180, as people know it: 0.18.
std::string library_version() {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%d.%d", MESHOPTIMIZER_VERSION / 1000,
                  MESHOPTIMIZER_VERSION % 1000 / 10);
    return text.data();
}

std::vector<unsigned char> decode(Document& document, const Stream& s) {
    spend_decoded(document, s.count, s.stride, s.place);
    const MemoryReservation room(s.count * s.stride, "the buffer view's bytes",
                                 document.place(s.place));
    std::vector<unsigned char> bytes(s.count * s.stride);
    int failed = 0;
    switch (s.mode) {
        case Mode::attributes:
            failed = meshopt_decodeVertexBuffer(bytes.data(), s.count, s.stride, s.bytes.data(),
                                                s.bytes.size());
            break;
        case Mode::triangles:
            failed = meshopt_decodeIndexBuffer(bytes.data(), s.count, s.stride, s.bytes.data(),
                                               s.bytes.size());
            break;
        case Mode::indices:
            failed = meshopt_decodeIndexSequence(bytes.data(), s.count, s.stride, s.bytes.data(),
                                                 s.bytes.size());
            break;
    }
    if (failed != 0) document.refuse(s.place, "its bytes can't be decoded");
    switch (s.filter) {
        case Filter::octahedral:
            meshopt_decodeFilterOct(bytes.data(), s.count, s.stride);
            break;
        case Filter::quaternion:
            meshopt_decodeFilterQuat(bytes.data(), s.count, s.stride);
            break;
        case Filter::exponential:
            meshopt_decodeFilterExp(bytes.data(), s.count, s.stride);
            break;
        case Filter::colour:
        case Filter::none:
            break;
    }
    return bytes;
}

/// Whether the file has the bytes that a stream is made of.
bool has_plain_bytes(const Document& document, const tinygltf::BufferView& view) {
    const auto& buffers = document.model.buffers;
    if (view.buffer < 0 || static_cast<size_t>(view.buffer) >= buffers.size()) return false;
    const size_t held = buffers[static_cast<size_t>(view.buffer)].data.size();
    return view.byteOffset <= held && view.byteLength <= held - view.byteOffset;
}

}  // namespace

void decode_meshopt(Document& document) {
    for (size_t i = 0; i < document.model.bufferViews.size(); ++i)
        for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
            tinygltf::BufferView& view = document.model.bufferViews[i];
            const tinygltf::Value* object = extension(view.extensions, name);
            if (!object) continue;
            const std::string place = element("bufferViews", i) + ".extensions." + name;
            const Stream stream = read_stream(document, view, *object, place);
            if (const auto lacking = lack(stream)) {
                if (has_plain_bytes(document, view)) break;
                document.refuse(place, *lacking + "; this is " + library_version());
            }
            view.buffer = add_buffer(document, decode(document, stream));
            view.byteOffset = 0;
            break;
        }
}

}  // namespace covtrace::gltf
