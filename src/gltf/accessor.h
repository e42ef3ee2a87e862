/// Private to this folder: accessors as numbers, whatever their component type, stride, sparse
/// replacements and normalisation. Everything is checked against the buffers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gltf/document.h"

namespace covtrace::gltf {

/// Elements of an accessor, one after the other, of `components` numbers each.
struct Numbers {
    size_t components = 0;
    std::vector<float> values;
    std::vector<uint32_t> not_finite;  ///< elements that were not, and are zero; sorted
    size_t count() const { return components == 0 ? 0 : values.size() / components; }
    const float* element(size_t i) const { return values.data() + i * components; }
};

/// Elements with a value that is not finite are an error, or zero as a whole.
enum class NotFinite { refused, zero };

/// Reads accessors[index], whose type must have `components` numbers (SCALAR 1, VEC3 3, MAT4 16).
/// Integers become themselves, or [0, 1] and [-1, 1] where the accessor is normalised. Refuses, at
/// `place`, accessors that reach beyond their buffer, and values that are not finite unless these
/// are to be zero. Throws Error(limit) where the document's budget is spent, as read_indices does.
Numbers read_numbers(const Document& document, int index, size_t components,
                     const std::string& place, NotFinite not_finite = NotFinite::refused);

/// The indices of a mesh: accessors[index], unsigned scalars. Each must be below `vertices`.
std::vector<uint32_t> read_indices(const Document& document, int index, size_t vertices,
                                   const std::string& place);

/// Number of elements of accessors[index]; refuses an index that is not there.
size_t accessor_count(const Document& document, int index, const std::string& place);

/// Refuses an attribute that has not one element for each vertex.
void require_count(const Document& document, size_t found, size_t expected,
                   const std::string& place);

}  // namespace covtrace::gltf
