#include "cli/film_options.h"

#include "cli/options.h"
#include "cli/same_file.h"
#include "cli/values.h"
#include "core/error.h"

namespace covtrace::cli {

void add_film_options(CLI::App* c, FilmChoice& a) {
    c->add_option("--film", a.film, "keep the final film, for merge and --resume")
        ->check(not_empty())
        ->option_text("FILE");
    c->add_option("--checkpoint", a.checkpoint, "keep the film now and then, and at the end")
        ->check(not_empty())
        ->option_text("FILE");
    c->add_option_function<std::string>(
         "--every", [&a](const std::string& text) { a.every = parse_duration("--every", text); },
         "time between checkpoints (default 60s)")
        ->option_text("T");
    c->add_flag("--resume", a.resume, "go on from the checkpoint, if there is one");
    c->add_option_function<std::string>(
         "--shard", [&a](const std::string& text) { a.shard = parse_shard("--shard", text); },
         "trace every N-th tile into --film, for merge")
        ->option_text("K/N");
}

void check(FilmChoice& a) {
    if (!a.shard && is_same_file(a.film, a.checkpoint)) a.film = a.checkpoint;
    if (a.shard && a.film.empty())
        throw Error(ErrorKind::usage, "--shard: expected --film FILE for the shard's pixels");
    if (a.shard && is_same_file(a.film, a.checkpoint))
        throw Error(
            ErrorKind::usage,
            "--shard: --film and --checkpoint must differ: the checkpoint is the merged film "
            "that all shards begin with");
    const bool keeps = !a.checkpoint.empty() || a.shard;
    if (a.resume && !keeps)
        throw Error(ErrorKind::usage, "--resume: expected --checkpoint FILE to go on from");
    if (a.every && !keeps) throw Error(ErrorKind::usage, "--every: expected --checkpoint FILE");
}

}  // namespace covtrace::cli
