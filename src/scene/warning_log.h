/// Collects the reader's warnings: in file order, the same text once with the number of places.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "core/error.h"

namespace covtrace {

class WarningLog {
  public:
    /// Sets the directive that the next warnings belong to: those of entities that are built late
    /// (materials, textures) are sorted to where they were declared.
    void set_order(int directive) { directive_ = directive; }
    void add(const SourceLocation& where, std::string text);
    /// All warnings, sorted by directive; a text that occurred several times names its first place.
    Warnings take();

  private:
    struct Entry {
        int directive = 0;
        int count = 1;
        Warning warning;
    };
    int directive_ = 0;
    std::vector<Entry> entries_;
    std::unordered_map<std::string, size_t> by_text_;
};

}  // namespace covtrace
