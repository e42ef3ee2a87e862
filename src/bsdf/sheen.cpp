#include "bsdf/sheen.h"

namespace covtrace {
namespace {

/// Albedo by midpoints over the cosine's root and half of the azimuths: both sides of the plane of
/// incidence are alike.
float integrate(float alpha, float cos_o) {
    constexpr int kCosines = 64, kAzimuths = 24;
    const Vec3 wo{std::sqrt(1 - cos_o * cos_o), 0, cos_o};
    double sum = 0;
    for (int j = 0; j < kCosines; ++j) {
        const float root = (static_cast<float>(j) + 0.5f) / kCosines;
        const float z = root * root, r = std::sqrt(1 - z * z);
        for (int i = 0; i < kAzimuths; ++i) {
            const float phi = kPi * (static_cast<float>(i) + 0.5f) / kAzimuths;
            sum += 2 * root * sheen_value(alpha, wo, Vec3{r * std::cos(phi), r * std::sin(phi), z});
        }
    }
    return static_cast<float>(sum * 2 * M_PI / (kCosines * kAzimuths));
}

const float kFirstRoot = std::sqrt(SheenTable::kLeastAlpha);

}  // namespace

SheenTable::SheenTable() {
    for (int row = 0; row < kRows; ++row) {
        const float root = kFirstRoot + (1 - kFirstRoot) * static_cast<float>(row) / (kRows - 1);
        for (int i = 0; i < kNodes; ++i) {
            constexpr float kGrazing = 1e-4f;
            const float x = static_cast<float>(i) / (kNodes - 1);
            albedo_[row][i] = integrate(root * root, std::max(kGrazing, x * x));
        }
    }
}

float SheenTable::albedo(float alpha, float cos_theta) const {
    const float x = std::sqrt(clamp01(cos_theta)) * (kNodes - 1);
    const float y = clamp01((std::sqrt(alpha) - kFirstRoot) / (1 - kFirstRoot)) * (kRows - 1);
    const int i = std::min(static_cast<int>(x), kNodes - 2),
              j = std::min(static_cast<int>(y), kRows - 2);
    const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
    const auto at = [&](int row) { return albedo_[row][i] * (1 - s) + albedo_[row][i + 1] * s; };
    return at(j) * (1 - t) + at(j + 1) * t;
}

}  // namespace covtrace
