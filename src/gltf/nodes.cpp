#include "gltf/nodes.h"

#include <array>
#include <cmath>

#include "gltf/instancing.h"

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

/// Whether KHR_node_visibility lets a node be seen, and what is below it.
bool is_visible(const tinygltf::Node& node) {
    const auto extension = node.extensions.find("KHR_node_visibility");
    if (extension == node.extensions.end()) return true;
    const tinygltf::Value& visible = extension->second.Get("visible");
    return !visible.IsBool() || visible.Get<bool>();
}

class Placer {
  public:
    Placer(const Document& document, int scene, const Animations& animations,
           const std::array<float, 2>& shutter, WarningLog& log)
        : document_(document),
          animations_(animations),
          log_(log),
          shutter_(shutter),
          scene_(scene),
          parents_(document.model.nodes.size(), kNone) {
        placed_.worlds.resize(parents_.size());
        find_parents();
    }

    PlacedNodes place() {
        for (const int root : roots()) {
            std::vector<Pending> stack{{root, Matrix4{}, Matrix4{}, false}};
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
        bool is_hidden;
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

    /// The nodes that the walk begins with. Files list children beside their parents, which the
    /// specification forbids and viewers accept: those are met below the parents, once. Where a
    /// listed node's parent is not in the scene, neither is what the parent does to it, as in
    /// three.js and Khronos's sample viewer; Blender's importer places it by the parent.
    std::vector<int> roots() {
        const auto& model = document_.model;
        std::vector<int> roots;
        if (scene_ < 0) {
            for (size_t i = 0; i < parents_.size(); ++i)
                if (parents_[i] == kNone) roots.push_back(static_cast<int>(i));
            return roots;
        }
        const auto scene = static_cast<size_t>(scene_);
        const std::string place = element("scenes", scene) + ".nodes";
        std::vector<bool> is_listed(parents_.size());
        std::vector<int> listed;
        for (const int node : model.scenes[scene].nodes) {
            at(document_, model.nodes, node, "nodes", place);
            if (is_listed[static_cast<size_t>(node)]) continue;
            is_listed[static_cast<size_t>(node)] = true;
            listed.push_back(node);
        }
        const std::vector<Ancestry> ancestries = find_ancestries(is_listed);
        int below = 0, without_parent = 0;
        for (const int node : listed) {
            const Ancestry ancestry = ancestries[static_cast<size_t>(node)];
            if (ancestry == Ancestry::cycle)
                document_.refuse(
                    place, "node " + std::to_string(node) + " is below itself; expected a tree");
            if (ancestry == Ancestry::below_listed) {
                ++below;
                continue;
            }
            if (parents_[static_cast<size_t>(node)] != kNone) ++without_parent;
            roots.push_back(node);
        }
        if (below > 0)
            log_.add(document_.place(place),
                     std::to_string(below) + " of its " + std::to_string(listed.size()) +
                         " nodes are no roots but below others of it: each is placed once, by its "
                         "parents");
        if (without_parent > 0)
            log_.add(document_.place(place),
                     std::to_string(without_parent) + " of its " + std::to_string(listed.size()) +
                         " nodes are no roots, and their parents are not in the scene: each is "
                         "placed by its own transform");
        return roots;
    }

    /// Kinds of what is above a node: nothing that the scene lists, a node that it lists, or the
    /// node itself.
    enum class Ancestry { cycle, free, below_listed };

    /// The ancestry of each node, by a walk from the roots of the whole file, which meets all nodes
    /// but those in cycles.
    std::vector<Ancestry> find_ancestries(const std::vector<bool>& is_listed) const {
        std::vector<Ancestry> result(parents_.size(), Ancestry::cycle);
        std::vector<int> stack;
        for (size_t i = 0; i < parents_.size(); ++i)
            if (parents_[i] == kNone) {
                result[i] = Ancestry::free;
                stack.push_back(static_cast<int>(i));
            }
        while (!stack.empty()) {
            const auto node = static_cast<size_t>(stack.back());
            stack.pop_back();
            const bool is_free = result[node] == Ancestry::free && !is_listed[node];
            for (const int child : document_.model.nodes[node].children) {
                result[static_cast<size_t>(child)] =
                    is_free ? Ancestry::free : Ancestry::below_listed;
                stack.push_back(child);
            }
        }
        return result;
    }

    Matrix4 local(int index, double time) const {
        const tinygltf::Node& node = document_.model.nodes[static_cast<size_t>(index)];
        const std::string place = element("nodes", static_cast<size_t>(index));
        if (!node.matrix.empty()) {
            std::array<double, 16> columns{};
            copy_checked(document_, node.matrix, columns, place + ".matrix");
            Matrix4 m;
            for (size_t i = 0; i < 16; ++i) m.m[i % 4][i / 4] = columns[i];
            m.m[3] = {0, 0, 0, 1};  // the last row, by the specification, whatever the file says
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
        const auto [t0, t1] = shutter_;
        const Matrix4 start = pending.start * local(pending.node, t0);
        const bool rests = !animations_.moves(pending.node) && pending.start == pending.end;
        const Matrix4 end = rests ? start : pending.end * local(pending.node, t1);
        const auto index = static_cast<size_t>(pending.node);
        placed_.worlds[index] = {start, end};
        bool is_hidden = pending.is_hidden || !is_visible(document_.model.nodes[index]);
        if (!is_hidden) {
            is_hidden = !Transform::from_matrix(start) || !Transform::from_matrix(end);
            if (is_hidden)
                log_.add(document_.place(element("nodes", index)),
                         "a scale of zero hides the node and what is below it");
            else
                place_copies(pending.node, {start, end}, {t0, t1});
        }
        const auto& children = document_.model.nodes[index].children;
        for (auto it = children.rbegin(); it != children.rend(); ++it)
            stack.push_back({*it, start, end, is_hidden});
    }

    /// Places a node once for each copy of its mesh; those without a size are left out.
    void place_copies(int node, const WorldMatrices& world, const std::array<float, 2>& times) {
        for (const Matrix4& copy : instance_matrices(document_, static_cast<size_t>(node))) {
            const auto start = Transform::from_matrix(world[0] * copy),
                       end = Transform::from_matrix(world[1] * copy);
            if (start && end)
                placed_.nodes.push_back(
                    {node, world[0] == world[1]
                               ? AnimatedTransform(*start)
                               : AnimatedTransform(*start, times[0], *end, times[1])});
        }
    }

    const Document& document_;
    const Animations& animations_;
    WarningLog& log_;
    const std::array<float, 2> shutter_;  ///< seconds
    const int scene_;                     ///< index, or -1 for all roots
    std::vector<int> parents_;
    PlacedNodes placed_;
};

}  // namespace

std::vector<double> morph_weights(const Document& document, const Animations& animations, int node,
                                  double time) {
    const tinygltf::Node& n = document.model.nodes[static_cast<size_t>(node)];
    if (n.mesh < 0) return {};
    const std::string place = element("nodes", static_cast<size_t>(node));
    std::vector<double> values = animations.weights(node, time);
    if (values.empty()) values = n.weights;
    if (values.empty())
        values = at(document, document.model.meshes, n.mesh, "meshes", place + ".mesh").weights;
    // Weights are counted in the budget, as any number of nodes may have those of one mesh.
    if (!document.numbers.spend(values.size(), 1))
        throw Error(ErrorKind::limit, document.place(place),
                    "its weights and all numbers before are too many for a file of " +
                        std::to_string(document.bytes) + " bytes");
    for (const double v : values)
        if (!(std::abs(v) < 1e30))
            document.refuse(place, "expected finite weights of its mesh's morph targets");
    return values;
}

PlacedNodes place_nodes(const Document& document, int scene, const Animations& animations,
                        const std::array<float, 2>& shutter, WarningLog& log) {
    return Placer(document, scene, animations, shutter, log).place();
}

}  // namespace covtrace::gltf
