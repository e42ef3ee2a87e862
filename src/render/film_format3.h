/// Films of format 3, which had no features of what is seen in mirrors: the features of the mirrors
/// themselves take their place.
#pragma once

#include <array>
#include <vector>

#include "render/film_arrays.h"

namespace covtrace {

/// The place that a film of format 3 is read to.
class FilmFormat3 {
  public:
    /// Bytes of a record of the array `filmK.feature_squares`.
    static constexpr size_t kSquaresSize = 28;

    /// Prepares the arrays for `state`, which is as the film's header says, with films that have no
    /// features. The state must outlive this object.
    explicit FilmFormat3(RenderState& state);
    /// The arrays that the file holds, in its order.
    const std::vector<FilmArray>& arrays() const { return arrays_; }
    /// Makes the features of the state from the arrays, once they are read.
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
