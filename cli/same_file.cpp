#include "cli/same_file.h"

#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "core/error.h"
#include "image/output_file.h"
#include "render/film_file.h"

namespace covtrace::cli {

namespace fs = std::filesystem;

namespace {

fs::path folder_of(const fs::path& file) {
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// Whether some file system may take both names for one: they differ in capitals alone, or have
/// letters beyond ASCII, which have several spellings.
bool are_alike(const std::string& a, const std::string& b) {
    const auto is_ascii = [](char c) { return static_cast<unsigned char>(c) < 0x80; };
    if (!std::all_of(a.begin(), a.end(), is_ascii) || !std::all_of(b.begin(), b.end(), is_ascii))
        return true;
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) {
        return std::tolower(x) == std::tolower(y);
    });
}

/// Whether the file system takes both names for one. That is tried: where a file of the first name
/// is made, is there one of the second? No rule that is written down here would know all systems
/// that ignore case or accents.
bool are_one_name(const fs::path& first, const fs::path& second) {
    if (first.filename() == second.filename()) return true;
    if (!are_alike(first.filename().string(), second.filename().string())) return false;
    try {
        const OutputFile probe(first);
        fs::path other = second;
        other += OutputFile::part_suffix();
        std::error_code error;
        return fs::exists(other, error);
    } catch (const Error&) {
        return false;  // nothing can be written there: the command that tries says why
    }
}

using FileNumber = std::pair<dev_t, ino_t>;

/// The number that all names of a regular file share; none where there is no such file.
std::optional<FileNumber> number_of(const fs::path& file) {
    struct stat status {};
    if (file.empty() || ::stat(file.c_str(), &status) != 0 || !S_ISREG(status.st_mode))
        return std::nullopt;
    return FileNumber(status.st_dev, status.st_ino);
}

}  // namespace

bool is_same_file(const fs::path& a, const fs::path& b) {
    if (a.empty() || b.empty()) return false;
    std::error_code error;
    if (fs::exists(a, error) || fs::exists(b, error)) {
        const auto first = number_of(a);
        return first && first == number_of(b);
    }
    const fs::path first = OutputFile::resolved(a), second = OutputFile::resolved(b);
    // Two files that are not there yet are one where their folders, and their names in them, are.
    return fs::equivalent(folder_of(first), folder_of(second), error) &&
           are_one_name(first, second);
}

void require_distinct(const std::vector<NamedOutput>& outputs,
                      const std::vector<fs::path>& inputs) {
    // Each input is looked at once: a scene may read a hundred thousand files.
    std::map<FileNumber, const fs::path*> read;
    for (const fs::path& input : inputs)
        if (const auto number = number_of(input)) read.emplace(*number, &input);
    for (size_t k = 0; k < outputs.size(); ++k) {
        const auto& [option, file] = outputs[k];
        const auto number = number_of(file);
        const auto input = number ? read.find(*number) : read.end();
        if (input != read.end())
            throw Error(ErrorKind::usage, option + ": '" + file.string() +
                                              "' would take the place of '" +
                                              input->second->string() + "', which is read");
        for (size_t j = 0; j < k; ++j)
            if (is_same_file(file, outputs[j].file))
                throw Error(ErrorKind::usage, option + ": '" + file.string() + "' is the file of " +
                                                  outputs[j].option +
                                                  " already; expected another one");
    }
}

void add_film(std::vector<NamedOutput>& outputs, const std::string& option, const fs::path& film) {
    if (film.empty()) return;
    outputs.push_back({option, film});
    const fs::path earlier = earlier_film(film);
    // A writer that was killed after it gave the older film its second name, and before the newer
    // one took the first, left two names of one file. The next writer replaces either.
    std::error_code error;
    if (!is_same_file(film, earlier) || fs::is_symlink(earlier, error) ||
        fs::is_symlink(film, error))
        outputs.push_back({option + ", the earlier film", earlier});
}

}  // namespace covtrace::cli
