/// The instruction sets that Embree can be told to keep to.
#pragma once

#include <optional>
#include <string>

#include "core/enum_names.h"

namespace covtrace {

enum class InstructionSet { sse2, avx, avx2, avx512 };

template <>
inline constexpr auto kEnumNames<InstructionSet> =
    enum_names<InstructionSet>({{InstructionSet::sse2, "sse2"},
                                {InstructionSet::avx, "avx"},
                                {InstructionSet::avx2, "avx2"},
                                {InstructionSet::avx512, "avx512"}});

/// As Geometry wants it: empty where Embree may choose.
inline std::string isa_name(std::optional<InstructionSet> set) {
    return set ? std::string(name_of(*set)) : std::string();
}

}  // namespace covtrace
