#include "gltf/accessor.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace covtrace::gltf {
namespace {

struct Bytes {
    const unsigned char* data = nullptr;
    size_t stride = 0;
};

/// The bytes of a buffer view in which `count` elements of `size` bytes lie.
Bytes locate(const Document& document, int view_index, size_t offset, size_t count, size_t size,
             const std::string& place) {
    const auto& model = document.model;
    const auto& view = at(document, model.bufferViews, view_index, "bufferViews", place);
    const auto& buffer = at(document, model.buffers, view.buffer, "buffers",
                            element("bufferViews", static_cast<size_t>(view_index)));
    const size_t held = buffer.data.size();
    if (view.byteOffset > held || view.byteLength > held - view.byteOffset)
        document.refuse(element("bufferViews", static_cast<size_t>(view_index)),
                        "it ends beyond its buffer of " + std::to_string(held) + " bytes");
    const size_t stride = view.byteStride == 0 ? size : view.byteStride;
    // All elements but the last take a whole stride.
    if (count > 0 && (offset > view.byteLength || size > view.byteLength - offset ||
                      (count - 1) > (view.byteLength - offset - size) / stride))
        document.refuse(place, std::to_string(count) + " elements end beyond the buffer view of " +
                                   std::to_string(view.byteLength) + " bytes");
    return {buffer.data.data() + view.byteOffset + offset, stride};
}

template <typename T>
T load(const unsigned char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

float component(const unsigned char* bytes, int type, bool normalized) {
    const auto scaled = [normalized](auto v, float largest) {
        return normalized ? std::max(static_cast<float>(v) / largest, -1.0f)
                          : static_cast<float>(v);
    };
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return scaled(load<int8_t>(bytes), 127);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return scaled(load<uint8_t>(bytes), 255);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return scaled(load<int16_t>(bytes), 32767);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return scaled(load<uint16_t>(bytes), 65535);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return static_cast<float>(load<uint32_t>(bytes));
        default:
            return load<float>(bytes);
    }
}

uint32_t unsigned_integer(const unsigned char* bytes, int type) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return load<uint8_t>(bytes);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return load<uint16_t>(bytes);
        default:
            return load<uint32_t>(bytes);
    }
}

bool is_unsigned(int type) {
    return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

size_t component_size(const Document& document, int type, const std::string& place) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return 4;
        default:
            document.refuse(place, "component type " + std::to_string(type) +
                                       " is not known; expected 5120 to 5123, 5125 or 5126");
    }
}

/// Refuses accessors of another type than expected, and matrices of small components, whose columns
/// are padded to four bytes: nothing that is read here is stored so.
void check_layout(const Document& document, const tinygltf::Accessor& a, size_t components,
                  const std::string& place) {
    const int found = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(a.type));
    if (found != static_cast<int>(components) ||
        (components == 16 && a.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT))
        document.refuse(place, "expected elements of " + std::to_string(components) +
                                   (components == 16 ? " floats" : " numbers") + ", found " +
                                   std::to_string(found));
}

/// Calls replace(element, bytes of its new value) for each element that a sparse accessor changes.
template <typename Replace>
void apply_sparse(const Document& document, const tinygltf::Accessor& a, size_t element_size,
                  const std::string& place, Replace replace) {
    if (!a.sparse.isSparse) return;
    const std::string here = place + ".sparse";
    if (a.sparse.count < 0 || static_cast<size_t>(a.sparse.count) > a.count ||
        a.sparse.indices.byteOffset < 0 || a.sparse.values.byteOffset < 0)
        document.refuse(here, "its count or an offset is out of range");
    const auto count = static_cast<size_t>(a.sparse.count);
    const int type = a.sparse.indices.componentType;
    if (!is_unsigned(type)) document.refuse(here + ".indices", "expected unsigned indices");
    const Bytes indices = locate(document, a.sparse.indices.bufferView,
                                 static_cast<size_t>(a.sparse.indices.byteOffset), count,
                                 component_size(document, type, here), here + ".indices");
    const Bytes values = locate(document, a.sparse.values.bufferView,
                                static_cast<size_t>(a.sparse.values.byteOffset), count,
                                element_size, here + ".values");
    for (size_t i = 0; i < count; ++i) {
        const uint32_t target = unsigned_integer(indices.data + i * indices.stride, type);
        if (target >= a.count)
            document.refuse(here + ".indices", "index " + std::to_string(target) +
                                                   " is beyond the accessor's " +
                                                   std::to_string(a.count) + " elements");
        replace(target, values.data + i * values.stride);
    }
}

