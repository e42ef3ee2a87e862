#include <exception>

#include "bindings.h"
#include "core/error.h"

namespace covtrace::python {

namespace py = pybind11;

namespace {

/// The name of the exception's class in covtrace.errors.
const char* class_name(ErrorKind kind) {
    switch (kind) {
        case ErrorKind::usage:
            return "UsageError";
        case ErrorKind::scene:
            return "SceneError";
        case ErrorKind::limit:
            return "LimitError";
        case ErrorKind::io:
            return "FileError";
        case ErrorKind::interrupted:
            return "Interrupted";
        case ErrorKind::internal:
            return "InternalError";
    }
    return "InternalError";
}

}  // namespace

void bind_errors(py::module_&) {
    py::register_exception_translator([](std::exception_ptr pointer) {
        try {
            if (pointer) std::rethrow_exception(pointer);
        } catch (const Error& e) {
            const py::object type =
                py::module_::import("covtrace.errors").attr(class_name(e.kind()));
            const py::object exception = type(std::string(e.what()));
            PyErr_SetObject(type.ptr(), exception.ptr());
        }
    });
}

}  // namespace covtrace::python
