#include <ImfChannelList.h>
#include <ImfChromaticitiesAttribute.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFloatVectorAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMatrixAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <ImfTileDescriptionAttribute.h>
#include <ImfVecAttribute.h>

#include <algorithm>
#include <cstdlib>
#include <new>
#include <set>

#include "image/exr_header.h"
#include "image/exr_names.h"
#include "image/read_file.h"

namespace covtrace {

namespace {

PixelBounds from_imath(const Imath::Box2i& box) {
    return {box.min.x, box.min.y, box.max.x + 1, box.max.y + 1};
}

template <class Matrix>
std::vector<float> matrix_values(const Matrix& matrix, size_t count) {
    return std::vector<float>(matrix.getValue(), matrix.getValue() + count);
}

std::vector<float> chromaticities(const Imf::Chromaticities& c) {
    return {c.red.x, c.red.y, c.green.x, c.green.y, c.blue.x, c.blue.y, c.white.x, c.white.y};
}

/// Converts an attribute; false for the types that Metadata has no place for.
bool convert(const Imf::Attribute& attribute, MetadataValue& value) {
    if (const auto* i = dynamic_cast<const Imf::IntAttribute*>(&attribute))
        value = i->value();
    else if (const auto* f = dynamic_cast<const Imf::FloatAttribute*>(&attribute))
        value = f->value();
    else if (const auto* d = dynamic_cast<const Imf::DoubleAttribute*>(&attribute))
        value = float(d->value());
    else if (const auto* s = dynamic_cast<const Imf::StringAttribute*>(&attribute))
        value = s->value();
    else if (const auto* l = dynamic_cast<const Imf::FloatVectorAttribute*>(&attribute))
        value = std::vector<float>(l->value());
    else if (const auto* v2 = dynamic_cast<const Imf::V2fAttribute*>(&attribute))
        value = std::vector<float>{v2->value().x, v2->value().y};
    else if (const auto* v3 = dynamic_cast<const Imf::V3fAttribute*>(&attribute))
        value = std::vector<float>{v3->value().x, v3->value().y, v3->value().z};
    else if (const auto* m3 = dynamic_cast<const Imf::M33fAttribute*>(&attribute))
        value = matrix_values(m3->value(), 9);
    else if (const auto* m4 = dynamic_cast<const Imf::M44fAttribute*>(&attribute))
        value = matrix_values(m4->value(), 16);
    else if (const auto* c = dynamic_cast<const Imf::ChromaticitiesAttribute*>(&attribute))
        value = chromaticities(c->value());
    else
        return false;
    return true;
}

Metadata read_metadata(const Imf::Header& header) {
    Metadata metadata;
    for (auto it = header.begin(); it != header.end(); ++it) {
        MetadataValue value;
        if (!is_structural_exr_name(it.name()) && convert(it.attribute(), value))
            metadata.emplace(it.name(), std::move(value));
    }
    if (header.pixelAspectRatio() != 1) metadata[kPixelAspectRatio] = header.pixelAspectRatio();
    return metadata;
}

/// Reads one part after its header has been found sane.
class PartReader {
  public:
    explicit PartReader(const Image& image) : image_(image) {}

    void check(const Imf::Header& header) const {
        if (header.hasType() && !Imf::isImage(header.type()))
            throw DecodeError("deep images are not supported");
        for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
            if (c.channel().xSampling != 1 || c.channel().ySampling != 1)
                throw DecodeError(std::string("the subsampled channel '") + c.name() +
                                  "' is not supported");
        if (header.hasTileDescription())
            check_image_size(header.tileDescription().xSize, header.tileDescription().ySize,
                             channel_count(header));
    }

    static int channel_count(const Imf::Header& header) {
        int count = 0;
        for (auto c = header.channels().begin(); c != header.channels().end(); ++c) ++count;
        return count;
    }

    /// The channels of part `index`, in the order of the file; those that are not `wanted` have no
    /// values. Where a part has a smaller window than the image, as renderers cut parts to what is
    /// not black, its pixels outside of it are 0.
    std::vector<Channel> read(Imf::MultiPartInputFile& exr, int index,
                              const std::set<std::string>& wanted) const {
        const Imf::Header& header = exr.header(index);
        const PixelBounds window = from_imath(header.dataWindow());
        const int width = window.width(), height = window.height();
        std::vector<Channel> channels;
        Imf::FrameBuffer frame;
        for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
            const std::string name = name_in_image(header, index, c.name());
            std::vector<float>& values = channels.emplace_back(Channel{name, {}}).values;
            if (!wanted.contains(name)) continue;
            // The values grow band by band, so that a short file costs no more memory than it has
            // pixels.
            values.reserve(size_t(width) * size_t(height));
            frame.insert(c.name(), Imf::Slice::Make(Imf::FLOAT, values.data(), header.dataWindow(),
                                                    sizeof(float), size_t(width) * sizeof(float)));
        }
        if (frame.begin() == frame.end()) return channels;
        Imf::InputPart part(exr, index);
        part.setFrameBuffer(frame);
        const int band = header.hasTileDescription() ? int(header.tileDescription().ySize) : 64;
        for (int row = 0; row < height; row += std::min(band, height - row)) {
            const int end = row + std::min(band, height - row);
            for (Channel& channel : channels)
                if (wanted.contains(channel.name))
                    channel.values.resize(size_t(end) * size_t(width));
            part.readPixels(window.y0 + row, window.y0 + end - 1);
        }
        if (window != image_.data)
            for (Channel& channel : channels)
                if (wanted.contains(channel.name)) channel.values = placed(channel.values, window);
        return channels;
    }

