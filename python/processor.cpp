// The module `covtrace._processor`, which tells of instructions that `covtrace._covtrace` needs and
// this processor lacks, before that module is loaded and ends the process by a signal.
#include <Python.h>

#include "core/processor.h"

PyMODINIT_FUNC PyInit__processor() {
    static PyModuleDef definition = [] {
        PyModuleDef d{};
        d.m_base = PyModuleDef_HEAD_INIT;
        d.m_name = "covtrace._processor";
        return d;
    }();
    PyObject* module = PyModule_Create(&definition);
    if (!module) return nullptr;
    const char* missing = covtrace::missing_instructions();
    PyObject* value = missing ? PyUnicode_FromString(missing) : Py_NewRef(Py_None);
    if (PyModule_AddObjectRef(module, "missing_instructions", value) != 0) Py_CLEAR(module);
    Py_XDECREF(value);
    return module;
}
