#include "bsdf/multiple_scattering.h"

#include "bsdf/models.h"

namespace covtrace {
namespace {

/// Cosine-weighted mean of a metal's reflectance over the hemisphere, by Gauss and Legendre's five
/// nodes over the cosine: within 0.001.
Rgb mean_reflectance(const ConductorBsdf& metal) {
    constexpr std::array<float, 5> kCosines{0.046910077f, 0.23076534f, 0.5f, 0.76923466f,
                                            0.95308992f};
    constexpr std::array<float, 5> kWeights{0.11846344f, 0.23931434f, 0.28444444f, 0.23931434f,
                                            0.11846344f};
    Rgb sum;
    for (size_t i = 0; i < kCosines.size(); ++i)
        sum += reflectance(metal, kCosines[i]) * (2 * kCosines[i] * kWeights[i]);
    return sum;
}

}  // namespace

ConductorBsdf with_multiple_scattering(ConductorBsdf metal, const CoatTable& white) {
    metal.white = &white;
    metal.table_row = CoatTable::row_of(metal.alpha_x, metal.alpha_y);
    const float kept = white.mean_reflection(metal.table_row);
    const Rgb mean = mean_reflectance(metal);
    metal.regained = mean * kept / (Rgb(1) - mean * (1 - kept));
    return metal;
}

DielectricBsdf with_multiple_scattering(DielectricBsdf glass, const CoatTable& from_outside,
                                        const CoatTable& from_inside) {
    glass.from_outside = &from_outside;
    glass.from_inside = &from_inside;
    glass.table_row = CoatTable::row_of(glass.alpha_x, glass.alpha_y);
    return glass;
}

}  // namespace covtrace
