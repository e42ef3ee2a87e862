#include "support/predicted_image.h"

#include <fmt/format.h>

namespace covtrace {

PredictedImage read_predicted_image(const std::filesystem::path& file) {
    PredictedImage p;
    p.image = read_image(file);
    const auto channel = [&](const std::string& name) -> const std::vector<float>& {
        const Channel* found = p.image.find(name);
        if (!found)
            throw Error(ErrorKind::usage,
                        fmt::format("{}: no layer '{}', expected a render of --method covariance "
                                    "--layers {}",
                                    file.string(), name, kPredictedLayers));
        return found->values;
    };
    // Without emitters in view all light is scattered.
    const bool emitters = p.image.find("inviewfilter.xx");
    const std::string scattered = emitters ? "scattered" : "";
    CovarianceBuffer buffer(p.image.width(), p.image.height());
    for (size_t row = 0; row < 5; ++row)
        for (size_t column = row; column < 5; ++column) {
            const auto& values = channel(fmt::format("{}cov.{}{}", scattered, row, column));
            for (size_t i = 0; i < values.size(); ++i)
                buffer.covariance[i](row, column) = values[i];
        }
    buffer.weight = channel(scattered + "covweight.Y");
    p.prediction = preintegrated(smoothed(buffer));

    channel("raw.R");
    channel("inview.R");
    const auto &samples = channel("samples.Y"), &weight = channel("covweight.Y");
    const float narrowest = sqr(covariance::filter_settings_in_view(16).limits.s_min);
    p.filters = p.in_view_filters = {p.image.width(), p.image.height(), {}};
    for (size_t i = 0; i < samples.size(); ++i) {
        p.in_view.push_back(p.image.rgb(i, "inview."));
        p.scattered.push_back(p.image.rgb(i, "raw.") - p.in_view.back());
        p.count.push_back(uint32_t(samples[i]));
        // The weights of emitters and of scattered light add up to that of all light.
        p.shows_emitter.push_back(emitters && weight[i] > (1 + 1e-6f) * buffer.weight[i]);
        const auto filter = [&](const std::string& layer) {
            return covariance::Sym2<float>{channel(layer + ".xx")[i], channel(layer + ".xy")[i],
                                           channel(layer + ".yy")[i]};
        };
        p.filters.covariance.push_back(filter("filter"));
        p.in_view_filters.covariance.push_back(
            emitters ? filter("inviewfilter") : covariance::Sym2<float>{narrowest, 0, narrowest});
    }
    return p;
}

}  // namespace covtrace
