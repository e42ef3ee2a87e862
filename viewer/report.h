/// The report: one HTML file that shows images with all their layers. It needs no network, no other
/// file, nothing but the page's own script. Works from file:// in browsers that have
/// DecompressionStream (Chromium 80, Firefox 113, Safari 16.4).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "image/image.h"

namespace covtrace::viewer {

/// A name and a value that are shown as they are; any text is safe.
struct Fact {
    std::string name, value;
    /// Pixel that the name leads to, in image coordinates.
    std::optional<std::array<int, 2>> pixel = {};
};

struct ReportImage {
    std::string name;    ///< short: the file's name, a method
    const Image* image;  ///< the image, not null; all images of a report have the same data window
    std::vector<Fact> facts;  ///< facts shown beside the image: samples, seconds, errors
    /// FLIP error maps of this image against others, by their index in Report::images.
    std::map<size_t, std::vector<float>> flip;
};

struct Report {
    std::string title;
    std::vector<ReportImage> images;          ///< at least one; the first two are A and B
    std::vector<Fact> facts;                  ///< facts about all images
    std::optional<std::array<int, 2>> pixel;  ///< pixel that is shown first, in image coordinates
};

/// A layer that did not fit, with the index of its image in Report::images.
struct OmittedLayer {
    size_t image;
    std::string layer;
};

/// Largest size of a page, bytes. Browsers hold the page and its decoded values in memory: beyond
/// this they get slow, or give up.
inline constexpr uint64_t kMostReportBytes = uint64_t(256) << 20;

/// Writes the page, values lossless, beside the file's name and renamed (OutputFile). Layers are
/// taken in the order of their use (image, error maps, samples, prediction, the rest) as long as
/// the page stays below `most_bytes`; the others are returned, and named in the page.
///
/// Throws Error(limit) where not even the root colours fit (the message suggests a crop), Error(io)
/// where the file cannot be written, Error(internal) for images of different windows or without
/// pixels.
std::vector<OmittedLayer> write_report(const Report& report, const std::filesystem::path& file,
                                       uint64_t most_bytes = kMostReportBytes);

}  // namespace covtrace::viewer
