#include "cli/failure.h"

#include <algorithm>
#include <new>
#include <string>
#include <system_error>

#include "cli/message.h"
#include "core/error.h"

namespace covtrace::cli {

namespace {

/// The exit code of an error, as docs/reference/exit-codes.md lists them.
int exit_code(ErrorKind kind) {
    using enum ErrorKind;
    switch (kind) {
        case usage:
            return kUsageExitCode;
        case scene:
            return 3;
        case limit:
            return kLimitExitCode;
        case io:
            return 5;
        case interrupted:
            return 6;
        case internal:
            return 7;
    }
    return 7;
}

/// The error's message. One that refuses an option begins with the name of its field, "max_spp: ",
/// which becomes the option of the command line, "--max-spp: ".
std::string message_of(const Error& e) {
    const std::string text = e.what();
    if (e.option().empty()) return text;
    std::string option = e.option();
    std::replace(option.begin(), option.end(), '_', '-');
    return "--" + option + text.substr(option.size());
}

}  // namespace

int report_failure(const std::exception_ptr& failure) {
    try {
        std::rethrow_exception(failure);
    } catch (const Error& e) {
        say("covtrace: {}\n", message_of(e));
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
