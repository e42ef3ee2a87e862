/// Private to this folder: a mesh that changes its shape over the shutter, as pieces that each move
/// by one transform, since shapes move by transforms alone.
///
/// Connected triangles are one piece. The piece that is furthest from its motion is halved until
/// none is further than a share of the way, or there are too many. At the end of the shutter
/// neighbours are apart by no more than what their motions leave.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/transform.h"

namespace covtrace::gltf {

/// The affine map that takes `start` nearest to `end` by least squares: a rotation (Horn 1987,
/// "Closed-form solution of absolute orientation using unit quaternions", JOSA A 4(4)) and the
/// stretch that the rest asks for, with a ridge: along directions in which the points have no
/// extent it is the rotation alone, so points in one plane or line have a map, too. Keeps
/// handedness. `start` and `end` have the same size, at least 1.
Matrix4 nearest_motion(std::span<const Vec3> start, std::span<const Vec3> end);

/// The point nearest to `middle` on the axis about which `motion` turns, or `middle` where it
/// hardly turns: things that hang on a joint go on arcs around it.
Vec3 pivot(const Transform& motion, Vec3 middle);

struct MovingPiece {
    std::vector<uint32_t> triangles;  ///< into the mesh's, ascending
    Matrix4 motion;                   ///< from the start to the end of the shutter
};
struct MovingPieces {
    std::vector<MovingPiece> pieces;
    double left = 0;  ///< the largest distance that a vertex is off, over the largest way of any
};

/// Cuts a mesh into pieces that move from `start` to `end`. Each triangle is in one piece. Where no
/// vertex moves there is one piece that rests.
MovingPieces moving_pieces(std::span<const Vec3> start, std::span<const Vec3> end,
                           std::span<const std::array<uint32_t, 3>> triangles);

/// Largest distance that vertices may be off, as a share of the longest way of any: where pieces
/// meet, gaps of this size open until the shutter closes.
inline constexpr double kLeft = 0.01;
/// Largest distance off, as a share of the longest way, that needs no warning.
inline constexpr double kMostLeftSilently = 0.05;

}  // namespace covtrace::gltf
