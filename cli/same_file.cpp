#include "cli/same_file.h"

#include <system_error>

#include "core/error.h"
#include "image/output_file.h"

namespace covtrace::cli {

namespace fs = std::filesystem;

bool is_same_file(const fs::path& a, const fs::path& b) {
    if (a.empty() || b.empty()) return false;
    const fs::path first = OutputFile::resolved(a), second = OutputFile::resolved(b);
    std::error_code error;
    for (const fs::path& file : {first, second})
        if (fs::exists(file, error) && !fs::is_regular_file(file, error)) return false;
    if (fs::equivalent(first, second, error)) return true;
    const fs::path whole = fs::weakly_canonical(first, error);
    return !error && whole == fs::weakly_canonical(second, error) && !error;
}

void require_distinct(const std::vector<NamedOutput>& outputs,
                      const std::vector<fs::path>& inputs) {
    for (size_t k = 0; k < outputs.size(); ++k) {
        const auto& [option, file] = outputs[k];
        for (const fs::path& input : inputs)
            if (is_same_file(file, input))
                throw Error(ErrorKind::usage, option + ": '" + file.string() +
                                                  "' would take the place of the input '" +
                                                  input.string() + "'");
        for (size_t j = 0; j < k; ++j)
            if (is_same_file(file, outputs[j].file))
                throw Error(ErrorKind::usage, option + ": '" + file.string() + "' is the file of " +
                                                  outputs[j].option +
                                                  " already; expected another one");
    }
}

}  // namespace covtrace::cli
