/// A summary of a whole image, from its layers: counts, filters, errors, and where to look.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cli/pixel_certainty.h"
#include "image/image.h"

namespace covtrace::cli {

/// Distribution of the finite values of a quantity; all 0 where there is none.
struct Distribution {
    double least = 0, low = 0, median = 0, high = 0, most = 0;  ///< low, high: 5 % and 95 %
    double mean = 0;
};

struct Quantity {
    std::string key;    ///< "samples", "density", "filter_width", "filter_elongation", "error"
    std::string title;  ///< for people, with the unit
    Distribution distribution;
};

struct UncertainPixel {
    int x = 0, y = 0;
    PixelCertainty certainty;
};

struct ImageSummary {
    std::string origin;  ///< one line about how our own images were made; empty for others
    std::vector<Quantity> quantities;  ///< quantities whose layers the image has
    int64_t nonfinite = 0;             ///< number of such values in all channels
    /// Square root of the mean of the squared relative errors, which `render --error` compares; 0
    /// without the layer `error`.
    double estimated_error = 0;
    /// The worst pixels, worst first, apart from each other.
    std::vector<UncertainPixel> uncertain;
};

/// Summarises the layers that have the project's own names; other images have few quantities.
ImageSummary summarize(const Image& image);

/// Text about the image in the file `name`: our own metadata in words, the quantities as a table,
/// the layers with their ranges.
std::string to_text(const ImageSummary& summary, const Image& image, const std::string& name);
nlohmann::json to_json(const ImageSummary& summary, const Image& image, const std::string& name);

}  // namespace covtrace::cli
