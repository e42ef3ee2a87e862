#include "options.h"

#include <dlfcn.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <filesystem>
#include <system_error>

namespace covtrace::python {

RenderOptions render_options(const py::dict& o) {
    RenderOptions r;
    r.method = choice<Method>(o, "method");
    r.density = choice<DensityRule>(o, "density");
    r.occlusion = choice<Occlusion>(o, "occlusion");
    r.denoiser_quality = denoiser_quality(o);
    r.guides = choice<Guides>(o, "guides");
    r.brdf_covariance = choice<BrdfCovariance>(o, "brdf_covariance");
    r.texture_bandwidth = choice<TextureBandwidth>(o, "texture_bandwidth");
    r.filter = choice<FilterRule>(o, "filter");
    r.spp = positive<double>(o, "spp");
    r.seconds = positive<double>(o, "time");
    r.error = positive<double>(o, "error");
    r.cov_spp = positive<double>(o, "cov_spp");
    require(!r.cov_spp || *r.cov_spp <= 1 || *r.cov_spp == std::floor(*r.cov_spp),
            "cov_spp must be a whole number, or a part of one");
    r.density_factor = positive<double>(o, "k");
    r.max_spp = positive<int>(o, "max_spp");
    r.voxels = value_of<int>(o, "voxels", "a whole number");
    require(r.voxels >= 1 && r.voxels <= 2048, "voxels must be from 1 to 2048");
    r.progressive = value_of<bool>(o, "progressive", "True or False");
    r.even_counts = value_of<bool>(o, "even_counts", "True or False");
    r.seed = value_of<uint64_t>(o, "seed", "a whole number from 0 to 2^64 - 1");
    return r;
}

std::optional<Preset> preset(const py::dict& o) {
    if (!is_given(o, "preset")) return std::nullopt;
    return choice<Preset>(o, "preset");
}

std::optional<DenoiserQuality> denoiser_quality(const py::dict& o) {
    if (!is_given(o, "denoiser_quality")) return std::nullopt;
    return choice<DenoiserQuality>(o, "denoiser_quality");
}

DenoiserSearch denoiser_search(const py::dict& o) {
    namespace fs = std::filesystem;
    DenoiserSearch search;
    if (is_given(o, "denoiser")) search.choice = choice<DenoiserChoice>(o, "denoiser");
    if (is_given(o, "denoiser_library"))
        search.library = value_of<fs::path>(o, "denoiser_library", "a file's path");
    Dl_info module{};
    std::error_code ignored;
    if (::dladdr(reinterpret_cast<const void*>(&denoiser_search), &module) && module.dli_fname) {
        const fs::path folder = fs::absolute(module.dli_fname, ignored).parent_path();
        // The folders are those beside the module, in the build folder, and where the program is
        // installed.
        search.folders = {folder / "denoiser", folder / "../../denoiser",
                          folder / "../../../denoiser", folder / "../../../covtrace/denoiser"};
    }
    return search;
}

std::array<float, 2> checked_shutter(const std::array<float, 2>& shutter) {
    require(std::isfinite(shutter[0]) && std::isfinite(shutter[1]) && shutter[0] < shutter[1],
            "shutter must be a begin and a later end, such as (0, 0.5)");
    return shutter;
}

namespace {

Vec3 finite_vector(const py::dict& camera, const char* name) {
    const auto v = value_of<std::array<float, 3>>(camera, name, "(x, y, z)");
    for (const float x : v) require(std::isfinite(x), "camera must hold finite numbers");
    return {v[0], v[1], v[2]};
}

CameraOverride camera_override(const py::dict& camera) {
    CameraOverride c;
    c.eye = finite_vector(camera, "eye");
    c.target = finite_vector(camera, "target");
    c.fov = value_of<float>(camera, "fov", "a number of degrees");
    require(c.fov >= CameraOverride::kLeastFov && c.fov < 180,
            "camera must have a fov above 0 and below 180 degrees");
    if (is_given(camera, "up")) c.up = finite_vector(camera, "up");
    return c;
}

/// A path, or a colour (r, g, b).
EnvironmentOverride environment_override(const py::dict& o) {
    if (py::isinstance<py::tuple>(o["environment"])) {
        const auto c = value_of<std::array<float, 3>>(o, "environment", "(r, g, b)");
        for (const float v : c)
            require(v >= 0 && std::isfinite(v), "environment must be a colour of at least 0");
        return {{}, {c[0], c[1], c[2]}};
    }
    const auto image = value_of<std::filesystem::path>(o, "environment", "an image's path");
    std::error_code ignored;
    require(std::filesystem::is_regular_file(image, ignored),
            "environment is '" + image.string() +
                "'; expected an image's file that is there, a number or (r, g, b)");
    return {image, Rgb(1)};
}

/// A place, or None for the camera's; radius, colour, power or None.
LampDescription lamp(const py::handle& given) {
    const auto parts = given.cast<std::tuple<std::optional<std::array<float, 3>>, float,
                                             std::array<float, 3>, std::optional<float>>>();
    const auto& [at, radius, colour, power] = parts;
    LampDescription lamp;
    if (at) lamp.at = Vec3{(*at)[0], (*at)[1], (*at)[2]};
    lamp.radius = radius;
    lamp.colour = {colour[0], colour[1], colour[2]};
    lamp.power = power;
    return lamp;
}

}  // namespace

SceneOverrides scene_overrides(const py::dict& o) {
    SceneOverrides s;
    if (is_given(o, "resolution")) {
        s.resolution = value_of<std::array<int, 2>>(o, "resolution", "(width, height)");
        require((*s.resolution)[0] > 0 && (*s.resolution)[1] > 0,
                "resolution must be (width, height), both at least 1");
    }
    if (is_given(o, "crop")) {
        const auto c = value_of<std::array<int, 4>>(o, "crop", "(x0, y0, x1, y1) in pixels");
        s.crop = PixelBounds{c[0], c[1], c[2], c[3]};
    }
    if (is_given(o, "shutter"))
        s.shutter = checked_shutter(value_of<std::array<float, 2>>(o, "shutter", "(begin, end)"));
    s.focal_distance = positive<float>(o, "focus", SceneOverrides::kLeastOfLens);
    s.f_number = positive<float>(o, "fstop", SceneOverrides::kLeastOfLens);
    if (is_given(o, "max_depth")) {
        s.max_depth = value_of<int>(o, "max_depth", "a whole number");
        require(*s.max_depth >= 0, "max_depth must not be negative");
    }
    if (is_given(o, "camera")) s.camera = camera_override(o["camera"]);
    if (is_given(o, "environment")) s.environment = environment_override(o);
    if (is_given(o, "environment_rotation")) {
        s.environment_rotation = value_of<float>(o, "environment_rotation", "a number of degrees");
        require(std::isfinite(*s.environment_rotation), "environment_rotation must be finite");
    }
    s.environment_scale = positive<float>(o, "environment_scale");
    for (const py::handle& given : o["light"]) s.lamps.push_back(lamp(given));
    return s;
}

}  // namespace covtrace::python
