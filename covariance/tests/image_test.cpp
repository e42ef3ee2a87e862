// Covariances of whole images, their filters, the gather and budgets.
#include <covariance/renderer.hpp>

#include "support.h"

namespace support {
namespace {

using namespace covariance;

TEST(CovarianceImage, HoldsWeightedMeansAndRefusesWhatIsNotFinite) {
    CovarianceImage<double> image(2, 2);
    EXPECT_TRUE(image.add(1, 0, Matrix::diagonal(1, 2, 3, 4, 5), 1.0));
    EXPECT_TRUE(image.add(1, 0, Matrix::diagonal(5, 2, 3, 4, 5), 3.0));
    EXPECT_FALSE(image.add(1, 0, Matrix::diagonal(5, NAN, 3, 4, 5), 3.0));
    EXPECT_FALSE(image.add(1, 0, Matrix{}, 0.0));
    EXPECT_FALSE(image.add(1, 0, Matrix{}, NAN));
    EXPECT_DOUBLE_EQ(image.covariance[1](0, 0), 4);
    EXPECT_DOUBLE_EQ(image.weight[1], 4);
    const auto both = merge(image, image);
    EXPECT_DOUBLE_EQ(both.covariance[1](0, 0), 4);
    EXPECT_DOUBLE_EQ(both.weight[1], 8);
    EXPECT_DOUBLE_EQ(both.weight[0], 0);
}

TEST(CovarianceImage, HolesTakeTheNearestCovariance) {
    CovarianceImage<float> image(9, 1);
    image.add(0, 0, Matrix::diagonal(1, 1, 0, 0, 0), 1.0);
    image.add(8, 0, Matrix::diagonal(9, 9, 0, 0, 0), 1.0);
    const auto s = smooth(image);
    EXPECT_FLOAT_EQ(s.covariance[3](0, 0), 1);
    EXPECT_FLOAT_EQ(s.covariance[6](0, 0), 9);
    EXPECT_EQ(smooth(CovarianceImage<float>(3, 1)).covariance[1](0, 0), 0);
}

TEST(CovarianceImage, IntegratesEveryPixelOverLensAndShutter) {
    CovarianceImage<double> image(1, 2);
    Matrix s = Matrix::diagonal(3, 2, 4, 5, 1);
    s(0, 2) = 1, s(1, 4) = 0.5;
    image.add(0, 1, s, 2.0);
    const Prediction<double> p = preintegrate(image);
    EXPECT_NEAR(distance(p.spectrum[1], preintegrate(s)), 0, 1e-12);
    EXPECT_NEAR(p.interior_count[1], integration_count(s), 1e-12);
    EXPECT_EQ(p.interior_count[0], 1);
}

/// Noise of a known Gaussian spectrum: the gather with its filter keeps the Gaussian blob that the
/// spectrum belongs to, up to the blur that c says: variance S + S/c^2.
TEST(Gather, WidensABlobByItsOwnFilterAndNoMore) {
    constexpr int n = 61;
    const Sym2 blob{9, 2, 6};
    Prediction<double> p{n, n, std::vector<Sym2>(n * n, inverse(four_pi_sq<double> * blob)), {}};
    FilterSettings<double> settings;
    settings.c = 2;
    const auto field = filter_field(p, settings);
    std::vector<Vec3> image(n * n);
    const Sym2 q = inverse(blob);
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x)
            image[std::size_t(y * n + x)] = {filter_weight(q, x - n / 2, y - n / 2), 1, 0};
    const auto out = gather(image, std::vector<std::uint32_t>(n * n, 1), field);
    // The tolerance is 2 %, as the filters are cut at three deviations.
    const double peak = std::sqrt(det(blob) / det((1 + 1 / 4.0) * blob));
    EXPECT_NEAR(out[(n / 2) * n + n / 2].x, peak, 0.02 * peak);
    EXPECT_NEAR(out[(n / 2) * n + n / 2].y, 1, 1e-12);
}

TEST(Gather, LeavesOutEmptyPixelsAndWhatIsNotFinite) {
    FilterField<float> field{5, 1, std::vector<covariance::Sym2<float>>(5, {0.04F, 0, 0.04F})};
    std::vector<covariance::Vec3<float>> image(5, {1, 2, 3});
    image[1] = {NAN, 0, 0};
    image[2] = {1000, 0, 0};
    const std::vector<std::uint32_t> count{4, 4, 0, 0, 4};
    const auto out = gather(image, count, field);
    for (const auto& c : out) {
        EXPECT_FLOAT_EQ(c.x, 1);
        EXPECT_FLOAT_EQ(c.z, 3);
    }
    // Numbers in double that the image cannot hold are left out, too.
    std::vector<covariance::Vec3<double>> large(5, {1, 2, 3});
    large[1] = {1e300, 0, 0};
    for (const auto& c : gather(large, count, field)) EXPECT_FLOAT_EQ(c.x, 1);
}

TEST(FilterField, GrowsFromANarrowNeighbourByTheSlope) {
    CovarianceImage<float> image(41, 1);
    for (int x = 0; x < 41; ++x)
        image.add(x, 0, Matrix::diagonal(x == 20 ? 100 : 1e-9, x == 20 ? 100 : 1e-9, 0, 0, 0), 1.0);
    const auto settings = filter_settings(16);
    auto field = filter_field(preintegrate(image), settings);
    limit_by_neighbours(field, settings);
    EXPECT_NEAR(filter_size(field.covariance[20]), 0.5, 1e-5);
    EXPECT_NEAR(filter_size(field.covariance[24]), 0.5 + 4 * 0.25, 1e-4);
    EXPECT_NEAR(filter_size(field.covariance[0]), 0.5 + 20 * 0.25, 1e-3);
}

TEST(FilterField, PartsLimitEachOther) {
    CovarianceImage<float> scattered(21, 1), in_view(21, 1);
    for (int x = 0; x < 21; ++x) scattered.add(x, 0, Matrix::diagonal(1e-9, 1e-9, 0, 0, 0), 1.0);
    in_view.add(10, 0, Matrix::diagonal(1e6, 1e6, 0, 0, 0), 1.0);
    const auto filters = filters_of_parts(scattered, in_view, 16);
    EXPECT_NEAR(filter_size(filters.scattered.covariance[10]), 0.5, 1e-4);
    EXPECT_LT(filter_size(filters.scattered.covariance[12]), 1.01);
    EXPECT_GT(filter_size(filters.scattered.covariance[0]), 2);
    const auto alone = filters_of_parts(scattered, CovarianceImage<float>(21, 1), 16);
    EXPECT_NEAR(filter_size(alone.scattered.covariance[10]), 15, 1e-3);
}

TEST(CovarianceImage, OfNoPixelsStandsForNoLight) {
    CovarianceImage<float> image(2, 1);
    const CovarianceImage<float> none(0, 0);
    image.add(1, 0, Matrix::diagonal(1, 2, 3, 4, 5), 2.0);
    for (const auto& both : {merge(image, none), merge(none, image)}) {
        EXPECT_EQ(both.width, 2);
        EXPECT_EQ(both.covariance, image.covariance);
        EXPECT_EQ(both.weight, image.weight);
    }
}

/// A part without pixels means the same, in filters and image, as one of the same size without
/// light.
TEST(FilterField, PartsWithoutPixelsAreWithoutLight) {
    const CovarianceImage<float> none(0, 0), dark(21, 1);
    CovarianceImage<float> image(21, 1);
    for (int x = 0; x < 21; ++x)
        image.add(x, 0, Matrix::diagonal(x == 10 ? 1e6 : 1e-9, 1e-9, 0, 0, 0), 1.0);
    const auto lit = filters_of_parts(image, none, 16),
               with_dark = filters_of_parts(image, dark, 16);
    EXPECT_EQ(lit.scattered.covariance, with_dark.scattered.covariance);
    EXPECT_EQ(lit.in_view.covariance, with_dark.in_view.covariance);
    const auto bright = filters_of_parts(none, image, 16);
    EXPECT_EQ(bright.in_view.covariance, filters_of_parts(dark, image, 16).in_view.covariance);

    const std::vector<covariance::Vec3<float>> colors(21, {1, 2, 3}), no_colors;
    const std::vector<std::uint32_t> count(21, 1);
    for (const auto& c : gather(colors, no_colors, count, lit)) EXPECT_FLOAT_EQ(c.y, 2);
    for (const auto& c : gather(no_colors, colors, count, bright)) EXPECT_FLOAT_EQ(c.y, 2);
    for (const auto& c : gather(colors, colors, count, lit)) EXPECT_FLOAT_EQ(c.y, 4);
}

TEST(FilterField, OfNoPixelsIsLimitedByNothing) {
    FilterField<float> none, field{3, 1, std::vector<covariance::Sym2<float>>(3, {4, 0, 9})};
    const FilterField<float> before = field;
    const std::vector<bool> known(3, true);
    const auto settings = filter_settings(16);
    limit_parts<float>(field, none, known, {}, settings, settings);
    EXPECT_EQ(field.covariance, before.covariance);
    EXPECT_TRUE(none.covariance.empty());
}

/// Light that few paths find, all of it varying along x alone: between two of them the filter keeps
/// its length only where the distance to them counts as known.
TEST(FilterField, HolesCountAsKnownWithinAChosenDistance) {
    CovarianceImage<float> image(21, 21);
    for (const int x : {7, 13}) image.add(x, 10, Matrix::diagonal(0.05, 1e-9, 0, 0, 0), 1.0);
    const auto middle = [&](const PartFilters<float>& f) {
        return f.scattered.covariance[10 * 21 + 10];
    };
    const CovarianceImage<float> none(0, 0);
    const auto narrow = middle(filters_of_parts(image, none, 16)),
               wide = middle(filters_of_parts(image, none, 16, 3));
    EXPECT_FLOAT_EQ(narrow.xx, narrow.yy);
    EXPECT_GT(wide.yy, 4 * narrow.yy);
    const auto still = middle(filters_of_parts(image, none, 16, 2));
    EXPECT_FLOAT_EQ(still.xx, still.yy);
    EXPECT_LT(wide.xx, wide.yy);
}

RC_GTEST_PROP(Budget, IsSpentToTheLastSampleInProportion, ()) {
    std::vector<double> density;
    for (int i = 0; i < 50; ++i) density.push_back(draw(0.2, 4));
    const std::vector<std::uint32_t> none(50, 0);
    const auto counts = allocate(density, 5000, none, 100000);
    double sum = 0;
    std::int64_t given = 0;
    for (std::size_t i = 0; i < 50; ++i) sum += density[i], given += counts[i];
    RC_ASSERT(given == 5000);
    for (std::size_t i = 0; i < 50; ++i)
        RC_ASSERT(std::abs(counts[i] - 5000 * density[i] / sum) < 1.001);
    const std::vector<std::uint32_t> taken(50, 4);
    for (const std::uint32_t c : allocate(density, 300, taken, 8)) RC_ASSERT(c >= 4 && c <= 8);
}

/// The factor is the multiple of the density that pixels between the limits got.
TEST(Budget, TellsTheFactorThatItMakes) {
    const std::vector<double> density{0.5, 1, 2, 40};
    const std::vector<std::uint32_t> least{4, 0, 0, 0};
    // With the factor 6: 4 where 3 are wanted, 6, 12, and 100 where 240 are wanted.
    EXPECT_NEAR(density_factor(density, 122, least, 100).value(), 6, 1e-6);
    EXPECT_FALSE(density_factor(density, 401, least, 100).has_value());  // all are full
    EXPECT_DOUBLE_EQ(mean_count(density, 6, least, 100), 122.0 / 4);
    EXPECT_EQ(allocate(density, 122, least, 100), (std::vector<std::uint32_t>{4, 6, 12, 100}));
}

/// Counts do not depend on the densities' unit: those of a dark scene may be 1e-30.
TEST(Budget, CountsDoNotDependOnTheUnitOfDensities) {
    const std::vector<double> density{0.5, 1, 2, 40};
    const std::vector<std::uint32_t> least{4, 0, 0, 0}, expected{4, 6, 12, 100};
    for (const double unit : {1e-300, 1e-30, 1e-12, 1e12, 1e30, 1e300}) {
        std::vector<double> scaled = density;
        for (double& d : scaled) d *= unit;
        EXPECT_EQ(allocate(scaled, 122, least, 100), expected) << unit;
        EXPECT_NEAR(density_factor(scaled, 122, least, 100).value_or(0) * unit, 6, 1e-6) << unit;
    }
}

/// A pixel whose density is not a number neither loses the samples that it has nor takes away those
/// of all others.
TEST(Budget, DensitiesThatAreNoNumbersConcernTheirPixelsAlone) {
    const std::vector<std::uint32_t> two(5, 2);
    EXPECT_EQ(allocate(std::vector<double>{NAN, 1, -3, 2, INFINITY}, 38, two, 20),
              (std::vector<std::uint32_t>{2, 5, 2, 9, 20}));
}

TEST(Budget, GivesBackTheFactorOfAnyMean) {
    std::vector<float> density(1000);
    for (std::size_t i = 0; i < density.size(); ++i) density[i] = 0.001F * float(i * i % 977);
    const std::vector<std::uint32_t> none(density.size(), 0);
    for (const double k : {0.3, 5.0, 98.0}) {
        const double total = mean_count(density, k, none, 1U << 30) * double(density.size());
        EXPECT_NEAR(density_factor(density, std::llround(total), none, 1U << 30).value() / k, 1,
                    1 / total);
    }
}

/// The count is sqrt|S + W| in cycles per pixel, aperture and shutter. A radius is 1/sqrt(pi) of
/// the side of a square aperture of the same area.
TEST(Budget, CountsOfTheHypercubeAreTheWholeDeterminant) {
    CovarianceImage<double> image(1, 1);
    Matrix s = Matrix::diagonal(0.01, 0.02, 3, 5, 7);
    s(0, 2) = 0.1, s(1, 4) = -0.2;
    image.add(0, 0, s, 1.0);
    const double window = 1 / (pi<double> * pi<double>);
    const double determinant =
        (0.01 * (3 + window) - 0.1 * 0.1) * (0.02 * (7 + 3 * window) - 0.2 * 0.2) * (5 + window);
    EXPECT_NEAR(hypercube_counts(preintegrate(image), 2, {0.001, 1000})[0],
                pi<double> * std::sqrt(determinant), 1e-9);
}

TEST(Budget, ThesisDensityIsTheRootOfTheDeterminant) {
    CovarianceImage<double> image(2, 1);
    image.add(0, 0, Matrix::diagonal(0.01, 0.01, 0, 0, 0), 1.0);
    image.add(1, 0, Matrix::diagonal(0.04, 0.01, 0, 0, 3), 1.0);
    const auto g = densities(preintegrate(image), DensityRule::thesis, 2, {0.1, 15});
    EXPECT_NEAR(g[1] / g[0], 2 * integration_count(Matrix::diagonal(0, 0, 0, 0, 3)), 1e-9);
    const auto even = relative_density(preintegrate(image), DensityRule::tempered, 2, {0.1, 15});
    EXPECT_NEAR(even[0] + even[1], 2, 1e-12);
}

}  // namespace
}  // namespace support
