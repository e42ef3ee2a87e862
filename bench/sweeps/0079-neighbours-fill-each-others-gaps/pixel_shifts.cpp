/// Finds what each pixel of a tile adds to its Sobol index (core/sampler.cpp, docs/decisions/0079).
///
///     build/release/bench/pixel_shifts pair|camera
///
/// The points that the first 2^a samples of an aligned block of 2^c pixels have in two dimensions
/// are a net if for any r1 + r2 = a + c the first r1 bits of one and the first r2 bits of the other
/// tell them all apart: if the a columns of the Sobol matrices and the c patterns of the pixels,
/// cut to those rows, are independent. In base 2 no patterns do that for all a, c, r1 at once
/// (there are no (0, m, 4)-nets); those with the fewest dependent columns are searched one after
/// the other at random, from several beginnings.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <random>
#include <span>
#include <vector>

#include "core/sobol.h"

using covtrace::kSobolDirections;

namespace {

constexpr int kPatterns = 8, kMostSampleBits = 7;
/// Dependent columns count by how often films have 2^a samples in a half of a pixel.
constexpr std::array<double, kMostSampleBits + 1> kSampleWeights{.3, .7, 1.2, 2, 1.5, 1, .5, .2};
/// Small blocks of 2^c pixels count more, as filters do not cut them.
constexpr std::array<double, kPatterns + 1> kBlockWeights{0, 2, 2.5, 2, 2, 1.5, 1, .7, .5};
/// The worst r1 counts by this beside the mean over all.
constexpr double kWorstWeight = 0.2;

uint32_t sobol(size_t dimension, uint32_t index) {
    uint32_t x = 0;
    for (size_t bit = 0; index != 0; ++bit, index >>= 1)
        if (index & 1u) x ^= kSobolDirections[dimension][bit];
    return x;
}

int dependent(std::span<uint32_t> columns) {
    int count = 0;
    for (size_t i = 0; i < columns.size(); ++i) {
        if (columns[i] == 0) {
            ++count;
            continue;
        }
        const int top = std::bit_width(columns[i]) - 1;
        for (size_t j = i + 1; j < columns.size(); ++j)
            if ((columns[j] >> top) & 1u) columns[j] ^= columns[i];
    }
    return count;
}

struct Pair {
    size_t first, second;
};

/// The weighted mean of dependent columns where blocks have `patterns.size()` bits.
double cost(std::span<const uint32_t> patterns, std::span<const Pair> pairs) {
    const int c = static_cast<int>(patterns.size());
    double total = 0;
    for (const Pair& pair : pairs)
        for (int a = 0; a <= kMostSampleBits; ++a) {
            const int n = a + c;
            double sum = 0;
            int worst = 0;
            for (int r1 = 0; r1 <= n; ++r1) {
                const int r2 = n - r1;
                std::array<uint32_t, 32> columns{};
                for (int j = 0; j < n; ++j) {
                    const uint32_t index = j < a ? 1u << j : patterns[static_cast<size_t>(j - a)];
                    const uint32_t x = r1 > 0 ? sobol(pair.first, index) >> (32 - r1) : 0;
                    const uint32_t y = r2 > 0 ? sobol(pair.second, index) >> (32 - r2) : 0;
                    columns[static_cast<size_t>(j)] = x << r2 | y;
                }
                const int count = dependent(std::span(columns).first(static_cast<size_t>(n)));
                sum += count;
                worst = std::max(worst, count);
            }
            total += kBlockWeights[static_cast<size_t>(c)] *
                     kSampleWeights[static_cast<size_t>(a)] *
                     (sum / (n + 1) + kWorstWeight * worst);
        }
    return total;
}

double total_cost(std::span<const uint32_t> patterns, std::span<const Pair> pairs) {
    double total = 0;
    for (size_t c = 1; c <= patterns.size(); ++c) total += cost(patterns.first(c), pairs);
    return total;
}

/// The first pattern is tried in full, later ones `tries` times; one of the best is kept.
std::vector<uint32_t> search(std::span<const Pair> pairs, uint32_t bits, uint32_t tries,
                             std::mt19937& random) {
    std::vector<uint32_t> patterns;
    for (int k = 0; k < kPatterns; ++k) {
        std::vector<uint32_t> best;
        double least = 1e9;
        patterns.push_back(0);
        for (uint32_t t = 0; t < (k == 0 ? 1u << bits : tries); ++t) {
            patterns.back() = k == 0 ? t : static_cast<uint32_t>(random()) & ((1u << bits) - 1);
            const double here = cost(patterns, pairs);
            if (here < least - 1e-9) {
                least = here;
                best.clear();
            }
            if (here < least + 1e-9) best.push_back(patterns.back());
        }
        patterns.back() = best[random() % best.size()];
    }
    return patterns;
}

int run(std::span<const Pair> pairs, uint32_t bits, uint32_t tries, int beginnings) {
    std::mt19937 random(1);
    double mean = 0;
    for (int i = 0; i < 20; ++i) {
        std::vector<uint32_t> patterns(kPatterns);
        for (uint32_t& p : patterns) p = static_cast<uint32_t>(random()) & 0xffff;
        mean += total_cost(patterns, pairs) / 20;
    }
    std::printf("random patterns, mean of 20: %.1f\n", mean);
    double least = 1e9;
    for (int i = 0; i < beginnings; ++i) {
        const std::vector<uint32_t> patterns = search(pairs, bits, tries, random);
        const double here = total_cost(patterns, pairs);
        if (here >= least) continue;
        least = here;
        std::printf("%.1f:", here);
        for (const uint32_t p : patterns) std::printf(" 0x%04x", p);
        std::printf("\n");
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    constexpr std::array<Pair, 1> kPair{{{0, 1}}};
    // Film, lens (twice, as it is what blurs most), lens and time, film and lens.
    constexpr std::array<Pair, 9> kCamera{
        {{0, 1}, {2, 3}, {2, 3}, {2, 4}, {3, 4}, {0, 2}, {1, 3}, {0, 3}, {1, 2}}};
    if (argc == 2 && std::strcmp(argv[1], "pair") == 0) return run(kPair, 15, 20000, 3);
    if (argc == 2 && std::strcmp(argv[1], "camera") == 0) return run(kCamera, 13, 3000, 6);
    std::fprintf(stderr, "usage: pixel_shifts pair|camera\n");
    return 2;
}
