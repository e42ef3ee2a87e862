// Film files, and states that headers describe: whatever they hold, the reader throws
// covtrace::Error, or all that the program does with a film works. libFuzzer's build does not look
// at the checksums of films.
#include <algorithm>
#include <cstdint>
#include <sstream>
#include <string>
#include <utility>

#include "core/error.h"
#include "render/describe_state.h"
#include "render/develop.h"
#include "render/film_arrays.h"
#include "render/film_file.h"
#include "render/film_header.h"
#include "render/merge.h"

namespace {

constexpr size_t kMostBytes = size_t{1} << 18;  // of a film, so that making its image is quick

void use(covtrace::RenderState state) {
    describe(state);
    develop(state);
    covtrace::FilmMerge merge;
    merge.add("a", state);
    try {
        merge.add("b", state);
    } catch (const covtrace::Error&) {  // the shards overlap
    }
    describe(std::move(merge).result());
}

/// Uses a header, up to the first zero byte, with the content of all arrays after it.
void use_described(const std::string& bytes) {
    const size_t end = std::min(bytes.find('\0'), bytes.size());
    covtrace::RenderState state = covtrace::parse_film_header(bytes.substr(0, end), kMostBytes);
    const std::string content = end < bytes.size() ? bytes.substr(end) : std::string(1, '\0');
    size_t next = 0;
    for (const covtrace::FilmArray& array : film_arrays(state))
        for (size_t i = 0; i < array.count * array.record_size; ++i)
            static_cast<char*>(array.records)[i] = content[next++ % content.size()];
    use(std::move(state));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const std::string bytes(reinterpret_cast<const char*>(data), size);
    try {
        std::istringstream in(bytes);
        covtrace::RenderState state = covtrace::read_film(in, size, "fuzz.film");
        size_t held = 0;
        for (const auto& [name, count] : state.memory()) held += count;
        if (held <= kMostBytes) use(std::move(state));
    } catch (const covtrace::Error&) {
    }
    try {
        use_described(bytes);
    } catch (const covtrace::Error&) {
    }
    return 0;
}
