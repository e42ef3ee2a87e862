#include "pbrt/version_three.h"

#include <algorithm>
#include <array>
#include <utility>

#include "scene/names.h"

namespace covtrace {

namespace {

constexpr std::array<std::pair<std::string_view, std::string_view>, 45> kNames{{
    {"directive", "WorldEnd"},
    {"directive", "Renderer"},
    {"directive", "SurfaceIntegrator"},
    {"directive", "VolumeIntegrator"},
    {"directive", "Volume"},
    {"directive", "SearchPath"},
    {"film", "image"},
    {"camera", "environment"},
    {"integrator", "directlighting"},
    {"integrator", "whitted"},
    {"sampler", "lowdiscrepancy"},
    {"sampler", "02sequence"},
    {"sampler", "maxmindist"},
    {"sampler", "random"},
    {"material", "matte"},
    {"material", "glass"},
    {"material", "plastic"},
    {"material", "metal"},
    {"material", "mirror"},
    {"material", "uber"},
    {"material", "substrate"},
    {"material", "translucent"},
    {"material", "fourier"},
    {"material", "disney"},
    {"material", "kdsubsurface"},
    {"material", "shinymetal"},
    {"shape", "cone"},
    {"shape", "paraboloid"},
    {"shape", "hyperboloid"},
    {"shape", "heightfield"},
    {"shape", "heightfield2"},
    {"shape", "nurbs"},
    {"light", "exinfinite"},
    {"area light", "area"},
    {"texture", "color"},
    {"texture", "uv"},
    {"medium", "heterogeneous"},
    {"infinite light parameter", "mapname"},
    {"projection light parameter", "mapname"},
    {"goniometric light parameter", "mapname"},
    {"filter", "windowedsinc"},
    {"camera", "pinhole"},
    {"sampler", "bestcandidate"},
    {"sampler", "adaptive"},
    {"integrator", "photonmap"},
}};

}  // namespace

bool is_version_three_name(std::string_view kind, std::string_view name) {
    return std::find(kNames.begin(), kNames.end(), std::pair{kind, name}) != kNames.end();
}

Error version_three_error(const SourceLocation& where, const std::string& what) {
    return Error(ErrorKind::scene, where,
                 what +
                     " belongs to pbrt-v3; this reader expects version 4: convert the scene with "
                     "\"pbrt --upgrade old.pbrt > new.pbrt\"");
}

Error unknown_type_error(const SourceLocation& where, const std::string& kind,
                         const std::string& name, const std::vector<std::string>& known) {
    if (is_version_three_name(kind, name))
        return version_three_error(where, kind + " " + in_quotes(name));
    return Error(ErrorKind::scene, where, unknown_name(kind, name, known));
}

}  // namespace covtrace
