#include "pbrt/mesh_files.h"

#include <exception>

#include "core/parallel.h"

namespace covtrace {

size_t MeshFiles::add(const std::filesystem::path& file, const SourceLocation& where,
                      int directive) {
    const auto [it, is_new] = numbers_.try_emplace(file, entries_.size());
    if (is_new) entries_.push_back({file, where, directive, {}});
    return it->second;
}

void MeshFiles::read_all(SceneFiles& files, WarningLog& log) {
    struct Outcome {
        uint64_t hash = 0;
        WarningLog log;
        std::exception_ptr failure;
    };
    std::vector<Outcome> outcomes(entries_.size());
    parallel_for(static_cast<int64_t>(entries_.size()), [&](int64_t i) {
        Entry& entry = entries_[static_cast<size_t>(i)];
        Outcome& outcome = outcomes[static_cast<size_t>(i)];
        try {
            const std::string bytes = read_whole_file(entry.file, entry.where);
            outcome.hash = hash_of(bytes);
            entry.mesh = read_ply(bytes, entry.file.string(), outcome.log);
        } catch (...) {
            outcome.failure = std::current_exception();
        }
    });
    for (size_t i = 0; i < entries_.size(); ++i) {
        if (outcomes[i].failure) std::rethrow_exception(outcomes[i].failure);
        files.add_to_hash(outcomes[i].hash);
        log.set_order(entries_[i].directive);
        for (Warning& w : outcomes[i].log.take()) log.add(w.where, std::move(w.text));
    }
}

}  // namespace covtrace
