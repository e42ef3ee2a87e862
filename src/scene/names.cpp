#include "scene/names.h"

#include <algorithm>
#include <cctype>
#include <numeric>

namespace covtrace {

namespace {

std::string lower(std::string_view s) {
    std::string r(s);
    for (char& c : r) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return r;
}

/// Levenshtein's edit distance between two names.
size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), size_t{0});
    for (size_t i = 1; i <= a.size(); ++i) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= b.size(); ++j) {
            const size_t above = row[j];
            row[j] = std::min({row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] != b[j - 1])});
            diagonal = above;
        }
    }
    return row.back();
}

}  // namespace

std::string in_quotes(std::string_view text, size_t longest) {
    std::string r = "\"";
    for (const char c : text.substr(0, longest)) {
        const auto byte = static_cast<unsigned char>(c);
        r += byte < 0x20 || byte == 0x7f ? '?' : c;
    }
    return r + (text.size() > longest ? "…\"" : "\"");
}

std::string path_in_quotes(const std::string& path) {
    return in_quotes(path, path.size());
}

std::string listed(const std::vector<std::string>& names) {
    constexpr size_t most = 14;
    std::string r;
    for (size_t i = 0; i < std::min(names.size(), most); ++i) r += (i ? ", " : "") + names[i];
    return names.size() > most ? r + ", …" : r;
}

std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates) {
    if (name.size() > kLongestExcerpt) return {};
    const std::string wanted = lower(name);
    // Beginnings of three letters and more, such as "--env", are nearer than words of their length
    const bool is_beginning = std::ranges::count_if(wanted, [](char c) { return c != '-'; }) >= 3;
    std::vector<std::pair<size_t, const std::string*>> near;
    for (const std::string& c : candidates) {
        if (is_beginning && lower(c).starts_with(wanted)) {
            near.emplace_back(0, &c);
            continue;
        }
        if (c.size() > name.size() + 3 || name.size() > c.size() + 3) continue;
        const size_t d = edit_distance(wanted, lower(c));
        if (d <= std::max<size_t>(1, (wanted.size() + 2) / 3)) near.emplace_back(d, &c);
    }
    if (near.empty()) return {};
    std::stable_sort(near.begin(), near.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::string r = "; did you mean " + in_quotes(*near[0].second);
    if (near.size() > 1) r += " or " + in_quotes(*near[1].second);
    return r + "?";
}

std::string unknown_name(std::string_view what, std::string_view name,
                         const std::vector<std::string>& known) {
    std::string text = "unknown " + std::string(what) + " " + in_quotes(name);
    if (known.empty()) return text + "; none is defined";
    return text + "; expected one of " + listed(known) + did_you_mean(name, known);
}

}  // namespace covtrace
