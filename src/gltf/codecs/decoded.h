/// Private to this folder: where codecs have their bytes from, and where they leave what they made.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "gltf/document.h"

namespace covtrace::gltf {

/// The bytes [offset, offset + length) of buffers[buffer]; refuses, at `place`, what is not there.
std::span<const unsigned char> buffer_bytes(const Document& document, int buffer, uint64_t offset,
                                            uint64_t length, const std::string& place);

/// Takes decoded bytes from the document's budget, before they are made. Throws Error(limit) at
/// `place` where it is spent.
void spend_decoded(Document& document, uint64_t count, uint64_t size, const std::string& place);

/// Adds decoded bytes to the document as a buffer; returns its index.
int add_buffer(Document& document, std::vector<unsigned char> bytes);

/// The unsigned integer below 2^32 of an extension's object. Refuses what is missing or other, at
/// `place`.
uint64_t whole_number(const Document& document, const tinygltf::Value& object, const char* key,
                      const std::string& place);

}  // namespace covtrace::gltf
