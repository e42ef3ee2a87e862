/// Sample counts by density: the densities and exact budgets of the covariance library
/// (covariance/budget.hpp), and the functions that the renderer's rounds need beside them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/enum_names.h"
#include "core/plane.h"
#include "covariance/budget.hpp"
#include "prediction/covariance_buffer.h"

namespace covtrace {

/// Rules for the density of samples.
enum class DensityRule {
    verified,  ///< tempered, until samples tell where filters leave noise (density_of_noise_left)
    tempered,  ///< the covariance library's rule of that name
    thesis     ///< the covariance library's rule of that name
};

template <>
inline constexpr auto kEnumNames<DensityRule> =
    enum_names<DensityRule>({{DensityRule::verified, "verified"},
                             {DensityRule::tempered, "tempered"},
                             {DensityRule::thesis, "thesis"}});

/// The covariance library's rule by which counts follow from the prediction alone.
constexpr covariance::DensityRule predicted_rule(DensityRule rule) {
    return rule == DensityRule::thesis ? covariance::DensityRule::thesis
                                       : covariance::DensityRule::tempered;
}

/// Emphasis of `rule` beyond the tempered density, (g / g_tempered)^0.7, as a mean over a few
/// pixels since a few paths tell it with much noise: SampleKnowledge::emphasis (docs/decisions/0062
/// has the sweep of the exponent). One in every pixel for the tempered rule itself.
Plane emphasis(const Prediction& prediction, covariance::DensityRule rule, float c,
               const covariance::FilterLimits<float>& limits);

using covariance::allocate;
using covariance::density_factor;
using covariance::mean_count;

/// Shares samples out as allocate() does, but `at_most` limits what one call adds to a pixel, so
/// that repeated calls, in rounds, go beyond it and sample again where the limit of samples left
/// noise: the progressive method of Belcour 2012, section 5.1.3.
std::vector<uint32_t> allocate_on_demand(std::span<const float> density, int64_t total,
                                         std::span<const uint32_t> have, uint32_t at_most);

}  // namespace covtrace
