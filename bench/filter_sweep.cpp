// Sweeps the constants of the reconstruction filter over finished renders, without rendering again:
//
//     filter_sweep IMAGE.exr REFERENCE.exr [IMAGE.exr REFERENCE.exr ...]
//
// IMAGE holds the layers all,inview,inviewfilter,scatteredcov,scatteredcovweight of `render
// --method covariance`. Prints trimmed relMSE per image and the geometric mean over the images, for
// the width factor c, the narrowest deviation s_min and the slope by which a filter may widen away
// from a narrower one. docs/decisions/0004 has the table.
#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "image/compare.h"
#include "predicted_image.h"
#include "reconstruction/gather.h"

using namespace covtrace;

namespace {

struct Case {
    PredictedImage rendered;
    Image reference;
};

double error(const Case& c, const FilterSettings& settings) {
    const Prediction& prediction = c.rendered.prediction;
    FilterField field = filter_field(prediction.spectrum, prediction.width, prediction.height,
                                     FilterRule::verified, settings);
    limit_by_neighbours(field, settings);
    const std::vector<float> no_variance(c.rendered.count.size(), 0.0f);
    const auto scattered = gather(c.rendered.scattered, no_variance, c.rendered.count, field).color;
    const auto in_view =
        gather(c.rendered.in_view, no_variance, c.rendered.count, c.rendered.in_view_filters).color;
    Image result;
    result.data = c.rendered.image.data;
    result.display = c.rendered.image.display;
    for (int k = 0; k < 3; ++k) {
        Channel& out = result.add_channel(std::string(1, "RGB"[k]));
        for (size_t i = 0; i < scattered.size(); ++i)
            out.values[i] = scattered[i][k] + in_view[i][k];
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
        for (int i = 1; i < argc; i += 2)
            cases.push_back({read_predicted_image(argv[i]), read_image(argv[i + 1])});
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
