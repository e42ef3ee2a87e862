#include "render/film_format3.h"

namespace covtrace {

FilmFormat3::FilmFormat3(RenderState& state) : state_(state), arrays_(film_arrays(state)) {
    for (size_t k = 0; k < state.films.size(); ++k) {
        squares_[k].resize(state.films[k].feature_squares.size());
        for (FilmArray& a : arrays_)
            if (a.records == state.films[k].feature_squares.data()) {
                a.records = squares_[k].data();
                a.record_size = kSquaresSize;
            }
    }
}

void FilmFormat3::make_features() {
    for (size_t k = 0; k < state_.films.size(); ++k) {
        Film& film = state_.films[k];
        for (size_t i = 0; i < squares_[k].size(); ++i) {
            const FilmPixel& p = film.pixels[i];
            const Squares& s = squares_[k][i];
            film.features.push_back({p.albedo, p.normal, p.depth});
            film.feature_squares[i] = {s.albedo, s.normal.x + s.normal.y + s.normal.z, s.depth};
        }
    }
}

}  // namespace covtrace
