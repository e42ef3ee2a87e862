/// Films and layers of a render, as the keywords of Python name them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "image/layer_selection.h"
#include "options.h"
#include "render/film_files.h"

namespace covtrace::python {

/// The keywords film, checkpoint, every, resume and shard.
FilmChoice film_choice(const py::dict& o);

/// The keyword layers; empty: every layer that is made.
std::optional<LayerSelection> layer_selection(const py::dict& o);

/// Drops the layers that are not selected. Adds a warning for each named one that there is not.
void select_layers(Image& image, const std::optional<LayerSelection>& selection,
                   Warnings& warnings);

}  // namespace covtrace::python
