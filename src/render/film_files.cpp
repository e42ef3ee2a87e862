#include "render/film_files.h"

#include <utility>

#include "render/film_file.h"

namespace covtrace {

namespace {

/// Seconds between checkpoints, and the largest share of a render's time that writing them takes;
/// both unless the choice has `every`.
constexpr double kEvery = 60, kMostShare = 0.01;
/// Size beyond which writing a film may take more than a second: an interrupt is answered first.
constexpr size_t kSlowBytes = size_t(100) << 20;

}  // namespace

FilmFiles::FilmFiles(const FilmChoice& choice, std::function<void(const std::string&)> tell)
    : choice_(choice), tell_(std::move(tell)) {}

std::shared_ptr<const RenderState> FilmFiles::found(const std::filesystem::path& file,
                                                    bool writes) const {
    FoundFilm film = find_film(file);
    if (!film.state) return nullptr;
    std::error_code ignored;
    if (!film.damage.empty() && writes && std::filesystem::exists(file, ignored))
        film.damage += "; it is now '" + set_aside(file).string() + "'";
    if (!film.damage.empty())
        tell_(film.damage + "; going on from '" + earlier_film(file).string() + "'");
    return std::make_shared<const RenderState>(std::move(*film.state));
}

FilmKeeping FilmFiles::keeping(bool writes) {
    FilmKeeping k;
    const auto& a = choice_;
    if (a.shard) k.shard = *a.shard;
    // The checkpoint that shards begin with is written by the process that joins them.
    const bool writes_checkpoint = writes && !a.shard;
    if (writes && !a.film.empty()) remove_leftovers(a.film);
    if (writes_checkpoint && !a.checkpoint.empty()) remove_leftovers(a.checkpoint);
    if (a.resume && !a.checkpoint.empty()) k.from = found(a.checkpoint, writes_checkpoint);
    if (a.resume && a.shard) k.part = found(a.film, writes);
    if (k.from) k.name = a.checkpoint;
    if (a.film.empty() && a.checkpoint.empty()) return k;
    if (writes)
        k.keep = [this](const RenderState& state, KeepReason reason) { keep(state, reason); };
    if (a.shard || !a.checkpoint.empty()) {
        k.interval = a.every.value_or(kEvery);
        if (!a.every) k.most_share = kMostShare;
    }
    return k;
}

void FilmFiles::keep(const RenderState& state, KeepReason reason) {
    const auto& a = choice_;
    failure_.reset();
    size_t bytes = 0;
    for (const auto& [name, count] : state.memory()) bytes += count;
    if (reason == KeepReason::interrupted && bytes > kSlowBytes)
        tell_("keeping a film of " + std::to_string(bytes >> 20) + " MB, which takes a while");
    // A shard has one file, --film, which it writes at every occasion. Other renders write it when
    // they end or are interrupted; where it has the checkpoint's name, that is written below.
    if (a.shard || (reason != KeepReason::checkpoint && a.film != a.checkpoint))
        write(state, a.film);
    if (!a.shard) write(state, a.checkpoint);
}

void FilmFiles::write(const RenderState& state, const std::filesystem::path& file) {
    if (file.empty()) return;
    try {
        write_film(state, file);
        failing_.erase(file);
    } catch (const Error& e) {
        failure_ = e;
        if (!failing_.insert(file).second) return;
        tell_(e.what());
    }
}

void FilmFiles::finish() const {
    if (failure_) throw *failure_;
}

}  // namespace covtrace
