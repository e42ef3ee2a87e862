/// The mean of several images of the same pixels: halves of a reference made one.
///
///     mean_image OUT.exr IMAGE.exr IMAGE.exr ...
///
/// Keeps the root channels R, G, B and the metadata of the first.
#include <fmt/format.h>

#include <span>

#include "image/image.h"

using namespace covtrace;

namespace {

void write_mean(const char* out, std::span<char*> files) {
    const Image first = read_image(files[0]);
    Image mean;
    mean.data = first.data;
    mean.display = first.display;
    mean.metadata = first.metadata;
    for (const char* name : {"R", "G", "B"}) mean.add_channel(name);
    for (const char* file : files) {
        const Image image = read_image(file);
        if (image.data != first.data)
            throw Error(ErrorKind::usage,
                        fmt::format("{}: has other pixels than {}", file, files[0]));
        for (size_t i = 0; i < image.pixel_count(); ++i) {
            const Rgb c = image.rgb(i);
            for (int k = 0; k < 3; ++k)
                mean.channels[size_t(k)].values[i] += c[k] / float(files.size());
        }
    }
    write_exr(mean, out);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3) {
        fmt::print(stderr, "usage: mean_image OUT IMAGE ...\n");
        return 2;
    }
    try {
        write_mean(argv[1], std::span(argv + 2, argv + argc));
    } catch (const std::exception& e) {
        fmt::print(stderr, "mean_image: {}\n", e.what());
        return 1;
    }
}
