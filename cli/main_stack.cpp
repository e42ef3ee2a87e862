#include "cli/main_stack.h"

#include <pthread.h>
#include <sys/resource.h>

#include <cstddef>
#include <exception>
#include <system_error>
#include <thread>

#include "core/error.h"

namespace covtrace::cli {

namespace {

constexpr size_t kStack = size_t{8} << 20;  // Linux' own limit

bool is_small() {
    rlimit limit{};
    return getrlimit(RLIMIT_STACK, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
           limit.rlim_cur < kStack;
}

/// Enlarges the stacks of threads: those that others start, as OpenEXR does, take the limit for the
/// size of their stacks.
bool enlarge_stacks_of_threads() {
    pthread_attr_t attributes;
    if (pthread_attr_init(&attributes) != 0) return false;
    const bool is_set = pthread_attr_setstacksize(&attributes, kStack) == 0 &&
                        pthread_setattr_default_np(&attributes) == 0;
    pthread_attr_destroy(&attributes);
    return is_set;
}

}  // namespace

int with_large_stack(const std::function<int()>& work) {
    if (!is_small()) return work();
    const Error no_stack(ErrorKind::limit,
                         "not enough memory for a stack of 8 MiB; expected a higher ulimit -s");
    if (!enlarge_stacks_of_threads()) throw no_stack;
    int code = 0;
    std::exception_ptr failure;
    std::thread thread;
    try {
        thread = std::thread([&] {
            try {
                code = work();
            } catch (...) {
                failure = std::current_exception();
            }
        });
    } catch (const std::system_error&) {
        throw no_stack;
    }
    thread.join();
    if (failure) std::rethrow_exception(failure);
    return code;
}

}  // namespace covtrace::cli
