/// Python's lock, released while the renderer works, and the interpreter's end meanwhile.
///
/// A thread that asks for the lock while the interpreter ends, as daemon threads do, is ended by
/// Python in the middle of C++, which aborts the process. So at the beginning of the end, as an
/// atexit function, `finish_work` cancels every render, waits for threads that work without the
/// lock, and from then on all threads but the one that ends the interpreter wait for ever instead
/// of asking.
#pragma once

#include <pybind11/pybind11.h>

#include "render/progress.h"

namespace covtrace::python {

/// Guard around C++ that calls Python functions: the interpreter's end waits for it a while.
class Calls {
  public:
    Calls();
    ~Calls();
    Calls(const Calls&) = delete;
    Calls& operator=(const Calls&) = delete;
};

/// Guard that releases the lock. `between`: the calls that it interrupts, where there are any.
class Unlocked {
  public:
    explicit Unlocked(const Calls* between = nullptr);
    ~Unlocked();
    Unlocked(const Unlocked&) = delete;
    Unlocked& operator=(const Unlocked&) = delete;

  private:
    const bool between_calls_;
    PyThreadState* state_;
};

/// Guard around a thread that renders without the lock: the interpreter's end cancels the render
/// and waits for the guard's destructor.
class Work {
  public:
    /// Begins the work. Throws Error(interrupted) where the interpreter is ending.
    explicit Work(Monitor& monitor);
    ~Work();
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;

  private:
    Monitor& monitor_;
};

/// Has `finish_work` called when the interpreter begins to end.
void bind_interpreter_end(pybind11::module_& module);

}  // namespace covtrace::python
