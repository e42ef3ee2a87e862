/// Grids of NanoVDB's files (.nvdb), by its own library.
#pragma once

#include <memory>
#include <string>

#include "core/error.h"
#include "core/transform.h"
#include "volume/density_grid.h"

namespace covtrace {

/// The grid of that name in a file's bytes; null where it has none. `file_from_world` takes points
/// to the space that the file calls the world. Values are of single precision or quantised; those
/// below 0 count as 0. Errors: Error(scene) at `where` for bytes that are no such file, are damaged
/// or compressed in a way that is not supported, and for grids of other values; Error(limit) where
/// the process may not hold them.
std::shared_ptr<const DensityGrid> read_nanovdb(const std::string& bytes, const std::string& name,
                                                const Transform& file_from_world,
                                                const SourceLocation& where);

}  // namespace covtrace
