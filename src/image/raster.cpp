#include "image/raster.h"

#include <algorithm>
#include <cmath>

#include "image/read_file.h"

namespace covtrace {

namespace {

/// The channels that a picture shows: grey, R G B or R G B A.
std::vector<std::string> visible_channels(const std::vector<std::string>& names) {
    const auto has = [&names](const char* name) {
        return std::find(names.begin(), names.end(), name) != names.end();
    };
    if (has("R") && has("G") && has("B"))
        return has("A") ? std::vector<std::string>{"R", "G", "B", "A"}
                        : std::vector<std::string>{"R", "G", "B"};
    if (has("Y")) return {"Y"};
    return names.size() == 1 ? names : std::vector<std::string>{};
}

/// The colour space that an image names; by OpenEXR's documentation the primaries are those of
/// Rec.709 where the attribute is missing.
std::optional<ColourSpace> colour_space_of(const Image& image) {
    const auto entry = image.metadata.find(kChromaticities);
    if (entry == image.metadata.end()) return ColourSpace::srgb;
    const auto* values = std::get_if<std::vector<float>>(&entry->second);
    Chromaticities c{};
    if (!values || values->size() != c.size()) return std::nullopt;
    std::copy(values->begin(), values->end(), c.begin());
    return colour_space_with(c);
}

RasterImage from_exr(const std::filesystem::path& file, const SourceLocation& where) {
    std::vector<std::string> channels;
    Image image = read_exr(file, where, [&channels](const std::vector<std::string>& names) {
        return channels = visible_channels(names);
    });
    if (channels.empty()) throw_unreadable(file, where, "it has no channels R, G, B or Y");
    const MemoryReservation room(image.pixel_count() * channels.size() * sizeof(float),
                                 in_words(file, image.width(), image.height()));
    RasterImage raster{.width = image.width(),
                       .height = image.height(),
                       .channels = int(channels.size()),
                       .bytes = {},
                       .values = {},
                       .colour_space = colour_space_of(image)};
    raster.values.resize(image.pixel_count() * channels.size());
    for (size_t c = 0; c < channels.size(); ++c) {
        const auto channel = std::find_if(image.channels.begin(), image.channels.end(),
                                          [&](const Channel& k) { return k.name == channels[c]; });
        for (size_t i = 0; i < image.pixel_count(); ++i)
            raster.values[i * channels.size() + c] = channel->values[i];
        channel->values = std::vector<float>();
    }
    return raster;
}

/// Keeps the first value of each pair.
template <typename Value>
void drop_every_second(std::vector<Value>& values) {
    for (size_t i = 0; i < values.size() / 2; ++i) values[i] = values[2 * i];
    values.resize(values.size() / 2);
}

RasterImage from_plain(PlainImage plain) {
    RasterImage raster{.width = plain.width,
                       .height = plain.height,
                       .channels = plain.channels == 2 ? 1 : plain.channels,
                       .bytes = std::move(plain.bytes),
                       .values = std::move(plain.values),
                       .is_8bit = plain.integer_bits == 8,
                       .is_16bit = plain.integer_bits == 16};
    if (plain.channels == 2) {
        drop_every_second(raster.bytes);
        drop_every_second(raster.values);
    }
    return raster;
}

void repair(RasterImage& raster) {
    if (raster.is_8bit || raster.is_16bit) return;
    float largest = 0;
    for (float v : raster.values)
        if (std::isfinite(v)) largest = std::max(largest, std::abs(v));
    for (float& v : raster.values) {
        if (std::isfinite(v)) continue;
        v = std::isnan(v) ? 0.0f : std::copysign(largest, v);
        ++raster.repaired;
    }
}

}  // namespace

RasterImage read_raster(const std::filesystem::path& file, const SourceLocation& where) {
    const ImageFormat format = detect_image_format(file, where);
    RasterImage raster = format == ImageFormat::exr ? from_exr(file, where)
                                                    : from_plain(read_plain(file, format, where));
    repair(raster);
    return raster;
}

RasterImage decode_raster(std::string_view bytes, const std::filesystem::path& name,
                          const SourceLocation& where) {
    RasterImage raster = from_plain(decode_plain(bytes, name, where));
    repair(raster);
    return raster;
}

ColourSpace colour_space_of(const RasterImage& raster, const std::filesystem::path& file,
                            const SourceLocation& where, Warnings& warnings) {
    if (!raster.colour_space && raster.channels >= 3)
        warnings.push_back({where, "the chromaticities of \"" + file.string() +
                                       "\" are not those of a known colour space (srgb, dci-p3, "
                                       "rec2020, aces2065-1); its colours are taken for srgb"});
    return raster.colour_space.value_or(ColourSpace::srgb);
}

}  // namespace covtrace
