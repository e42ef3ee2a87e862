#include "bindings.h"
#include "python_lock.h"
#include "render/version.h"

PYBIND11_MODULE(_covtrace, module) {
    using namespace covtrace;
    module.doc() = "The compiled half of the package covtrace; import covtrace instead.";
    module.attr("__version__") = kVersion;
    python::bind_errors(module);
    python::bind_image(module);
    python::bind_films(module);
    python::bind_denoise(module);
    python::bind_render(module);
    python::bind_covariance(module);
    python::bind_interpreter_end(module);
}
