#include "render/merge.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "render/film_arrays.h"

namespace covtrace {

namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& why) {
    throw Error(ErrorKind::usage, name + ": " + why);
}

/// The round and budget of a film, as far as films that are joined must agree on them.
auto round_of(const RenderState& s) {
    return std::tuple(s.stage, s.taken, s.target, s.covariance_spp, s.weight_limit, s.spp,
                      s.complete, s.in_round());
}

/// Whether two films store the same arrays over the same region, whatever their records hold.
bool same_arrays(RenderState& a, RenderState& b) {
    const std::vector<FilmArray> of_a = film_arrays(a), of_b = film_arrays(b);
    return a.region == b.region && std::equal(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(),
                                              [](const FilmArray& x, const FilmArray& y) {
                                                  return x.name == y.name &&
                                                         x.record_size == y.record_size &&
                                                         x.count == y.count;
                                              });
}

/// Copies into `to` the records of the pixels whose shards `from` has.
void copy_pixels(RenderState& to, RenderState& from) {
    const std::vector<FilmArray> target = film_arrays(to), source = film_arrays(from);
    const Tiles tiles(to.region);
    const size_t width = size_t(to.region.width());
    for (int64_t tile = 0; tile < tiles.count(); ++tile) {
        const int owner = tiles.owner(tile, from.shards);
        if (!std::binary_search(from.present.begin(), from.present.end(), owner)) continue;
        const PixelBounds b = tiles.bounds(tile);
        for (int y = b.y0; y < b.y1; ++y) {
            const size_t first = size_t(y - to.region.y0) * width + size_t(b.x0 - to.region.x0);
            for (size_t a = 0; a < target.size(); ++a) {
                const size_t size = target[a].record_size;
                const char* row = static_cast<const char*>(source[a].records) + first * size;
                std::copy_n(row, size_t(b.width()) * size,
                            static_cast<char*>(target[a].records) + first * size);
            }
        }
    }
}

/// Whether a sample comes before another one in the image.
bool before(const RejectedSample& a, const RejectedSample& b) {
    return std::tuple(a.y, a.x, a.sample) < std::tuple(b.y, b.x, b.sample);
}

}  // namespace

void FilmMerge::add(const std::string& name, RenderState film) {
    std::sort(film.present.begin(), film.present.end());
    if (!sum_) {
        first_name_ = name;
        sum_ = std::move(film);
        return;
    }
    RenderState& sum = *sum_;
    if (const auto other = difference(film.identity, sum.identity))
        refuse(name, "is of another render than '" + first_name_ + "': " + *other);
    if (film.shards != sum.shards)
        refuse(name, "is one of " + std::to_string(film.shards) + " shards, '" + first_name_ +
                         "' one of " + std::to_string(sum.shards));
    if (film.shards == 1) refuse(name, "overlaps '" + first_name_ + "': both hold all pixels");
    for (int k : film.present)
        if (std::binary_search(sum.present.begin(), sum.present.end(), k))
            refuse(name, "overlaps the films before it: shard " + std::to_string(k + 1) + "/" +
                             std::to_string(film.shards) + " is there already");
    if (round_of(film) != round_of(sum))
        refuse(name, "is of another round or budget than '" + first_name_ +
                         "'; expected shards that began with the same film and --spp");
    if (!same_arrays(film, sum))
        refuse(name, "has other pixels or other arrays than '" + first_name_ + "'");
    copy_pixels(sum, film);
    sum.rejected += film.rejected;
    sum.first_rejected.insert(sum.first_rejected.end(), film.first_rejected.begin(),
                              film.first_rejected.end());
    std::sort(sum.first_rejected.begin(), sum.first_rejected.end(), before);
    if (sum.first_rejected.size() > PassStatistics::kMostRejectedKept)
        sum.first_rejected.resize(PassStatistics::kMostRejectedKept);
    // Times of the first shard stand for all: sums of floating-point numbers would depend on the
    // order in which films are added.
    if (film.present.front() < sum.present.front()) {
        sum.seconds = film.seconds;
        sum.seconds_spp = film.seconds_spp;
    }
    sum.present.insert(sum.present.end(), film.present.begin(), film.present.end());
    std::sort(sum.present.begin(), sum.present.end());
}

RenderState FilmMerge::result() && {
    RenderState sum = std::move(*sum_);
    if (sum.shards == 1 || int(sum.present.size()) < sum.shards) return sum;
    sum.shards = 1;
    sum.present.clear();
    if (sum.in_round() && sum.reached({})) {
        finish_round(sum);
        sum.complete = sum.stage == Stage::rounds && sum.spp && sum.taken >= *sum.spp;
    }
    return sum;
}

std::string missing_part(const RenderState& state) {
    const auto missing = state.shards - int(state.present.size());
    if (state.shards == 1) return "its render has not come to its end";
    if (missing == 0) return "its shards have not come to the end of their round";
    return std::to_string(missing) + " of its " + std::to_string(state.shards) + " shards " +
           (missing == 1 ? "is" : "are") + " missing, and black";
}

}  // namespace covtrace
