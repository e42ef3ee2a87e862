/// Settings of the experiments: their sizes and counts.
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
    std::array<int, 2> spheres;  ///< pixels of `shininess`
    std::array<int, 2> shadows;  ///< pixels of `voxels`
    std::array<int, 2> scene;    ///< pixels of the snooker table and the helicopter
    double board_spp;            ///< samples per pixel of `lens`, `motion` and `shininess`
    double spp;                  ///< samples per pixel of our methods elsewhere
    double reference_spp;        ///< samples per pixel of each of a reference's two halves
    /// Samples per pixel where the search for the path tracer's equal quality gives up.
    double most_spp;
    /// Samples per pixel of the path tracer that Belcour 2012 compares with.
    double thesis_uniform_spp;
    /// Samples per pixel that Belcour 2012 had time for beside the analysis and the reconstruction
    /// of the snooker table: 1328 s where its path tracer takes 1500 s for 512 samples.
    double thesis_spp;
    std::vector<uint64_t> seeds;
};

const Settings& settings_of(Size size);
std::string name_of(Size size);
/// The seeds with commas between them.
std::string text_of(const std::vector<uint64_t>& seeds);

}  // namespace covtrace::reproduce
