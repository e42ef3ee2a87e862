// Laws of the image side: pre-integration, counts, filters.
#include "support.h"

namespace support {
namespace {

using namespace covariance;

Matrix draw_window() {
    return sensor_window(draw(0.05, 2), draw(0.05, 2));
}

RC_GTEST_PROP(Preintegration, IsTheInverseOfTheBlockOfTheInverse, ()) {
    const Matrix s = draw_pd(), w = draw_window();
    const Sym2 expected = inverse(support::inverse(s + w).spatial());
    RC_ASSERT(distance(preintegrate(s, w), expected) < 1e-9);
}

RC_GTEST_PROP(Preintegration, LiesBetweenZeroAndTheInstantPinhole, ()) {
    const Matrix s = draw_psd(), w = draw_window();
    const Sym2 integrated = preintegrate(s, w);
    const double size = trace(s);
    RC_ASSERT(is_psd(integrated, size));
    RC_ASSERT(is_psd(project2(s) - integrated, size));
    // A wider window in frequency (a smaller aperture, a shorter shutter) blurs less.
    const Sym2 narrow = preintegrate(s, 3.0 * w);
    RC_ASSERT(is_psd(narrow - integrated, size));
}

RC_GTEST_PROP(Preintegration, TheSpectrumComesWithTheCount, ()) {
    const Matrix s = draw_psd(), w = draw_window();
    const SensorIntegral<double> both = integrate_over_sensor(s, w);
    RC_ASSERT(distance(both.spectrum, preintegrate(s, w)) == 0);
    RC_ASSERT(both.integration == integration_count(s, w));
}

RC_GTEST_PROP(Preintegration, LimitsOfTheWindow, ()) {
    const Matrix s = draw_pd();
    RC_ASSERT(distance(preintegrate(s, sensor_window(1e14, 1e14)), project2(s)) < 1e-10);
    const Sym2 slice = inverse(support::inverse(s).spatial());
    RC_ASSERT(distance(preintegrate(s, Matrix{}), slice) < 1e-9);
}

RC_GTEST_PROP(Preintegration, DeterminantSplits, ()) {
    const Matrix s = draw_psd(), w = draw_window();
    const Matrix b = s + w;
    Matrix rest = b;  // det of the block u, v, t as that of a 5x5 with ones on the other two axes
    for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t j = 0; j < 5; ++j) rest(i, j) = i == j ? 1 : 0;
    const double whole = determinant(b), split = determinant(rest) * det(preintegrate(s, w));
    const double size = trace(project2(b));
    RC_ASSERT(std::abs(whole - split) <= 1e-9 * determinant(rest) * size * size);
}

RC_GTEST_PROP(Preintegration, TakesSingularMatrices, ()) {
    const Matrix s = draw_psd();
    RC_ASSERT(is_psd(preintegrate(s, Matrix{}), trace(s)));
    RC_ASSERT(preintegrate(Matrix{}, Matrix{}) == Sym2{});
}

TEST(Preintegration, WindowsAreOneOverFourPiSquaredVariance) {
    EXPECT_DOUBLE_EQ(disc_lens_window<>, window_variance(1.0 / 4));
    EXPECT_DOUBLE_EQ(square_lens_window<>, window_variance(1.0 / 3));
    EXPECT_DOUBLE_EQ(box_shutter_window<>, window_variance(1.0 / 12));
    EXPECT_NEAR(disc_lens_window<>, 0.101321, 1e-6);
    EXPECT_NEAR(square_lens_window<>, 0.075991, 1e-6);
    EXPECT_NEAR(box_shutter_window<>, 0.303964, 1e-6);
}

RC_GTEST_PROP(Counts, SplitIsTheDeterminantOfTheWindowedMatrix, ()) {
    const Matrix s = draw_pd(), w = draw_window();
    const double k_img = draw(1, 50);
    const SampleCount<double> n = sample_count(s, w, k_img);
    const double det_window = w(2, 2) * w(3, 3) * w(4, 4);
    const double expected = k_img * std::sqrt(determinant(s + w) / det_window);
    RC_ASSERT(std::abs(n.total / expected - 1) < 1e-8);
    RC_ASSERT(std::abs(n.total - n.image * n.integration) <= 1e-12 * n.total);
    RC_ASSERT(n.integration >= 1);
}

RC_GTEST_PROP(Counts, NothingOverLensAndTimeNeedsOneSample, ()) {
    Matrix s;
    s.set_spatial(draw_pd2());
    RC_ASSERT(integration_count(s, draw_window()) == 1.0);
    RC_ASSERT(integration_count(s, Matrix{}) == 1.0);
}

RC_GTEST_PROP(Counts, FilterAveragesKappaTimesTheIntegrationCount, ()) {
    const Matrix s = draw_pd(), w = draw_window();
    const double c = draw(1, 3), kappa = draw(1, 16);
    const FilterLimits<double> open{1e-9, 1e9};
    const Sym2 spectrum = preintegrate(s, w);
    const SampleCount<double> n = sample_count(s, w, image_factor(c, kappa));
    const Sym2 filter = filter_covariance(filter_quadratic(spectrum, c, open));
    RC_ASSERT(std::abs(effective_samples(filter, n.total) / (kappa * n.integration) - 1) < 1e-8);
}

TEST(Counts, HighFrequenciesInFloatNeverFallBelowOne) {
    // A moving, defocused edge: rank one and far above the window.
    SymmetricMatrix5<float> s;
    const float w[5] = {3, 1, 700, -200, 900};
    for (std::size_t i = 0; i < 5; ++i)
        for (std::size_t j = i; j < 5; ++j) s(i, j) = w[i] * w[j];
    const double exact = integration_count(cast<double>(s));
    EXPECT_NEAR(integration_count(s) / exact, 1, 0.05);
    EXPECT_TRUE(std::isnan(integration_count(std::nan("") * Matrix::diagonal(1, 1, 1, 1, 1))));
}

TEST(Counts, DensitiesAndClamps) {
    const Sym2 spectrum{0.04, 0, 0.01};
    EXPECT_DOUBLE_EQ(image_density(spectrum), 0.02);
    EXPECT_DOUBLE_EQ(thesis_density(spectrum, 50), 1.0);
    // The factor is pi sqrt(det W_rr), with W_rr of a disc and a box shutter.
    EXPECT_DOUBLE_EQ(hypercube_density(spectrum, 50),
                     pi<double> * disc_lens_window<double> * std::sqrt(box_shutter_window<double>));
    EXPECT_DOUBLE_EQ(tempered_density(spectrum, 50), std::sqrt(0.08));
    EXPECT_DOUBLE_EQ(tempered_density(spectrum, 2), std::sqrt(0.04));
    EXPECT_DOUBLE_EQ(variance_density(3.0, spectrum, 2), 1.5 * std::sqrt(0.02));
    EXPECT_EQ(thesis_count(3.6, 1, 100), 4);
    EXPECT_EQ(thesis_count(0.2, 1, 100), 1);
    EXPECT_EQ(thesis_count(1e9, 1, 100), 100);
    EXPECT_EQ(thesis_count(std::nan(""), 1, 100), 100);
    EXPECT_DOUBLE_EQ(share_of_budget(2.0, 2, 16), 16);
    EXPECT_DOUBLE_EQ(share_of_budget(0.0, 2, 16), 1.6);
    EXPECT_DOUBLE_EQ(share_of_budget(0.0, 0, 16), 16);
    EXPECT_DOUBLE_EQ(lattice_factor(3.0), 243);
    EXPECT_EQ(image_density(Sym2{1, 2, 1}), 0);
}

RC_GTEST_PROP(Filters, EigenvaluesStayWithinTheLimits, ()) {
    const Sym2 spectrum = draw(1e-4, 10) * draw_pd2();
    const auto e = eigen(filter_covariance(filter_quadratic(spectrum, draw(0.5, 3), {0.5, 15})));
    RC_ASSERT(e.low >= 0.25 * (1 - 1e-9));
    RC_ASSERT(e.high <= 225 * (1 + 1e-9));
    // The same limits on the spectrum side give the same filter.
    const double c = draw(0.5, 3);
    const Sym2 limited = limit_spectrum(spectrum, c, 0.5, 15);
    RC_ASSERT(distance(filter_quadratic(limited, c, {0.5, 15}),
                       filter_quadratic(spectrum, c, {0.5, 15})) < 1e-9);
}

TEST(Filters, SharpnessWeightsAndSizes) {
    EXPECT_DOUBLE_EQ(filter_sharpness(16.0), 2);
    EXPECT_DOUBLE_EQ(filter_sharpness(1024.0), 4);
    const Sym2 q = filter_quadratic(Sym2{1, 0, 1}, 1, {1e-3, 1e3});
    EXPECT_NEAR(q.xx, 4 * M_PI * M_PI, 1e-12);
    EXPECT_NEAR(thesis_filter_quadratic(Sym2{1, 0, 1}, {1e-3, 1e3}).xx, 2 * M_PI, 1e-12);
    EXPECT_DOUBLE_EQ(filter_weight(Sym2{1, 0.5, 2}, 1, -1), std::exp(-1.0));
    const Sym2 cov{4, 0, 1};
    EXPECT_DOUBLE_EQ(filter_size(cov), std::sqrt(2));
    const Sym2 half = resize_filter(cov, std::sqrt(2) / 2, {0.1, 15});
    EXPECT_NEAR(half.xx, 1, 1e-12);
    EXPECT_NEAR(half.yy, 0.25, 1e-12);
}

RC_GTEST_PROP(Sensor, DoesNotDependOnTheFrameOfTheRay, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const Frame view = draw_frame(draw_leaving(-field.frame.z));
    const ThinLens<double> camera{view.x,       view.y,     view.z,     draw(0.5, 5),
                                  draw(0, 0.3), draw(1, 9), draw(1, 9), draw(0.1, 1)};
    RC_ASSERT(distance(sensor(rotate_to(field, draw_frame_like(field.frame)), camera),
                       sensor(field, camera)) < 1e-10);
}

RC_GTEST_PROP(Sensor, PinholeAndInfiniteFocus, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const Frame view = draw_frame(-field.frame.z);
    ThinLens<double> camera{.e1 = view.x, .e2 = view.y, .e3 = view.z};
    const Matrix pinhole = sensor(field, camera);
    RC_ASSERT(pinhole.angular() == Sym2{});
    RC_ASSERT(pinhole.cross() == Mat2{});
    RC_ASSERT(is_finite(pinhole));
    camera.lens_radius = 0.1;
    RC_ASSERT(is_finite(sensor(field, camera)));
}

}  // namespace
}  // namespace support
