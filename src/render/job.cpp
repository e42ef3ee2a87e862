#include "render/job.h"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <utility>

#include "render/hybrid_film.h"
#include "render/image_hash.h"
#include "render/ranks.h"
#include "scene/imaging_scale.h"

namespace covtrace {

PassContext pass_context(const RenderScene& scene, const RenderOptions& options) {
    const SceneDescription& d = scene.description;
    return {scene,
            options.seed,
            d.max_depth,
            imaging_scale(d),
            d.film.max_component_value,
            d.film.sensor,
            d.film.sensor_values,
            kept_surfaces(d.film, options),
            {}};
}

PassContext half_context(const PassContext& whole, uint32_t k) {
    PassContext half = whole;
    half.seed = hybrid_seed(whole.seed);
    half.half = k;
    half.halves = 2;
    return half;
}

namespace {

/// Hash of all that must be the same in all processes of a render before they share pixels.
double start_of(const RenderState& s) {
    std::ostringstream out;
    out << std::setprecision(17) << int(s.stage) << ' ' << s.taken << ' ' << s.target << ' '
        << s.in_round() << ' ' << s.mean_count() << ' ' << s.shards;
    for (const auto& [name, value] : s.identity) out << '\n' << name << ": " << value;
    const std::string text = out.str();
    return double(XXH3_64bits(text.data(), text.size()) >> 11);  // as many bits as a double holds
}

void require_same_start(const Ranks& ranks, const RenderState& s) {
    const double own = start_of(s);
    if (ranks.any(ranks.of_first(own) != own))
        throw Error(ErrorKind::usage,
                    "the processes of mpirun don't begin with the same: expected on all machines "
                    "the same program, scene and kind of processor (--isa), and a --checkpoint in "
                    "a folder that all of them see");
}

RenderState initial_state(const RenderScene& scene, const RenderOptions& options,
                          const FilmKeeping& keeping) {
    RenderState fresh(scene, options);
    // Images are read and hashed only where a film is kept, or goes on: for others the time would
    // be lost.
    const bool kept = keeping.from || keeping.keep;
    if (keeping.ranks ? keeping.ranks->any(kept) : kept)
        fresh.identity["images"] = image_hash(scene.description);
    if (!keeping.from) return fresh;
    if (const auto other = difference(keeping.from->identity, fresh.identity))
        throw Error(ErrorKind::usage, "cannot go on from '" + keeping.name +
                                          "', the film of another render: " + *other);
    if (keeping.from->shards > 1)
        throw Error(ErrorKind::usage,
                    "cannot go on from '" + keeping.name +
                        "', which holds the pixels of some shards only; expected a film that "
                        "'covtrace merge' made of all of them");
    RenderState state = *keeping.from;
    state.spp = fresh.spp;
    state.complete = false;
    return state;
}

}  // namespace

RenderJob::RenderJob(const RenderScene& render_scene, const RenderOptions& render_options,
                     Monitor& render_monitor, FilmKeeping film_keeping)
    : scene(render_scene),
      options(render_options),
      monitor(render_monitor),
      keeping(std::move(film_keeping)),
      state(initial_state(render_scene, render_options, keeping)),
      region(state.region),
      context(pass_context(scene, options)),
      target_spp(covtrace::target_spp(scene.description, options)) {
    context.shard = tiles();
    if (target_spp && std::llround(*target_spp * double(pixels())) < 1) {
        std::ostringstream what;
        what << *target_spp << " samples per pixel are not one sample in all of " << pixels()
             << " pixels; expected at least one";
        throw Error(ErrorKind::usage, what.str());
    }
    if (keeping.ranks) require_same_start(*keeping.ranks, state);
}

Shard RenderJob::tiles() const {
    return keeping.ranks ? Shard{keeping.ranks->index(), keeping.ranks->count()} : keeping.shard;
}

bool RenderJob::delivers() const {
    return keeping.shard.is_all() && (!keeping.ranks || keeping.ranks->index() == 0);
}

PassProgress RenderJob::reporter(Phase phase, double from, double to) {
    const double begin = fraction(from), end = fraction(to);
    return [this, phase, from, to, begin, end](double f) {
        monitor.update(phase, begin + f * (end - begin), from + f * (to - from));
    };
}

double RenderJob::fraction(double spp) const {
    double f = 0;
    if (target_spp) f = spp / *target_spp;
    if (options.seconds) f = std::max(f, monitor.elapsed() / *options.seconds);
    if (enough) f = std::max(f, spp / *enough);
    return std::clamp(f, 0.0, 1.0) * kTracingShare;
}

double RenderJob::plan_round(double round_end) const {
    double target = round_end;
    if (target_spp) target = std::min(target, *target_spp);
    if (options.seconds && state.seconds_spp > 0) {
        const double left = tracing_end() - monitor.elapsed();
        const double affordable =
            state.taken + std::floor(left / (state.seconds / state.seconds_spp) * 16) / 16;
        target = std::min(target, affordable);
    }
    target = std::max(target, state.taken);
    return keeping.ranks ? keeping.ranks->of_first(target) : target;
}

double RenderJob::tracing_end() const {
    return options.seconds ? *options.seconds - reserve_ - keeping_seconds() : kInfinity;
}

double RenderJob::latest_end() const {
    if (!options.seconds) return kInfinity;
    const double slack = std::max(0.2, 0.04 * *options.seconds);
    return (state.stage == Stage::rounds ? tracing_end() : *options.seconds) + slack;
}

double RenderJob::keeping_seconds() const {
    constexpr double kBytesPerSecond = 1.5e8;
    if (!keeping.keep) return 0;
    double bytes = 0;
    for (const auto& [name, count] : state.memory()) bytes += double(count);
    return bytes / kBytesPerSecond;
}

double RenderJob::most_samples(double target) const {
    if (options.max_spp) return *options.max_spp;
    return options.density_factor ? kInfinity : std::ceil(16 * target);
}

bool RenderJob::begin_round(double target, std::vector<std::vector<uint32_t>> plan) {
    bool more = false;
    for (size_t k = 0; k < plan.size(); ++k)
        for (size_t i = 0; i < plan[k].size() && !more; ++i)
            more = plan[k][i] > state.films[k].pixels[i].count;
    if (!more) return false;
    state.target = target;
    state.plan = std::move(plan);
    return true;
}

std::vector<uint32_t> RenderJob::even_counts(double spp) const {
    const int64_t total = std::llround(spp * double(pixels()));
    std::vector<uint32_t> counts(state.pixels());
    // Remainder carried from pixel to pixel, in units of 1/pixels() of a sample.
    int64_t carried = pixels() / 2;
    for (uint32_t& count : counts) {
        carried += total;
        count = uint32_t(carried / pixels());
        carried %= pixels();
    }
    return counts;
}

void RenderJob::counted(PassStatistics& sum, const PassStatistics& pass) {
    sum.add(pass);
    state.rejected += pass.rejected;
    for (const RejectedSample& r : pass.first_rejected)
        if (state.first_rejected.size() < PassStatistics::kMostRejectedKept)
            state.first_rejected.push_back(r);
}

void RenderJob::note_memory() {
    size_t sum = 0;
    const auto bytes = state.memory();
    for (const auto& [name, count] : bytes) sum += count;
    if (sum < most_memory_) return;
    most_memory_ = sum;
    for (const auto& [name, count] : bytes) result.statistics.memory[name] = count;
}

}  // namespace covtrace
