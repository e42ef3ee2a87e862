#include "render/film.h"

namespace covtrace {

void FilmPixel::add(const Sample& s) {
    ++count;
    const float share = 1.0f / static_cast<float>(count);
    const Rgb before = s.radiance - mean;
    mean += before * share;
    in_view += (s.in_view - in_view) * share;
    squares += before * (s.radiance - mean);
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

double Film::mean_count() const {
    double sum = 0;
    for (const FilmPixel& p : pixels) sum += p.count;
    return pixels.empty() ? 0 : sum / double(pixels.size());
}

}  // namespace covtrace