/// Refuses accessors once all that were read are too many for the file.
void spend(const Document& document, const tinygltf::Accessor& a, size_t components,
           const std::string& place) {
    if (!document.numbers.spend(a.count, components))
        throw Error(ErrorKind::limit, document.place(place),
                    "its " + std::to_string(a.count) +
                        " elements and all that were read before are too many for a file of " +
                        std::to_string(document.bytes) + " bytes");
}

/// Calls visit(element, its bytes) for all elements of an accessor; those without bytes, which are
/// zero, aren't visited.
template <typename Visit>
void visit_elements(const Document& document, const tinygltf::Accessor& a, size_t element_size,
                    const std::string& place, Visit visit) {
    if (a.bufferView >= 0) {
        const Bytes bytes =
            locate(document, a.bufferView, a.byteOffset, a.count, element_size, place);
        for (size_t i = 0; i < a.count; ++i) visit(i, bytes.data + i * bytes.stride);
    }
    apply_sparse(document, a, element_size, place, visit);
}

bool is_finite(const float* element, size_t components) {
    return std::all_of(element, element + components, [](float v) { return std::isfinite(v); });
}

}  // namespace

size_t accessor_count(const Document& document, int index, const std::string& place) {
    return at(document, document.model.accessors, index, "accessors", place).count;
}

Numbers read_numbers(const Document& document, int index, size_t components,
                     const std::string& place, NotFinite not_finite) {
    const tinygltf::Accessor& a = at(document, document.model.accessors, index, "accessors", place);
    const std::string here = element("accessors", static_cast<size_t>(index));
    check_layout(document, a, components, here);
    spend(document, a, components, here);
    const size_t size = component_size(document, a.componentType, here);
    Numbers numbers;
    numbers.components = components;
    const auto store = [&](size_t i, const unsigned char* bytes) {
        if (numbers.values.empty()) numbers.values.resize(a.count * components);
        float* element = numbers.values.data() + i * components;
        for (size_t c = 0; c < components; ++c)
            element[c] = component(bytes + c * size, a.componentType, a.normalized);
        if (not_finite == NotFinite::refused && !is_finite(element, components))
            document.refuse(here, "element " + std::to_string(i) + " is not finite");
    };
    visit_elements(document, a, size * components, here, store);
    numbers.values.resize(a.count * components);
    // Sparse accessors may have replaced what was not finite at first
    if (not_finite == NotFinite::zero)
        for (size_t i = 0; i < a.count; ++i)
            if (float* element = numbers.values.data() + i * components;
                !is_finite(element, components)) {
                std::fill_n(element, components, 0.0f);
                numbers.not_finite.push_back(static_cast<uint32_t>(i));
            }
    return numbers;
}

std::vector<uint32_t> read_indices(const Document& document, int index, size_t vertices,
                                   const std::string& place) {
    const tinygltf::Accessor& a = at(document, document.model.accessors, index, "accessors", place);
    const std::string here = element("accessors", static_cast<size_t>(index));
    check_layout(document, a, 1, here);
    if (!is_unsigned(a.componentType))
        document.refuse(here, "indices must be unsigned bytes, shorts or ints");
    spend(document, a, 1, here);
    std::vector<uint32_t> indices;
    const auto store = [&](size_t i, const unsigned char* bytes) {
        if (indices.empty()) indices.resize(a.count);
        indices[i] = unsigned_integer(bytes, a.componentType);
    };
    visit_elements(document, a, component_size(document, a.componentType, here), here, store);
    indices.resize(a.count);
    for (const uint32_t i : indices)
        if (i >= vertices)
            document.refuse(place, "index " + std::to_string(i) + " is beyond the " +
                                       std::to_string(vertices) + " vertices");
    return indices;
}

void require_count(const Document& document, size_t found, size_t expected,
                   const std::string& place) {
    if (found != expected)
        document.refuse(place, "has " + std::to_string(found) + " elements; expected " +
                                   std::to_string(expected) + ", one per position");
}

}  // namespace covtrace::gltf
