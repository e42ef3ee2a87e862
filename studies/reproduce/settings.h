/// How large the experiments are.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace covtrace::reproduce {

enum class Size {
    tiny,   ///< seconds: shows that everything runs; its errors mean little
    quick,  ///< minutes on two cores
    full    ///< hours
};

struct Settings {
    std::array<int, 2> board;    ///< pixels of `lens` and `motion`
    std::array<int, 2> spheres;  ///< of `shininess`
    std::array<int, 2> shadows;  ///< of `voxels`
    std::array<int, 2> scene;    ///< of the snooker table and the helicopter
    double board_spp;            ///< samples per pixel of `lens`, `motion` and `shininess`
    double spp;                  ///< of ours elsewhere
    double reference_spp;        ///< of each of a reference's two halves
    double most_spp;             ///< where the search for the path tracer's equal quality gives up
    double thesis_uniform_spp;   ///< of the path tracer that the thesis compares with
    std::vector<uint64_t> seeds;
};

const Settings& settings_of(Size size);
std::string name_of(Size size);

}  // namespace covtrace::reproduce
