#include "preview/tev_messages.h"

#include <bit>
#include <cstring>

namespace covtrace {

namespace {

static_assert(std::endian::native == std::endian::little);

enum class TevMessage : uint8_t { create_image = 4, update_image = 6 };

class MessageWriter {
  public:
    explicit MessageWriter(TevMessage kind) { number(uint32_t(0)).number(uint8_t(kind)); }
    template <typename T>
    MessageWriter& number(T value) {
        return bytes(&value, sizeof value);
    }
    MessageWriter& text(const std::string& value) {
        // A name ends at its first zero byte in any case.
        return bytes(value.c_str(), std::strlen(value.c_str()) + 1);
    }
    MessageWriter& bytes(const void* from, size_t count) {
        message_.append(static_cast<const char*>(from), count);
        return *this;
    }
    /// The message, complete with its length.
    std::string finish() {
        const auto length = uint32_t(message_.size());
        std::memcpy(message_.data(), &length, sizeof length);
        return std::move(message_);
    }

  private:
    std::string message_;
};

}  // namespace

std::string tev_create_image(const std::string& name, bool focus, int width, int height,
                             const std::vector<std::string>& channels) {
    MessageWriter message(TevMessage::create_image);
    message.number(uint8_t(focus)).text(name);
    message.number(int32_t(width)).number(int32_t(height)).number(int32_t(channels.size()));
    for (const std::string& channel : channels) message.text(channel);
    return message.finish();
}

std::string tev_update_image(const std::string& name, const Image& image, int y0, int y1) {
    const auto width = size_t(image.width());
    const size_t first = size_t(y0 - image.data.y0) * width, count = size_t(y1 - y0) * width;
    MessageWriter message(TevMessage::update_image);
    message.number(uint8_t(0)).text(name).number(int32_t(image.channels.size()));
    for (const Channel& channel : image.channels) message.text(channel.name);
    message.number(int32_t(image.data.x0 - image.display.x0));
    message.number(int32_t(y0 - image.display.y0));
    message.number(int32_t(width)).number(int32_t(y1 - y0));
    // Channels come one after the other: offset and stride count in floats.
    for (size_t c = 0; c < image.channels.size(); ++c) message.number(int64_t(c * count));
    for (size_t c = 0; c < image.channels.size(); ++c) message.number(int64_t(1));
    for (const Channel& channel : image.channels)
        message.bytes(&channel.values[first], count * sizeof(float));
    return message.finish();
}

}  // namespace covtrace
