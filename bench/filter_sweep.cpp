// Sweeps the constants of the reconstruction filter over finished renders, without rendering again:
//
//     filter_sweep IMAGE.exr REFERENCE.exr [IMAGE.exr REFERENCE.exr ...]
//
// IMAGE holds all layers of `render --method covariance`. Prints trimmed relMSE per image and the
// geometric mean over the images, for the width factor c, the narrowest deviation s_min and the
// slope by which a filter may widen away from a narrower one. docs/decisions/0004 has the table.
#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "image/compare.h"
#include "planner/covariance_buffer.h"
#include "reconstruction/gather.h"

using namespace covtrace;

namespace {

struct Case {
    Image image, reference;
    Prediction prediction;
    std::vector<Rgb> mean;
    std::vector<float> variance;
    std::vector<uint32_t> count;
};

Case load(const char* image_file, const char* reference_file) {
    Case c{read_image(image_file), read_image(reference_file), {}, {}, {}, {}};
    CovarianceBuffer buffer(c.image.width(), c.image.height());
    const auto channel = [&c](const std::string& name) -> const std::vector<float>& {
        const Channel* found = c.image.find(name);
        if (!found) throw Error(ErrorKind::usage, "no layer '" + name + "'");
        return found->values;
    };
    for (size_t row = 0; row < 5; ++row)
        for (size_t column = row; column < 5; ++column) {
            const auto& values = channel(fmt::format("cov.{}{}", row, column));
            for (size_t i = 0; i < values.size(); ++i)
                buffer.covariance[i](row, column) = values[i];
        }
    buffer.weight = channel("covweight.Y");
    c.prediction = preintegrate(smooth(buffer));
    const auto &r = channel("raw.R"), &g = channel("raw.G"), &b = channel("raw.B");
    for (size_t i = 0; i < r.size(); ++i) {
        c.mean.emplace_back(r[i], g[i], b[i]);
        c.count.push_back(uint32_t(channel("samples.Y")[i]));
    }
    c.variance.assign(r.size(), 0.0f);
    return c;
}

double error(const Case& c, const FilterSettings& settings) {
    FilterField field = filter_field(c.prediction.spectrum, c.prediction.width, c.prediction.height,
                                     FilterRule::verified, settings);
    limit_by_neighbours(field, settings);
    const GatheredImage gathered = gather(c.mean, c.variance, c.count, field);
    Image result;
    result.data = c.image.data;
    result.display = c.image.display;
    for (int k = 0; k < 3; ++k) {
        Channel& out = result.add_channel(std::string(1, "RGB"[k]));
        for (size_t i = 0; i < gathered.color.size(); ++i) out.values[i] = gathered.color[i][k];
    }
    return compare(result, c.reference).relmse_trimmed;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3 || argc % 2 == 0) {
        fmt::print(stderr, "usage: filter_sweep IMAGE REFERENCE [IMAGE REFERENCE ...]\n");
        return 2;
    }
    try {
        std::vector<Case> cases;
        for (int i = 1; i < argc; i += 2) cases.push_back(load(argv[i], argv[i + 1]));
        fmt::print("    c  s_min  slope  geometric mean   relMSE x 1e5 per image\n");
        for (float c : {1.5f, 2.0f, 2.5f, 3.0f, 4.0f})
            for (float s_min : {0.25f, 0.32f, 0.4f, 0.5f, 0.6f})
                for (float slope : {0.03f, 0.05f, 0.1f, 0.2f}) {
                    double log_sum = 0;
                    std::string each;
                    for (const Case& k : cases) {
                        const double e = error(k, {c, {s_min, 15}, slope});
                        log_sum += std::log(e);
                        each += fmt::format(" {:8.1f}", 1e5 * e);
                    }
                    fmt::print("{:5.1f} {:6.2f} {:6.2f} {:15.6f} {}\n", c, s_min, slope,
                               std::exp(log_sum / double(cases.size())), each);
                }
    } catch (const std::exception& e) {
        fmt::print(stderr, "filter_sweep: {}\n", e.what());
        return 1;
    }
}
