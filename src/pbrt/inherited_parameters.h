/// The parameters that `Attribute` directives give to all later directives of a kind.
#pragma once

#include <initializer_list>
#include <memory>
#include <string_view>
#include <vector>

#include "pbrt/parameter.h"

namespace covtrace {

/// A copy costs as much as a pointer, whatever it holds: every shape keeps the parameters that were
/// in force where it stands, and every block those that it began with. Copies share a tree whose
/// branches are the bits of the names' hashes, so that no order of names makes it deep; `add` makes
/// only the nodes on its way anew.
class InheritedParameters {
  public:
    void add(Parameter parameter);

    /// The latest of that name; null where there is none.
    const Parameter* find(std::string_view name) const;
    /// The latest of that name that has one of these types.
    const Parameter* find(std::string_view name, std::initializer_list<ParameterType> types) const;

  private:
    struct Node;
    using Tree = std::shared_ptr<const Node>;
    using Latest = std::vector<std::shared_ptr<const Parameter>>;
    /// `hash`: the bits that have not led here.
    static Tree with(const Tree& tree, size_t hash, std::shared_ptr<const Parameter> added);
    /// Parameters of that name, of every type, the latest last; null where there is none.
    const Latest* latest(std::string_view name) const;

    Tree tree_;
};

}  // namespace covtrace
