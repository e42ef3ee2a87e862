#include "integrator/guides/place_tree.h"

#include <algorithm>
#include <numeric>

namespace covtrace {

namespace {

constexpr int kMostTreeDepth = 30;
constexpr float kNormalSpread = 0.8f;  // widest range of a normal's component in a leaf

int longest_axis(Vec3 size) {
    return size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
}

}  // namespace

class PlaceTree::Builder {
  public:
    Builder(PlaceTree& tree, std::span<const Place> places, size_t most, std::vector<Part>& parts)
        : tree_(tree), places_(places), most_(most), parts_(parts) {}

    void build(uint32_t node, Part part, int depth) {
        Bounds3 positions, normals;
        for (uint32_t i : part) {
            positions.extend(places_[i].position);
            normals.extend(places_[i].normal);
        }
        if (part.size() > most_ && depth < kMostTreeDepth) {
            // Surfaces that face elsewhere see something else: normals are split first
            int axis = longest_axis(normals.diagonal());
            float split = (normals.lo[axis] + normals.hi[axis]) / 2;
            if (normals.diagonal()[axis] > kNormalSpread) {
                axis += 3;
            } else {
                axis = longest_axis(positions.diagonal());
                const auto middle = part.begin() + std::ptrdiff_t(part.size() / 2);
                std::nth_element(part.begin(), middle, part.end(), [&](uint32_t a, uint32_t b) {
                    return key(a, axis) != key(b, axis) ? key(a, axis) < key(b, axis) : a < b;
                });
                split = key(*middle, axis);
            }
            const auto second = std::partition(part.begin(), part.end(),
                                               [&](uint32_t i) { return key(i, axis) < split; });
            const auto count = static_cast<size_t>(second - part.begin());
            if (count > 0 && count < part.size()) {
                const auto child = static_cast<uint32_t>(tree_.nodes_.size());
                tree_.nodes_.resize(tree_.nodes_.size() + 2);
                tree_.nodes_[node] = {static_cast<uint32_t>(axis), split, child, 0};
                build(child, part.first(count), depth + 1);
                build(child + 1, part.subspan(count), depth + 1);
                return;
            }
        }
        tree_.nodes_[node] = {0, kNoSplit, node, static_cast<uint32_t>(parts_.size())};
        tree_.depth_ = std::max(tree_.depth_, depth);
        parts_.push_back(part);
    }

  private:
    float key(uint32_t i, int axis) const {
        return axis < 3 ? places_[i].position[axis] : places_[i].normal[axis - 3];
    }

    PlaceTree& tree_;
    std::span<const Place> places_;
    const size_t most_;
    std::vector<Part>& parts_;
};

PlaceTree::PlaceTree(std::span<const Place> places, size_t most, std::vector<uint32_t>& order,
                     std::vector<Part>& parts)
    : nodes_(1) {
    order.resize(places.size());
    std::iota(order.begin(), order.end(), 0u);
    parts.clear();
    Builder(*this, places, most, parts).build(0, order, 0);
}

}  // namespace covtrace
