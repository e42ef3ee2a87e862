#include "cli/interrupts.h"

#include <csignal>

namespace covtrace::cli {

namespace {

Monitor* interrupted_monitor = nullptr;

extern "C" void on_interrupt(int signal) {
    if (interrupted_monitor && !interrupted_monitor->cancelled()) {
        interrupted_monitor->cancel();
        return;
    }
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

}  // namespace

InterruptGuard::InterruptGuard(Monitor& monitor) {
    interrupted_monitor = &monitor;
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
}

InterruptGuard::~InterruptGuard() {
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    interrupted_monitor = nullptr;
}

}  // namespace covtrace::cli
