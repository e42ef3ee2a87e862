/// The processes of a program that mpirun started, found by a module that alone needs MPI.
#pragma once

#include <memory>

#include "render/ranks.h"

namespace covtrace::cli {

/// Joins the processes that Open MPI's mpirun started beside this one. Null where there is no other
/// process, and under launchers of other MPI libraries, which are not recognised. MPI is in a
/// module of its own, so that the program runs without it. Throws Error(usage) where the module is
/// missing or does not load; the message says why.
std::unique_ptr<Ranks> join_ranks();

}  // namespace covtrace::cli
