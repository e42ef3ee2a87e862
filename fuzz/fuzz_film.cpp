// Film files: a render's state, of which everything can be told, or covtrace::Error. libFuzzer's
// build does not look at the checksums, which it would hardly ever meet.
#include "fuzz/input_file.h"
#include "render/film_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const covtrace::InputFile file(".film");
    try {
        covtrace::describe(covtrace::read_film(file.write(data, size)));
    } catch (const covtrace::Error&) {
    }
    return 0;
}
