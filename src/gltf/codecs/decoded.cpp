#include "gltf/codecs/decoded.h"

namespace covtrace::gltf {

std::span<const unsigned char> buffer_bytes(const Document& document, int buffer, uint64_t offset,
                                            uint64_t length, const std::string& place) {
    const auto& data = at(document, document.model.buffers, buffer, "buffers", place).data;
    if (offset > data.size() || length > data.size() - offset)
        document.refuse(place, "its bytes end beyond their buffer of " +
                                   std::to_string(data.size()) + " bytes");
    return std::span(data).subspan(offset, length);
}

void spend_decoded(Document& document, uint64_t count, uint64_t size, const std::string& place) {
    if (!document.decoded.spend(count, size))
        throw Error(ErrorKind::limit, document.place(place),
                    "what it and those before it decode to is too large for a file of " +
                        std::to_string(document.bytes) + " bytes");
}

int add_buffer(Document& document, std::vector<unsigned char> bytes) {
    tinygltf::Buffer buffer;
    buffer.data = std::move(bytes);
    document.model.buffers.push_back(std::move(buffer));
    return static_cast<int>(document.model.buffers.size() - 1);
}

uint64_t whole_number(const Document& document, const tinygltf::Value& object, const char* key,
                      const std::string& place) {
    const double v =
        object.Has(key) && object.Get(key).IsNumber() ? object.Get(key).GetNumberAsDouble() : -1;
    constexpr double kLargest = 4294967295;
    if (!(v >= 0 && v <= kLargest) || v != static_cast<double>(static_cast<uint64_t>(v)))
        document.refuse(place + "." + key, "expected a whole number of at least 0");
    return static_cast<uint64_t>(v);
}

}  // namespace covtrace::gltf
