#include "render/film.h"

namespace covtrace {

namespace {

/// The filter weight that counts for a pixel's sample number `count`, from 1.
float weight_in(const FilmSample& s, uint32_t count) {
    return count > 1 ? s.weight : 1.0f;
}

}  // namespace

void FilmPixel::add(const FilmSample& s) {
    ++count;
    const float share = 1.0f / static_cast<float>(count);
    const Rgb step = (s.radiance - mean) * weight_in(s, count);
    mean += step * share;
    // The first deviation counts nothing: it is left out, as 0 times a square that overflows would
    // not be 0.
    if (count > 1) squares += step * step * (1 - share);
    albedo += (s.albedo - albedo) * share;
    normal += (s.normal - normal) * share;
    coverage += ((s.hit ? 1.0f : 0.0f) - coverage) * share;
    if (s.hit) depth += (s.depth - depth) / (coverage * static_cast<float>(count));
}

Rgb FilmPixel::variance_of_mean() const {
    if (count < 2) return Rgb(0);
    const float n = static_cast<float>(count);
    return squares / (n * (n - 1));
}

void Film::add(size_t i, const FilmSample& s) {
    FilmPixel& p = pixels[i];
    p.add(s);
    if (!in_view.empty())
        in_view[i] +=
            (s.in_view - in_view[i]) * (weight_in(s, p.count) / static_cast<float>(p.count));
    if (!rays.empty()) rays[i] += s.rays;
    if (!opacity.empty()) opacity[i] += (s.opacity - opacity[i]) / static_cast<float>(p.count);
    if (!surfaces.empty() && s.hit)
        surfaces[i].approach(s.surface, 1 / (p.coverage * static_cast<float>(p.count)));
    if (features.empty()) return;
    const float n = static_cast<float>(p.count);
    PathFeatures& f = features[i];
    FeatureSquares& q = feature_squares[i];
    const auto update = [](auto value, auto& mean, auto& squares, float count, auto product) {
        const auto step = value - mean;
        mean += step * (1 / count);
        squares += product(step, value - mean);
    };
    const auto plain = [](auto a, auto b) { return a * b; };
    update(s.features.albedo, f.albedo, q.albedo, n, plain);
    update(s.features.normal, f.normal, q.normal, n, [](Vec3 a, Vec3 b) { return dot(a, b); });
    if (s.hit) update(s.features.depth, f.depth, q.depth, p.coverage * n, plain);
}

double Film::mean_count() const {
    double sum = 0;
    for (const FilmPixel& p : pixels) sum += p.count;
    return pixels.empty() ? 0 : sum / double(pixels.size());
}

}  // namespace covtrace
