#include "scene/warning_log.h"

#include <algorithm>

namespace covtrace {

void WarningLog::add(const SourceLocation& where, std::string text) {
    const auto [it, is_new] = by_text_.try_emplace(text, entries_.size());
    if (is_new) {
        entries_.push_back({directive_, 1, {where, std::move(text)}});
        return;
    }
    Entry& known = entries_[it->second];
    ++known.count;
    if (directive_ < known.directive) {
        known.directive = directive_;
        known.warning.where = where;
    }
}

Warnings WarningLog::take() {
    std::stable_sort(entries_.begin(), entries_.end(),
                     [](const Entry& a, const Entry& b) { return a.directive < b.directive; });
    Warnings all;
    for (Entry& e : entries_) {
        if (e.count > 1) {
            e.warning.text += " (and in " + std::to_string(e.count - 1) + " more place";
            e.warning.text += e.count > 2 ? "s)" : ")";
        }
        all.push_back(std::move(e.warning));
    }
    entries_.clear();
    by_text_.clear();
    return all;
}

}  // namespace covtrace
