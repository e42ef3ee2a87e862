/// A measured BRDF as its file has it, by the adaptive parameterization of Dupuy and Jakob 2018,
/// "An adaptive parameterization for efficient material acquisition and rendering".
///
/// Tables stand over the unit square, bilinear between their nodes, which include its edges. Those
/// over microfacet normals and directions have u = sqrt(2 theta / pi) and v = (phi + pi) / 2 pi.
#pragma once

#include <filesystem>
#include <vector>

#include "core/vec.h"

namespace covtrace {

/// Tables of one size, row by row, one behind the other.
template <typename T>
struct BrdfTables {
    int width = 0, height = 0;
    std::vector<T> values;
};

struct BrdfTensor {
    std::filesystem::path file;
    std::vector<float> phi, theta;  ///< directions towards the viewer, radians, increasing
    BrdfTables<float> normals;      ///< distribution of microfacet normals
    BrdfTables<float> areas;        ///< projected area of the microfacets, by direction
    // One table for each phi and theta, the theta's of one phi together.
    BrdfTables<float> visible_normals;  ///< density of the normals that are seen
    /// Density of the samples that choose a visible normal, and the BRDF over them as a factor on
    /// that of perfect microfacets.
    BrdfTables<float> luminance;
    BrdfTables<Rgb> colours;  ///< as large as `luminance`; linear Rec.709
    /// Whether all depends on the angle between normal and viewer alone, not on phi itself.
    bool is_isotropic() const { return phi.size() <= 2; }
};

}  // namespace covtrace
