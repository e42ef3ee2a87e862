/// Scale from light to the film's values.
#pragma once

#include "scene/scene_description.h"

namespace covtrace {

/// The film's value for a radiance of 1: exposure time times iso / 100, as in pbrt.
inline float imaging_scale(const SceneDescription& scene) {
    const CameraDescription& camera = scene.camera;
    return (camera.shutter_close - camera.shutter_open) * scene.film.iso / 100 *
           camera.film_irradiance;
}

}  // namespace covtrace