    /// The name of a channel in the image: in further parts it has the part's name in front.
    static std::string name_in_image(const Imf::Header& header, int index,
                                     const std::string& name) {
        if (index == 0 || !header.hasName()) return name;
        const std::string prefix = header.name() + ".";
        return name.starts_with(prefix) ? name : prefix + name;
    }

  private:
    /// The values of a part's window as those of the whole image.
    std::vector<float> placed(const std::vector<float>& values, const PixelBounds& window) const {
        std::vector<float> whole(image_.pixel_count());
        const auto width = size_t(window.width());
        for (size_t row = 0; row < size_t(window.height()); ++row)
            std::copy_n(values.begin() + std::ptrdiff_t(row * width), width,
                        whole.begin() + std::ptrdiff_t((size_t(window.y0 - image_.data.y0) + row) *
                                                           size_t(image_.width()) +
                                                       size_t(window.x0 - image_.data.x0)));
        return whole;
    }

    const Image& image_;
};

/// Most bytes of pixels that one byte of a file may stand for. The strongest compression (of black
/// PIZ images) stays below this; a file that claims more pixels has none of them, and would keep
/// the reader busy for long.
constexpr int64_t kMostPixelBytesPerByte = int64_t(1) << 20;

/// Largest coordinate of a window, so that sums and differences of coordinates stay in an int.
constexpr int kLargestCoordinate = 1 << 29;

/// The window of a header. Errors: DecodeError where it is out of all bounds.
PixelBounds checked_window(const Imath::Box2i& box) {
    for (int coordinate : {box.min.x, box.min.y, box.max.x, box.max.y})
        if (std::abs(int64_t(coordinate)) > kLargestCoordinate)
            throw DecodeError("its windows are out of all bounds");
    return from_imath(box);
}

Image read_parts(const std::filesystem::path& file, const ChannelChoice& choose) {
    check_exr_attribute_sizes(file);
    Imf::MultiPartInputFile exr(file.c_str(), 0);
    Image image;
    image.data = checked_window(exr.header(0).dataWindow());
    image.display = checked_window(exr.header(0).displayWindow());
    bool is_one_window = true;
    for (int i = 1; i < exr.parts(); ++i) {
        const PixelBounds window = checked_window(exr.header(i).dataWindow());
        is_one_window = is_one_window && window == image.data;
        image.data = {std::min(image.data.x0, window.x0), std::min(image.data.y0, window.y0),
                      std::max(image.data.x1, window.x1), std::max(image.data.y1, window.y1)};
    }
    image.metadata = read_metadata(exr.header(0));

    const PartReader reader(image);
    int64_t channels = 0;
    for (int i = 0; i < exr.parts(); ++i) {
        channels += PartReader::channel_count(exr.header(i));
        check_image_size(image.width(), image.height(), channels);
        reader.check(exr.header(i));
    }
    const int64_t pixel_bytes = int64_t(image.pixel_count()) * channels * int64_t(sizeof(float));
    if (pixel_bytes / kMostPixelBytesPerByte > int64_t(std::filesystem::file_size(file)))
        throw DecodeError("the file is too short for its size in pixels");

    std::vector<std::string> names;
    std::set<std::string> known;
    for (int i = 0; i < exr.parts(); ++i)
        for (auto c = exr.header(i).channels().begin(); c != exr.header(i).channels().end(); ++c) {
            names.push_back(PartReader::name_in_image(exr.header(i), i, c.name()));
            if (!known.insert(names.back()).second)
                throw DecodeError("two channels are called '" + names.back() + "'");
        }
    const std::vector<std::string> chosen = choose ? choose(names) : names;
    const std::set<std::string> wanted(chosen.begin(), chosen.end());
    const MemoryReservation room(
        image.pixel_count() * (wanted.size() + (is_one_window ? 0 : 1)) * sizeof(float),
        std::to_string(image.width()) + "x" + std::to_string(image.height()) + " pixels");
    for (int i = 0; i < exr.parts(); ++i)
        for (Channel& channel : reader.read(exr, i, wanted))
            image.channels.push_back(std::move(channel));
    return image;
}

/// The reason in OpenEXR's message, without the sentences in front that name the file.
std::string reason_of(const std::exception& e, const std::filesystem::path& file) {
    const std::string text = e.what();
    const std::string prefix = "\"" + file.string() + "\". ";
    const size_t at = text.rfind(prefix);
    return at == std::string::npos ? text : text.substr(at + prefix.size());
}

}  // namespace

Image read_exr(const std::filesystem::path& file, const SourceLocation& where,
               const ChannelChoice& choose) {
    try {
        return read_parts(file, choose);
    } catch (const std::bad_alloc&) {
        throw_unreadable(file, where, "not enough memory", ErrorKind::limit);
    } catch (const Error& e) {
        throw_unreadable(file, where, e.what(), e.kind());
    } catch (const std::exception& e) {
        throw_unreadable(file, where, reason_of(e, file));
    }
}

}  // namespace covtrace
