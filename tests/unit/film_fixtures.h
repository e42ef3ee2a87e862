/// Films with any content, for tests.
#pragma once

#include <random>

#include "render/film_arrays.h"

namespace covtrace::test {

/// A state with random bits in all of its arrays.
inline RenderState random_state(Method method, Stage stage, bool in_round, PixelBounds region) {
    RenderState s;
    s.identity = {{"version", "1"}, {"--seed", "18446744073709551615"}, {"scene", "äöü\n\"x\""}};
    s.method = method;
    s.region = region;
    s.display = {0, 0, 4000, 3000};
    s.has_holes = true;
    s.metadata = {
        {"spp", 1.0f}, {"n", 3}, {"text", std::string("t")}, {"m", std::vector{0.1f, 2.f}}};
    s.stage = stage;
    s.covariance_spp = 0.1;
    if (stage != Stage::first_paths) s.weight_limit = 1.0 / 3;
    s.taken = 1e-300;
    s.target = 7.1;
    s.spp = 0.3;
    s.seconds = 12.125;
    s.rejected = 1ull << 60;
    s.first_rejected = {{1, 2, 1ull << 40}};
    s.shards = 5;
    s.present = {1, 3};
    const bool hybrid = method == Method::hybrid;
    for (int k = 0; k < (hybrid ? 2 : 1); ++k) {
        s.films.emplace_back(region, film_parts(method));
        if (in_round) s.plan.emplace_back(s.pixels());
    }
    if (hybrid && stage == Stage::rounds)
        s.covariances = std::vector<PackedCovariance>(s.pixels());
    else if (method != Method::uniform)
        s.covariances = CovarianceBuffers(region.width(), region.height());
    if (stage == Stage::rounds && method != Method::uniform) s.density.resize(s.pixels());
    std::mt19937 bits(17);
    for (const FilmArray& a : film_arrays(s)) {
        auto* words = static_cast<uint32_t*>(a.records);
        for (size_t i = 0; i < a.count * a.record_size / 4; ++i) words[i] = uint32_t(bits());
    }
    return s;
}

}  // namespace covtrace::test
