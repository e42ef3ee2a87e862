#include "pbrt/inherited_parameters.h"

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

namespace covtrace {

struct InheritedParameters::Node {
    Latest latest;
    std::array<Tree, 2> below;

    const std::string& name() const { return latest.back()->name; }
};

InheritedParameters::Tree InheritedParameters::with(const Tree& tree, size_t hash,
                                                    std::shared_ptr<const Parameter> added) {
    if (!tree) return std::make_shared<const Node>(Node{{std::move(added)}, {}});
    Node node = *tree;
    if (node.name() == added->name) {
        std::erase_if(node.latest, [&](const auto& p) { return p->type == added->type; });
        node.latest.push_back(std::move(added));
    } else {
        Tree& below = node.below[hash % 2];
        below = with(below, hash / 2, std::move(added));
    }
    return std::make_shared<const Node>(std::move(node));
}

void InheritedParameters::add(Parameter parameter) {
    const size_t hash = std::hash<std::string_view>()(parameter.name);
    tree_ = with(tree_, hash, std::make_shared<const Parameter>(std::move(parameter)));
}

const InheritedParameters::Latest* InheritedParameters::latest(std::string_view name) const {
    if (!tree_) return nullptr;
    size_t hash = std::hash<std::string_view>()(name);
    const Node* node = tree_.get();
    for (; node && node->name() != name; hash /= 2) node = node->below[hash % 2].get();
    return node ? &node->latest : nullptr;
}

const Parameter* InheritedParameters::find(std::string_view name) const {
    const Latest* all = latest(name);
    return all ? all->back().get() : nullptr;
}

const Parameter* InheritedParameters::find(std::string_view name,
                                           std::initializer_list<ParameterType> types) const {
    const Latest* all = latest(name);
    if (!all) return nullptr;
    const auto fits = [&](const auto& p) {
        return std::find(types.begin(), types.end(), p->type) != types.end();
    };
    const auto found = std::find_if(all->rbegin(), all->rend(), fits);
    return found == all->rend() ? nullptr : found->get();
}

}  // namespace covtrace
