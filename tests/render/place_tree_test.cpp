#include "integrator/guides/place_tree.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "core/rng.h"
#include "core/warp.h"

namespace covtrace {
namespace {

constexpr size_t kMost = 16;

/// The leaf of each place is the part that was told for it, and each place is in one.
void expect_places_in_their_parts(const std::vector<PlaceTree::Place>& places) {
    std::vector<uint32_t> order;
    std::vector<PlaceTree::Part> parts;
    const PlaceTree tree(places, kMost, order, parts);
    std::set<uint32_t> seen;
    for (size_t k = 0; k < parts.size(); ++k) {
        for (uint32_t i : parts[k]) {
            EXPECT_EQ(tree.leaf(places[i].position, places[i].normal), k) << i;
            seen.insert(i);
        }
    }
    EXPECT_EQ(seen.size(), places.size());
}

TEST(PlaceTree, FindsTheLeafOfEachPlace) {
    Rng rng(1);
    std::vector<PlaceTree::Place> places(2000);
    for (PlaceTree::Place& p : places)
        p = {{rng.next_float(), rng.next_float() * 8, rng.next_float() * rng.next_float()},
             square_to_sphere({rng.next_float(), rng.next_float()})};
    expect_places_in_their_parts(places);
}

// Leaves at many depths: each place lies half as far out as the one before, and most in one spot.
TEST(PlaceTree, FindsLeavesOfUnevenDepth) {
    std::vector<PlaceTree::Place> places;
    for (float x = 1; x > 1e-6f; x /= 2) places.push_back({{x, 0, 0}, {0, 0, 1}});
    places.resize(400, {{0, 0, 0}, {0, 0, 1}});
    expect_places_in_their_parts(places);
}

TEST(PlaceTree, IsOneLeafForFewPlaces) {
    std::vector<uint32_t> order;
    std::vector<PlaceTree::Part> parts;
    const std::vector<PlaceTree::Place> places(3, {{1, 2, 3}, {0, 0, 1}});
    const PlaceTree tree(places, kMost, order, parts);
    EXPECT_EQ(parts.size(), 1u);
    EXPECT_EQ(tree.leaf({-5, 7, 1e30f}, {1, 0, 0}), 0u);
}

TEST(PlaceTree, PlacesFarOutsideBelongToALeaf) {
    Rng rng(2);
    std::vector<PlaceTree::Place> places(500);
    for (PlaceTree::Place& p : places) p = {{rng.next_float(), rng.next_float(), 0}, {0, 0, 1}};
    std::vector<uint32_t> order;
    std::vector<PlaceTree::Part> parts;
    const PlaceTree tree(places, kMost, order, parts);
    EXPECT_LT(tree.leaf({kInfinity, kInfinity, kInfinity}, {0, 0, 1}), parts.size());
    EXPECT_LT(tree.leaf({-kInfinity, -kInfinity, -kInfinity}, {0, 0, -1}), parts.size());
}

}  // namespace
}  // namespace covtrace
