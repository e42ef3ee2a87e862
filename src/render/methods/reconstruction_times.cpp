#include "render/methods/reconstruction_times.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "reconstruction/hybrid.h"
#include "render/hybrid_film.h"

namespace covtrace {

namespace {

/// A part of the image: halves and predicted spectra.
struct Part {
    Halves halves;
    std::vector<Covariance2> spectrum;
};

/// The middle of the image, at most `side` pixels wide and high.
Part middle(const RenderState& s, const Prediction& prediction, int side) {
    const PixelBounds all = s.region;
    const int w = std::min(side, all.width()), h = std::min(side, all.height());
    const PixelBounds part{all.x0 + (all.width() - w) / 2, all.y0 + (all.height() - h) / 2,
                           all.x0 + (all.width() + w) / 2, all.y0 + (all.height() + h) / 2};
    std::vector<Film> films(2, Film(part, film_parts(Method::hybrid)));
    std::vector<Covariance2> spectrum;
    for (int y = part.y0; y < part.y1; ++y)
        for (int x = part.x0; x < part.x1; ++x) {
            const size_t to = size_t(y - part.y0) * size_t(part.width()) + size_t(x - part.x0);
            const size_t from = size_t(y - all.y0) * size_t(all.width()) + size_t(x - all.x0);
            for (size_t k = 0; k < 2; ++k) {
                films[k].pixels[to] = s.films[k].pixels[from];
                films[k].features[to] = s.films[k].features[from];
                films[k].feature_squares[to] = s.films[k].feature_squares[from];
            }
            spectrum.push_back(prediction.spectrum[from]);
        }
    Halves halves = halves_of(films);
    // Eight samples per pixel take longest: with four our own candidates are left out, with 16
    // features are smoothed faster
    constexpr float kOfHalf = 4;
    for (HalfBuffer& half : halves)
        for (float& count : half.count.values) count = kOfHalf;
    // Planes of zeros take the denoiser no time
    for (HalfBuffer& half : halves)
        for (float* v : {&half.color[0][0], &half.feature[0][0], &half.feature[3][0]})
            *v = std::max(*v, 1.0f);
    return {std::move(halves), std::move(spectrum)};
}

/// Seconds per pixel.
struct PixelTime {
    double denoiser = 0, rest = 0;
};

PixelTime time_part(RenderJob& job, const Part& part, const TimedDenoiser* denoiser,
                    DenoiserQuality quality) {
    HybridSettings settings;
    settings.denoiser = denoiser;
    settings.quality = quality;
    const auto denoising = [&] { return denoiser ? job.seconds(Phase::denoise) : 0.0; };
    const double start = job.monitor.elapsed(), before = denoising();
    reconstruct(part.halves, part.spectrum, settings);
    const double denoised = denoising() - before;
    const double pixels = double(part.spectrum.size());
    return {denoised / pixels, (job.monitor.elapsed() - start - denoised) / pixels};
}

/// The time, and the least of three where the image is so large that they take little of it: other
/// work of the machine makes one in a few much longer.
PixelTime least_time(RenderJob& job, const Part& part, const TimedDenoiser* denoiser,
                     DenoiserQuality quality) {
    const bool is_large = job.pixels() >= 40 * int64_t(part.spectrum.size());
    PixelTime least = time_part(job, part, denoiser, quality);
    for (int i = 0; i < 2 && is_large; ++i) {
        const PixelTime again = time_part(job, part, denoiser, quality);
        least.denoiser = std::min(least.denoiser, again.denoiser);
        least.rest = std::min(least.rest, again.rest);
    }
    return least;
}

}  // namespace

ReconstructionTimes reconstruction_times(RenderJob& job, const Prediction& prediction,
                                         const TimedDenoiser* denoiser) {
    constexpr int kTinySide = 16, kSide = 96;
    const PhaseTimer timer(job.monitor, job.seconds(Phase::reconstruction));
    // To start the denoiser takes as long as a part
    if (denoiser)
        time_part(job, middle(job.state, prediction, kTinySide), denoiser, DenoiserQuality::high);
    const Part part = middle(job.state, prediction, kSide);
    const double pixels = double(job.pixels());
    const PixelTime high = least_time(job, part, denoiser, DenoiserQuality::high);
    // Seconds of writing over those of the reconstruction beside the denoiser: 0.28 to 0.36 at
    // 400x300, 960x540 and 1920x1080
    constexpr double kWriting = 0.35;
    const double writing = kWriting * high.rest * pixels;
    ReconstructionTimes times;
    times.without_denoiser = writing + high.rest * pixels;
    if (!denoiser) return times;
    const PixelTime fast = least_time(job, part, denoiser, DenoiserQuality::fast);
    // Memory that the denoiser asks for once, and that is larger than a cache, takes about as long
    // at either quality, and is seen at fast quality alone: 1.45 times the part's time at
    // 1920x1080, 1.2 at 960x540, for 1.07 and 1.06 at high quality.
    constexpr double kMemory = 0.06;
    const double memory = kMemory * high.denoiser;
    times.denoised[DenoiserQuality::high] = writing + (high.denoiser + high.rest + memory) * pixels;
    times.denoised[DenoiserQuality::fast] = writing + (fast.denoiser + fast.rest + memory) * pixels;
    return times;
}

std::optional<DenoiserQuality> affordable_quality(const ReconstructionTimes& times,
                                                  std::optional<DenoiserQuality> asked, double left,
                                                  double sampling) {
    if (times.denoised.empty()) return std::nullopt;
    // High quality errs 1.3 times less, and twice the samples 1.9 times: with fast quality, which
    // takes a fifth of the time, the samples that the rest allows gain as much from here on
    // (docs/decisions/0147).
    constexpr double kMostShare = 0.3;
    const bool is_high_affordable =
        times.denoised.at(DenoiserQuality::high) <= std::max(kMostShare * left, left - sampling);
    const DenoiserQuality quality =
        asked.value_or(is_high_affordable ? DenoiserQuality::high : DenoiserQuality::fast);
    if (times.denoised.at(quality) > std::max(left, times.without_denoiser)) return std::nullopt;
    return quality;
}

}  // namespace covtrace
