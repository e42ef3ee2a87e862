// The film of a tracer that plans and filters by covariances: colours and covariances of both parts
// of the light, the counts of samples that they ask for, and the filtered image. It holds together
// what covariance_image.hpp, budget.hpp, filter_field.hpp and gather.hpp do one by one:
//
//   Film<double> film(width, height, samples);
//   film.add(x, y, path, grid, camera);  // every pixel, twice: a path and its covariance
//   const auto counts = film.plan();
//   film.add(x, y, path);                // every pixel, the rest of its count: a path alone
//   const auto image = film.filtered();
//
// Allocates: one of the headers for whole images, see renderer.hpp.
#pragma once

#include <cstdint>
#include <vector>

#include "covariance/budget.hpp"
#include "covariance/covariance_image.hpp"
#include "covariance/filter_field.hpp"
#include "covariance/gather.hpp"
#include "covariance/path.hpp"

namespace covariance {

/// Colours, counts and covariances of an image. Pixels are independent of each other: threads may
/// add to different ones at the same time.
template <std::floating_point T = double>
class Film {
  public:
    /// `samples`: how many a pixel shall have on average, those with covariances among them.
    Film(int width, int height, int samples)
        : samples_(samples), scattered_(width, height), in_view_(width, height) {
        const std::size_t n = std::size_t(width) * std::size_t(height);
        color_scattered_.resize(n);
        color_in_view_.resize(n);
        count_.resize(n);
        met_.resize(n);
    }

    /// Adds a sample without a look at its covariance.
    void add(int x, int y, const Path<T>& path) {
        const std::size_t i = index(x, y);
        color_scattered_[i] += path.color(Part::scattered);
        color_in_view_[i] += path.color(Part::in_view);
        ++count_[i];
        if (!path.is_empty()) met_[i] = 1;
    }
    /// Adds a sample and its covariance: of the first few of every pixel, of two say, before
    /// `plan`. Light from behind more than `most_vertices` vertices is left out of the covariance.
    void add(int x, int y, const Path<T>& path, const OccluderGrid<T>& grid,
             const ThinLens<T>& camera, std::size_t most_vertices = 3) {
        add(x, y, path);
        for (const Part part : {Part::scattered, Part::in_view}) {
            const auto [sigma, radiance] = covariance_of(path, part, grid, camera, most_vertices);
            (part == Part::in_view ? in_view_ : scattered_).add(x, y, sigma, radiance);
        }
    }

    /// How many samples each pixel shall have in all, row by row, with the average that was asked
    /// for; at least what it has. Where paths met nothing, and found no sky, none are added.
    [[nodiscard]] std::vector<std::uint32_t> plan() const {
        const auto settings = filter_settings(samples_);
        std::vector<float> density =
            relative_density(preintegrate(smooth(merge(scattered_, in_view_))),
                             DensityRule::tempered, settings.c, settings.limits);
        const int width = scattered_.width, height = scattered_.height;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                if (!met_around(x, y)) density[index(x, y)] = 0;
        const auto most = static_cast<std::uint32_t>(8 * samples_);
        return allocate(density, std::int64_t(samples_) * width * height, count_, most);
    }

    /// The mean of each pixel's samples, without a filter.
    [[nodiscard]] std::vector<Vec3<T>> raw() const {
        std::vector<Vec3<T>> sum = color_scattered_;
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += color_in_view_[i];
        return mean_of(std::move(sum));
    }
    /// The filters of both parts.
    [[nodiscard]] PartFilters<float> filters() const {
        return filters_of_parts(scattered_, in_view_, samples_);
    }
    /// The image through its filters.
    [[nodiscard]] std::vector<Vec3<T>> filtered() const {
        const auto image =
            gather(mean_of(color_scattered_), mean_of(color_in_view_), count_, filters());
        return {image.begin(), image.end()};
    }

    /// Samples taken so far, row by row.
    [[nodiscard]] const std::vector<std::uint32_t>& counts() const noexcept { return count_; }
    /// Mean covariances of one part of the light, over pixels, lens and shutter.
    [[nodiscard]] const CovarianceImage<float>& covariances(Part part) const noexcept {
        return part == Part::in_view ? in_view_ : scattered_;
    }

  private:
    [[nodiscard]] std::size_t index(int x, int y) const noexcept {
        return std::size_t(y) * std::size_t(scattered_.width) + std::size_t(x);
    }

    [[nodiscard]] bool met_around(int x, int y) const noexcept {
        for (int py = std::max(0, y - 1); py <= std::min(scattered_.height - 1, y + 1); ++py)
            for (int px = std::max(0, x - 1); px <= std::min(scattered_.width - 1, x + 1); ++px)
                if (met_[index(px, py)] != 0) return true;
        return false;
    }

    [[nodiscard]] std::vector<Vec3<T>> mean_of(std::vector<Vec3<T>> sums) const {
        for (std::size_t i = 0; i < sums.size(); ++i) sums[i] /= std::max(T(1), T(count_[i]));
        return sums;
    }

    int samples_;
    CovarianceImage<float> scattered_, in_view_;
    std::vector<Vec3<T>> color_scattered_, color_in_view_;
    std::vector<std::uint32_t> count_;
    std::vector<std::uint8_t> met_;  ///< whether a path met anything; not bits, for threads' sake
};

}  // namespace covariance
