#include "bsdf/coat_table.h"

#include "bsdf/facet_quadrature.h"
#include "bsdf/hemisphere_mean.h"

namespace covtrace {
namespace {

float attenuation(float thickness, float cos_theta) {
    return cos_theta > 0 ? std::exp(-thickness / cos_theta) : 0;
}

/// Shares of the energy from one direction that an interface reflects and transmits, each weakened
/// by the gap where it runs inside.
struct InterfaceShares {
    float reflected = 0, transmitted = 0;
};

/// An interface as seen by the arriving light: the index beyond it relative to this side, and the
/// gap's thickness on the side of reflection and on that of transmission.
struct Interface {
    float eta;
    float gap_reflected, gap_transmitted;
};

InterfaceShares smooth_shares(const Interface& side, float cos_o) {
    const DielectricFresnel f = fresnel_dielectric(cos_o, side.eta);
    return {f.reflectance * attenuation(side.gap_reflected, cos_o),
            (1 - f.reflectance) * attenuation(side.gap_transmitted, f.cos_t)};
}

InterfaceShares rough_shares(const Interface& side, float alpha, float cos_o) {
    InterfaceShares sum;
    for_each_facet(side.eta, alpha, cos_o, [&](const MetFacet& facet) {
        const float f = facet.fresnel.reflectance;
        sum.reflected += facet.weight * f * facet.kept_reflected *
                         attenuation(side.gap_reflected, facet.cos_reflected);
        sum.transmitted += facet.weight * (1 - f) * facet.kept_transmitted *
                           attenuation(side.gap_transmitted, facet.cos_transmitted);
    });
    return sum;
}

InterfaceShares interface_shares(const Interface& side, float alpha, float cos_o) {
    if (cos_o <= 0) return {1, 0};
    return alpha > 0 && side.eta != 1 ? rough_shares(side, alpha, cos_o)
                                      : smooth_shares(side, cos_o);
}

/// Mean of g(cos) over the cosine-weighted hemisphere, where cos^2 is uniform; g may have a kink at
/// cos^2 = `kink`.
template <typename Function>
float cosine_weighted_mean(float kink, Function g) {
    static const Quadrature<24> nodes;
    double below = 0, above = 0;
    for (size_t i = 0; i < nodes.x.size(); ++i) {
        below += nodes.weight[i] * g(std::sqrt(kink * nodes.x[i]));
        above += nodes.weight[i] * g(std::sqrt(kink + (1 - kink) * nodes.x[i]));
    }
    return static_cast<float>(below * kink + above * (1 - kink));
}

}  // namespace

CoatTable::CoatTable(float eta, float thickness) : eta_(eta), thickness_(thickness) {
    const Interface outside{eta, 0, thickness}, inside{1 / eta, thickness, 0};
    // Kinks lie where total reflection begins, on the side that has it; on the other side any angle
    // will do.
    const float inside_kink = eta > 1 ? 1 - 1 / sqr(eta) : 0.5f;
    const float outside_kink = eta < 1 ? 1 - sqr(eta) : 0.5f;
    for (int row = 0; row < kRows; ++row) {
        const float alpha = sqr(static_cast<float>(row) / (kRows - 1));
        auto& nodes = shares_[row];
        for (int i = 0; i < kNodes; ++i) {
            const float x = static_cast<float>(i) / (kNodes - 1);
            const InterfaceShares s = interface_shares(outside, alpha, x * x);
            nodes[i + 1] = {s.transmitted, s.reflected};
        }
        continue_past_ends(nodes);
        internal_reflectance_[row] = cosine_weighted_mean(inside_kink, [&](float cos_theta) {
            return attenuation(thickness, cos_theta) *
                   interface_shares(inside, alpha, cos_theta).reflected;
        });
    }
    // The means come after all rows, as a lookup between rows reads the next row too.
    for (int row = 0; row < kRows; ++row) {
        mean_transmission_[row] = cosine_weighted_mean(outside_kink, [&](float cos_theta) {
            return row == 0 ? interface_shares(outside, 0, cos_theta).transmitted
                            : shares(static_cast<float>(row), cos_theta).transmission;
        });
        mean_reflection_[row] = cosine_weighted_mean(outside_kink, [&](float cos_theta) {
            return row == 0 ? interface_shares(outside, 0, cos_theta).reflected
                            : shares(static_cast<float>(row), cos_theta).reflection;
        });
    }
}

CoatTable::CoatTable(float eta, const CoatTable& white) : CoatTable(eta, 0) {
    gives_back_ = true;
    const float once = mean_reflection_[0];  // a smooth border's
    for (int row = 0; row < kRows; ++row) {
        const float kept = white.mean_reflection_[row];
        regained_[row] = once * kept / (1 - once * (1 - kept));
        for (int i = 0; i < kNodes + 2; ++i) {
            const float w = white.shares_[row][i].reflection;
            Shares& s = shares_[row][i];
            s.reflection *= 1 + regained_[row] * (1 - w) / w;
            s.transmission = 1 - s.reflection;
        }
    }
    for (int row = 1; row < kRows; ++row) {
        mean_reflection_[row] = cosine_weighted_mean(0.5f, [&](float cos_theta) {
            return shares(static_cast<float>(row), cos_theta).reflection;
        });
        mean_transmission_[row] = 1 - mean_reflection_[row];
    }
}

const CoatTable& CoatTables::get(float eta, float thickness) {
    for (const auto& table : tables_)
        if (table->eta() == eta && table->thickness() == thickness && !table->gives_back())
            return *table;
    tables_.push_back(std::make_unique<const CoatTable>(eta, thickness));
    return *tables_.back();
}

const CoatTable& CoatTables::get_bouncing(float eta) {
    for (const auto& table : tables_)
        if (table->eta() == eta && table->gives_back()) return *table;
    const CoatTable& white = get(kWhiteIndex, 0);
    tables_.push_back(std::make_unique<const CoatTable>(eta, white));
    return *tables_.back();
}

namespace {

/// The coat's part of the model; the base is still missing.
CoatedDiffuseBsdf coat_alone(const CoatTable& table, float alpha_x, float alpha_y) {
    CoatedDiffuseBsdf b;
    b.eta = table.eta();
    b.alpha_x = alpha_x;
    b.alpha_y = alpha_y;
    b.table = &table;
    b.table_row = CoatTable::row_of(alpha_x, alpha_y);
    b.mean_transmission = table.mean_transmission(b.table_row);
    return b;
}

/// Cosine-weighted mean of what a total coat reflects, of a tinted one in the channel that reflects
/// most.
float mean_reflection(const CoatTable& table, const CoatedDiffuseBsdf& b) {
    const CoatTint& tint = b.tint;
    const float coat = table.mean_reflection(b.table_row);
    if (!tint.white) return coat;
    const float white = tint.white->mean_reflection(b.table_row);
    if (!(tint.film.weight > 0)) return max_component(tinted(tint, b.eta, 1, coat, white));
    return hemisphere_mean([&](float cosine) {
        return max_component(tinted(tint, b.eta, table, b.table_row, cosine));
    });
}

}  // namespace

CoatedDiffuseBsdf make_coated_diffuse(const CoatTable& table, const ReflectancePowers& base,
                                      float alpha_x, float alpha_y, int bounces) {
    CoatedDiffuseBsdf b = coat_alone(table, alpha_x, alpha_y);
    b.reflectance = base[0];
    b.base = sum_of_bounces(base, table.internal_reflectance(b.table_row), bounces) *
             (kInvPi / sqr(table.eta()));
    return b;
}

CoatedDiffuseBsdf make_coated_total(const CoatTable& table, Rgb reflectance, float alpha_x,
                                    float alpha_y, const CoatTint& tint, const CoatTable* white) {
    CoatedDiffuseBsdf b = coat_alone(table, alpha_x, alpha_y);
    b.reflectance = reflectance;
    b.is_total = true;
    b.white = white;
    b.tint = tint;
    b.mean_transmission = 1 - mean_reflection(table, b);
    // Nothing is left for the base where the coat reflects everything.
    b.base = b.mean_transmission > 0 ? reflectance * (kInvPi / b.mean_transmission) : Rgb(0);
    return b;
}

}  // namespace covtrace
