/// MPI for a program that mpirun started.
#pragma once

#include <memory>

#include "render/ranks.h"

namespace covtrace::cli {

/// Joins the processes that mpirun started beside this one; null where it did not start any. MPI is
/// in a module of its own, so that nothing else needs it. Throws Error(usage) where the module is
/// missing or does not load; the message says why.
std::unique_ptr<Ranks> join_ranks();

}  // namespace covtrace::cli
