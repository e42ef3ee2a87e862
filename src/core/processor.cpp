#include "core/processor.h"

namespace covtrace {

const char* missing_instructions() {
#ifdef COVTRACE_NEEDS_X86_64_V3
    __builtin_cpu_init();
    // The rest of x86-64-v3 (MOVBE, LZCNT, F16C) came with the first of every maker's processors
    // that have these four, and clang 14 has no names for it.
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma") ||
        !__builtin_cpu_supports("bmi") || !__builtin_cpu_supports("bmi2"))
        return "this build needs a processor with AVX2, FMA and BMI2 (x86-64-v3), which this one "
               "is not; for any x86-64 build it from source: PRESET=portable scripts/build";
#endif
    return nullptr;
}

}  // namespace covtrace
