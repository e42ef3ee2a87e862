#include <bit>
#include <vector>

#include "image/output_file.h"
#include "image/root_colour.h"
#include "image/write_image.h"

namespace covtrace {

void write_pfm(const Image& image, const std::filesystem::path& file) {
    const RootColour colour = root_colour(image, file);
    const size_t channels = colour.is_grey ? 1 : 3;
    const auto width = size_t(image.width());
    OutputFile output(file);
    // The sign of the scale tells the order of the bytes: negative for the lowest first.
    const std::string header = std::string(colour.is_grey ? "Pf" : "PF") + "\n" +
                               std::to_string(width) + " " + std::to_string(image.height()) + "\n" +
                               (std::endian::native == std::endian::little ? "-1.0" : "1.0") + "\n";
    output.write(header.data(), header.size());
    std::vector<float> row(width * channels);
    for (auto y = size_t(image.height()); y-- > 0;) {  // from the bottom
        for (size_t x = 0; x < width; ++x)
            for (size_t c = 0; c < channels; ++c)
                row[x * channels + c] = colour.channels[c]->values[y * width + x];
        output.write(row.data(), row.size() * sizeof(float));
    }
    output.commit();
}

}  // namespace covtrace
