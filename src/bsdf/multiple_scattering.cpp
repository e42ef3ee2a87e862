#include "bsdf/multiple_scattering.h"

#include "bsdf/hemisphere_mean.h"
#include "bsdf/models.h"

namespace covtrace {

ConductorBsdf with_multiple_scattering(ConductorBsdf metal, const CoatTable& white) {
    metal.white = &white;
    metal.table_row = CoatTable::row_of(metal.alpha_x, metal.alpha_y);
    const float kept = white.mean_reflection(metal.table_row);
    const Rgb mean = hemisphere_mean([&](float cosine) { return reflectance(metal, cosine); });
    metal.regained = mean * kept / (Rgb(1) - mean * (1 - kept));
    return metal;
}

DielectricBsdf with_multiple_scattering(DielectricBsdf glass, const CoatTable& from_outside,
                                        const CoatTable& from_inside, const FilmTable* under_film) {
    glass.from_outside = &from_outside;
    glass.from_inside = &from_inside;
    glass.under_film = under_film;
    glass.table_row = CoatTable::row_of(glass.alpha_x, glass.alpha_y);
    return glass;
}

ThinDielectricBsdf with_multiple_scattering(ThinDielectricBsdf pane, const CoatTable& white) {
    pane.white = &white;
    pane.table_row = CoatTable::row_of(pane.alpha_x, pane.alpha_y);
    return pane;
}

}  // namespace covtrace
