#include "cli/failure.h"

#include <new>
#include <system_error>

#include "cli/message.h"
#include "core/error.h"

namespace covtrace::cli {

namespace {

int exit_code(ErrorKind kind) {
    using enum ErrorKind;
    switch (kind) {
        case usage:
            return kUsageExitCode;
        case scene:
            return 3;
        case limit:
            return 4;
        case io:
            return 5;
        case interrupted:
            return 6;
        case internal:
            return 7;
    }
    return 7;
}

}  // namespace

int report_failure(const std::exception_ptr& failure) {
    try {
        std::rethrow_exception(failure);
    } catch (const Error& e) {
        say("covtrace: {}\n", e.what());
        return exit_code(e.kind());
    } catch (const std::bad_alloc&) {
        say("covtrace: not enough memory\n");
        return exit_code(ErrorKind::limit);
    } catch (const std::system_error& e) {
        say("covtrace: {}\n", e.what());
        return exit_code(ErrorKind::io);
    } catch (const std::exception& e) {
        say("covtrace: internal error: {}\n", e.what());
        return exit_code(ErrorKind::internal);
    }
}

}  // namespace covtrace::cli
