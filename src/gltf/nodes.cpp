#include "gltf/nodes.h"

#include <cmath>

#include "gltf/animation.h"

namespace covtrace::gltf {
namespace {

template <size_t n>
void copy_checked(const Document& document, const std::vector<double>& from,
                  std::array<double, n>& to, const std::string& place) {
    if (from.empty()) return;
    if (from.size() != n) document.refuse(place, "expected " + std::to_string(n) + " numbers");
    for (size_t i = 0; i < n; ++i) {
        if (!(std::abs(from[i]) < 1e30)) document.refuse(place, "expected finite numbers");
        to[i] = from[i];
    }
}

Matrix4 matrix_of(const Pose& p) {
    double x = p.rotation[0], y = p.rotation[1], z = p.rotation[2], w = p.rotation[3];
    const double size = std::sqrt(x * x + y * y + z * z + w * w);
    if (size > 0) x /= size, y /= size, z /= size, w /= size;
    const std::array<std::array<double, 3>, 3> r{
        {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
         {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
         {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}}};
    Matrix4 m;
    for (size_t row = 0; row < 3; ++row) {
        for (size_t column = 0; column < 3; ++column)
            m.m[row][column] = r[row][column] * p.scale[column];
        m.m[row][3] = p.translation[row];
    }
    return m;
}

class Placer {
  public:
    Placer(const Document& document, const std::optional<std::array<float, 2>>& shutter,
           WarningLog& log)
        : document_(document),
          log_(log),
          animations_(document, log),
          shutter_(shutter),
          parents_(document.model.nodes.size(), kNone) {
        if (!animations_.empty() && !shutter)
            log.add(document.place("animations"),
                    "the scene is rendered at rest, at 0 seconds; --shutter T0,T1 opens the "
                    "shutter over a part of its animations");
        find_parents();
    }

    std::vector<PlacedNode> place() {
        for (const int root : roots()) {
            std::vector<Pending> stack{{root, Matrix4{}, Matrix4{}}};
            while (!stack.empty()) {
                const Pending next = stack.back();
                stack.pop_back();
                visit(next, stack);
            }
        }
        return std::move(placed_);
    }

  private:
    static constexpr int kNone = -1;
    struct Pending {
        int node;
        Matrix4 start, end;  ///< of the parent
    };

    void find_parents() {
        const auto& nodes = document_.model.nodes;
        for (size_t i = 0; i < nodes.size(); ++i)
            for (const int child : nodes[i].children) {
                const std::string place = element("nodes", i) + ".children";
                at(document_, nodes, child, "nodes", place);
                int& parent = parents_[static_cast<size_t>(child)];
                if (parent != kNone)
                    document_.refuse(place, "node " + std::to_string(child) +
                                                " is a child of node " + std::to_string(parent) +
                                                " already; expected a tree");
                parent = static_cast<int>(i);
            }
    }

    std::vector<int> roots() {
        const auto& model = document_.model;
        std::vector<int> roots;
        if (model.scenes.empty()) {
            for (size_t i = 0; i < parents_.size(); ++i)
                if (parents_[i] == kNone) roots.push_back(static_cast<int>(i));
            return roots;
        }
        const int scene = model.defaultScene < 0 ? 0 : model.defaultScene;
        const std::string place = element("scenes", static_cast<size_t>(scene)) + ".nodes";
        std::vector<bool> known(parents_.size());
        for (const int node : at(document_, model.scenes, scene, "scenes", "scene").nodes) {
            at(document_, model.nodes, node, "nodes", place);
            // A child among the roots would be there twice; a cycle has no root.
            if (parents_[static_cast<size_t>(node)] != kNone || known[static_cast<size_t>(node)])
                document_.refuse(place, "node " + std::to_string(node) + " is no root");
            known[static_cast<size_t>(node)] = true;
            roots.push_back(node);
        }
        return roots;
    }

    Matrix4 local(int index, double time) const {
        const tinygltf::Node& node = document_.model.nodes[static_cast<size_t>(index)];
        const std::string place = element("nodes", static_cast<size_t>(index));
        if (!node.matrix.empty()) {
            std::array<double, 16> columns{};
            copy_checked(document_, node.matrix, columns, place + ".matrix");
            Matrix4 m;
            for (size_t i = 0; i < 16; ++i) m.m[i % 4][i / 4] = columns[i];
            m.m[3] = {0, 0, 0, 1};  // by the specification, whatever the file says
            return m;
        }
        Pose pose;
        copy_checked(document_, node.translation, pose.translation, place + ".translation");
        copy_checked(document_, node.rotation, pose.rotation, place + ".rotation");
        copy_checked(document_, node.scale, pose.scale, place + ".scale");
        animations_.apply(index, time, pose);
        return matrix_of(pose);
    }

    void visit(const Pending& pending, std::vector<Pending>& stack) {
        const auto [t0, t1] = shutter_.value_or(std::array<float, 2>{0, 0});
        const Matrix4 start = pending.start * local(pending.node, t0);
        const bool rests = !animations_.moves(pending.node) && pending.start == pending.end;
        const Matrix4 end = rests ? start : pending.end * local(pending.node, t1);
        const auto start_transform = Transform::from_matrix(start);
        const auto end_transform = Transform::from_matrix(end);
        if (!start_transform || !end_transform) {
            log_.add(document_.place(element("nodes", static_cast<size_t>(pending.node))),
                     "a scale of zero hides the node and what is below it");
            return;
        }
        placed_.push_back({pending.node, start == end ? AnimatedTransform(*start_transform)
                                                      : AnimatedTransform(*start_transform, t0,
                                                                          *end_transform, t1)});
        const auto& children = document_.model.nodes[static_cast<size_t>(pending.node)].children;
        for (auto it = children.rbegin(); it != children.rend(); ++it)
            stack.push_back({*it, start, end});
    }

    const Document& document_;
    WarningLog& log_;
    const Animations animations_;
    const std::optional<std::array<float, 2>> shutter_;
    std::vector<int> parents_;
    std::vector<PlacedNode> placed_;
};

}  // namespace

std::vector<PlacedNode> place_nodes(const Document& document,
                                    const std::optional<std::array<float, 2>>& shutter,
                                    WarningLog& log) {
    return Placer(document, shutter, log).place();
}

}  // namespace covtrace::gltf
