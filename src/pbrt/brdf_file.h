/// Files of measured BRDFs (".bsdf" of the RGL material database).
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "core/error.h"
#include "scene/brdf_tensor.h"

namespace covtrace {

/// Reads a tensor file with the fields of Dupuy and Jakob's parameterization; its spectra become
/// colours under D65. Throws Error(scene) at `where` for files that are damaged, have other fields,
/// or hold a part of all azimuths only, which pbrt-v4 refuses, too.
std::shared_ptr<const BrdfTensor> read_brdf(std::string_view bytes,
                                            const std::filesystem::path& file,
                                            const SourceLocation& where);

}  // namespace covtrace
