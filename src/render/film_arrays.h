/// The arrays that a film file holds, in their order.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "render/render_state.h"

namespace covtrace {

/// An array of the film: one record per pixel, row by row.
struct FilmArray {
    std::string name;
    void* records = nullptr;
    size_t record_size = 0;  ///< bytes, a multiple of 4
    size_t count = 0;
};

/// The arrays that the state has; they point into it.
inline std::vector<FilmArray> film_arrays(RenderState& state) {
    std::vector<FilmArray> arrays;
    const auto add = [&](const std::string& name, auto& values) {
        static_assert(sizeof values[0] % 4 == 0);
        if (!values.empty())
            arrays.push_back({name, values.data(), sizeof values[0], values.size()});
    };
    for (size_t k = 0; k < state.films.size(); ++k) {
        const std::string film = "film" + std::to_string(k);
        add(film + ".pixels", state.films[k].pixels);
        add(film + ".in_view", state.films[k].in_view);
        add(film + ".features", state.films[k].features);
        add(film + ".feature_squares", state.films[k].feature_squares);
        add(film + ".rays", state.films[k].rays);
        add(film + ".surfaces", state.films[k].surfaces);
        add(film + ".opacity", state.films[k].opacity);
        if (state.in_round()) add(film + ".plan", state.plan[k]);
    }
    if (auto* parts = std::get_if<CovarianceBuffers>(&state.covariances)) {
        add("scattered", parts->scattered);
        add("in_view", parts->in_view);
    } else if (auto* all = std::get_if<std::vector<PackedCovariance>>(&state.covariances)) {
        add("all", *all);
    }
    add("density", state.density);
    return arrays;
}

}  // namespace covtrace
