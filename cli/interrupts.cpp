#include "cli/interrupts.h"

#include <csignal>

namespace covtrace::cli {

namespace {

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free);  // a signal handler sets it

extern "C" void on_interrupt(int signal) {
    // A terminal that is closed may send SIGHUP twice, from the system and from the shell.
    if (!interrupted.exchange(true) || signal == SIGHUP) return;
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

}  // namespace

InterruptGuard::InterruptGuard() {
    interrupted = false;
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
    // A terminal that is closed ends a render as Ctrl-C does, but not a render that runs under
    // nohup.
    if (std::signal(SIGHUP, on_interrupt) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

InterruptGuard::~InterruptGuard() {
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    if (std::signal(SIGHUP, SIG_DFL) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

const std::atomic<bool>& InterruptGuard::flag() {
    return interrupted;
}

}  // namespace covtrace::cli
