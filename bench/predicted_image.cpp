#include "predicted_image.h"

#include <fmt/format.h>

namespace covtrace {

PredictedImage read_predicted_image(const std::filesystem::path& file) {
    PredictedImage p;
    p.image = read_image(file);
    const auto channel = [&](const std::string& name) -> const std::vector<float>& {
        const Channel* found = p.image.find(name);
        if (!found)
            throw Error(ErrorKind::usage, fmt::format("{}: no layer '{}', expected a render of "
                                                      "--method covariance with all its layers",
                                                      file.string(), name));
        return found->values;
    };
    CovarianceBuffer buffer(p.image.width(), p.image.height());
    for (size_t row = 0; row < 5; ++row)
        for (size_t column = row; column < 5; ++column) {
            const auto& values = channel(fmt::format("cov.{}{}", row, column));
            for (size_t i = 0; i < values.size(); ++i)
                buffer.covariance[i](row, column) = values[i];
        }
    buffer.weight = channel("covweight.Y");
    p.prediction = preintegrate(smooth(buffer));
    const auto &r = channel("raw.R"), &g = channel("raw.G"), &b = channel("raw.B");
    const auto& samples = channel("samples.Y");
    for (size_t i = 0; i < r.size(); ++i) {
        p.mean.emplace_back(r[i], g[i], b[i]);
        p.count.push_back(uint32_t(samples[i]));
    }
    p.variance.assign(r.size(), 0.0f);
    return p;
}

}  // namespace covtrace
