/// Films of format 3, which had no features of what is seen in mirrors: they are read as if those
/// were the mirrors' own.
#pragma once

#include <array>
#include <vector>

#include "render/film_arrays.h"

namespace covtrace {

/// Where a film of format 3 is read to.
class FilmFormat3 {
  public:
    /// Bytes of a record of the array `filmK.feature_squares`.
    static constexpr size_t kSquaresSize = 28;

    /// `state`: as its header says, with films that have no features. Must outlive this.
    explicit FilmFormat3(RenderState& state);
    /// What the file holds, in its order.
    const std::vector<FilmArray>& arrays() const { return arrays_; }
    /// Makes the features of the state from what was read into the arrays.
    void make_features();

  private:
    struct Squares {
        Rgb albedo;
        Vec3 normal;
        float depth;
    };
    static_assert(sizeof(Squares) == kSquaresSize);

    RenderState& state_;
    std::array<std::vector<Squares>, 2> squares_;
    std::vector<FilmArray> arrays_;
};

}  // namespace covtrace
