#include "cli/interrupts.h"

#include <csignal>
#include <utility>

namespace covtrace::cli {

namespace {

std::function<bool()> interrupt_once;

extern "C" void on_interrupt(int signal) {
    if (interrupt_once && interrupt_once()) return;
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

}  // namespace

InterruptGuard::InterruptGuard(std::function<bool()> interrupt) {
    interrupt_once = std::move(interrupt);
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
}

InterruptGuard::~InterruptGuard() {
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    interrupt_once = nullptr;
}

}  // namespace covtrace::cli
