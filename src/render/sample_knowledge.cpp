#include "render/sample_knowledge.h"

#include <cmath>

namespace covtrace {

SampleKnowledge knowledge_from(const Film& film,
                               std::span<const covariance::Sym2<float>> spectrum) {
    const int w = film.bounds.width(), h = film.bounds.height();
    SampleKnowledge known;
    known.brightness = Plane(w, h);
    known.variance = Plane(w, h);
    known.cost = Plane(w, h, 1);
    known.spectrum = spectrum;
    for (size_t i = 0; i < film.pixels.size(); ++i) {
        const FilmPixel& p = film.pixels[i];
        known.brightness[i] = luminance(p.mean);
        if (p.count > 1) {
            const Rgb v = p.squares / float(p.count - 1);
            known.variance[i] = sqr(luminance({std::sqrt(v.r), std::sqrt(v.g), std::sqrt(v.b)}));
        }
        if (!film.rays.empty() && p.count > 0) known.cost[i] = float(film.rays[i]) / float(p.count);
    }
    return known;
}

}  // namespace covtrace
