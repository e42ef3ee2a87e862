#include "python_lock.h"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>

#include "core/error.h"

namespace covtrace::python {

namespace {

/// Activity for which the interpreter's end waits. Nobody asks for Python's lock while holding
/// `mutex`, which threads with Python's lock may therefore wait for.
struct Activity {
    std::mutex mutex;
    std::condition_variable changed;
    int unlocked = 0;             ///< threads that work with the lock released
    int calling = 0;              ///< threads that have the lock, or are about to, inside of C++
    std::set<Monitor*> monitors;  ///< monitors of the renders
    std::thread::id ending;       ///< the thread that ends the interpreter, once it does
    bool is_ending() const { return ending != std::thread::id(); }
};

/// The one Activity, never destroyed: threads wait in it to the end of the process.
Activity& activity() {
    static auto* const a = new Activity;
    return *a;
}

[[noreturn]] void wait_for_ever(std::unique_lock<std::mutex>& lock) {
    for (;;) activity().changed.wait(lock);
}

void finish_work() {
    // Longest wait for the caller's functions: one that does not come back must not keep the
    // process alive.
    constexpr std::chrono::seconds kMostCalling{5};
    Activity& a = activity();
    PyThreadState* const state = PyEval_SaveThread();
    {
        std::unique_lock lock(a.mutex);
        a.ending = std::this_thread::get_id();
        for (Monitor* monitor : a.monitors) monitor->cancel();
        a.changed.wait(lock, [&a] { return a.monitors.empty() && a.unlocked == 0; });
        a.changed.wait_for(lock, kMostCalling, [&a] { return a.calling == 0; });
    }
    PyEval_RestoreThread(state);
}

void count(int& counter, int change) {
    const std::lock_guard lock(activity().mutex);
    counter += change;
    activity().changed.notify_all();
}

}  // namespace

Unlocked::Unlocked(const Calls* between)
    : between_calls_(between != nullptr), state_(PyEval_SaveThread()) {
    Activity& a = activity();
    const std::lock_guard lock(a.mutex);
    ++a.unlocked;
    if (between_calls_) --a.calling;
    a.changed.notify_all();
}

Unlocked::~Unlocked() {
    Activity& a = activity();
    {
        std::unique_lock lock(a.mutex);
        --a.unlocked;
        a.changed.notify_all();
        if (a.is_ending() && a.ending != std::this_thread::get_id()) wait_for_ever(lock);
        ++a.calling;
    }
    PyEval_RestoreThread(state_);
    if (!between_calls_) count(a.calling, -1);
}

Calls::Calls() {
    count(activity().calling, 1);
}

Calls::~Calls() {
    count(activity().calling, -1);
}

Work::Work(Monitor& monitor) : monitor_(monitor) {
    Activity& a = activity();
    const std::lock_guard lock(a.mutex);
    if (a.is_ending()) throw Error(ErrorKind::interrupted, "Python ends: nothing is rendered");
    a.monitors.insert(&monitor_);
}

Work::~Work() {
    Activity& a = activity();
    const std::lock_guard lock(a.mutex);
    a.monitors.erase(&monitor_);
    a.changed.notify_all();
}

void bind_interpreter_end(pybind11::module_& module) {
    pybind11::module_::import("atexit").attr("register")(
        pybind11::cpp_function(&finish_work, pybind11::scope(module)));
}

}  // namespace covtrace::python
