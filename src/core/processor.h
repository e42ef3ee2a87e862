/// Whether the processor has the instructions that this build was compiled for. Usable before
/// anything else has run: the file behind it is compiled for any x86-64 and calls no inline
/// function.
#pragma once

namespace covtrace {

/// Null where it has them, else a sentence for the user.
const char* missing_instructions();

}  // namespace covtrace
