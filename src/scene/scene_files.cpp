#include "scene/scene_files.h"

#include <zlib.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <system_error>

#include "core/file_kind.h"
#include "core/hash.h"
#include "scene/names.h"
#include "scene/warning_log.h"

namespace covtrace {

namespace fs = std::filesystem;

namespace {

bool is_file(const fs::path& p) {
    std::error_code ignored;
    return fs::is_regular_file(p, ignored);
}

bool same_without_case(const std::string& a, const std::string& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
        return std::tolower(static_cast<unsigned char>(x)) ==
               std::tolower(static_cast<unsigned char>(y));
    });
}

/// Follows `name` from `folder` part by part, taking a part of another case where the exact one is
/// missing.
std::optional<fs::path> find_without_case(fs::path folder, const fs::path& name) {
    for (const fs::path& part : name) {
        std::error_code failed;
        if (fs::exists(folder / part, failed)) {
            folder /= part;
            continue;
        }
        std::optional<fs::path> match;
        for (fs::directory_iterator it(folder.empty() ? "." : folder, failed), end;
             !failed && it != end; it.increment(failed)) {
            const fs::path candidate = it->path().filename();
            // The smallest of several matches is taken, so that the choice doesn't depend on the
            // order of the folder.
            if (same_without_case(candidate.string(), part.string()) &&
                (!match || candidate < *match))
                match = candidate;
        }
        if (!match) return std::nullopt;
        folder /= *match;
    }
    if (!is_file(folder)) return std::nullopt;
    return folder;
}

/// Ratio of compression beyond that of real meshes and scenes: a large file with more is a bomb.
/// The most that zlib can do is 1032.
constexpr uint64_t kMostCompression = 100;
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
constexpr uint64_t kHarmlessSize = uint64_t(1) << 24;
#else
constexpr uint64_t kHarmlessSize = uint64_t(1) << 28;
#endif

std::string read_compressed(const fs::path& file, const SourceLocation& where) {
    std::error_code ignored;
    const uint64_t most =
        std::max(kHarmlessSize, kMostCompression * uint64_t(fs::file_size(file, ignored)));
    const std::unique_ptr<gzFile_s, int (*)(gzFile)> in(gzopen(file.c_str(), "rb"), gzclose);
    if (!in) throw Error(ErrorKind::scene, where, "can't open " + path_in_quotes(file.string()));
    gzbuffer(in.get(), 1 << 18);
    std::string text;
    std::vector<char> block(1 << 20);
    for (;;) {
        const int n = gzread(in.get(), block.data(), static_cast<unsigned>(block.size()));
        int status = Z_OK;
        const std::string problem = gzerror(in.get(), &status);
        if (n < 0 || (status != Z_OK && status != Z_STREAM_END))
            throw Error(ErrorKind::scene, where,
                        "can't decompress " + path_in_quotes(file.string()) + ": " + problem);
        if (n == 0) return text;
        if (text.size() + static_cast<size_t>(n) > most)
            throw Error(ErrorKind::limit, where,
                        path_in_quotes(file.string()) + " grows to more than " +
                            std::to_string(kMostCompression) +
                            " times its size when it is decompressed; expected a mesh or a scene");
        text.append(block.data(), static_cast<size_t>(n));
    }
}

}  // namespace

std::vector<fs::path> SceneFiles::roots() const {
    std::vector<fs::path> roots{folder_};
    roots.insert(roots.end(), search_paths_.begin(), search_paths_.end());
    roots.emplace_back();
    return roots;
}

std::optional<fs::path> SceneFiles::find_optional(const std::string& name,
                                                  const SourceLocation& where) {
    if (name.empty()) throw Error(ErrorKind::scene, where, "the file name is empty");
    if (name.find('\0') != std::string::npos)
        throw Error(ErrorKind::scene, where, "the file name holds a zero byte");
    std::string plain = name;
    std::replace(plain.begin(), plain.end(), '\\', '/');
    for (const fs::path& root : roots()) {
        const fs::path p = root / name;
        if (is_file(p)) return found(name, p, where);
    }
    for (const fs::path& root : roots()) {
        const auto p = find_without_case(fs::path(plain).is_absolute() ? "/" : root,
                                         fs::path(plain).relative_path());
        if (!p) continue;
        const fs::path file = found(plain, *p, where);
        log_.add(where, "file " + path_in_quotes(name) + " does not exist as written; " +
                            path_in_quotes(file.string()) + " is used");
        return file;
    }
    for (const fs::path& root : roots()) require_regular(root / name, where);
    return std::nullopt;
}

fs::path SceneFiles::found(const std::string& name, const fs::path& file,
                           const SourceLocation& where) {
    warn_outside(name, file, where);
    fs::path plain = file.lexically_normal();
    files_.insert(plain);
    return plain;
}

void SceneFiles::warn_outside(const std::string& name, const fs::path& file,
                              const SourceLocation& where) {
    const fs::path plain = fs::path(name).lexically_normal();
    if (!plain.is_absolute() && *plain.begin() != "..") return;
    std::error_code ignored;
    const fs::path found = fs::weakly_canonical(file, ignored);
    const auto holds = [&](const fs::path& folder) {
        const fs::path root = fs::weakly_canonical(folder.empty() ? "." : folder, ignored);
        return std::mismatch(root.begin(), root.end(), found.begin(), found.end()).first ==
               root.end();
    };
    if (holds(folder_) || std::any_of(search_paths_.begin(), search_paths_.end(), holds)) return;
    log_.add(where,
             "files outside of the scene's folder are read; their folder as a search path says "
             "that this is meant");
}

fs::path SceneFiles::find(const std::string& name, const SourceLocation& where) {
    if (const auto file = find_optional(name, where)) return *file;
    std::string text = "file " + path_in_quotes(name) + " not found";
    if (!fs::path(name).is_absolute()) {
        text += "; looked in " + path_in_quotes(folder_.empty() ? "." : folder_.string());
        for (const fs::path& p : search_paths_) text += ", " + path_in_quotes(p.string());
    }
    throw Error(ErrorKind::scene, where, text);
}

std::string SceneFiles::read(const fs::path& file, const SourceLocation& where) {
    // Reading again is limited: files that include two others each, and so on, would keep the
    // reader busy for ever.
    constexpr uint64_t kMostReadAgain = uint64_t(1) << 30, kCostOfReading = 1 << 12;
    std::string text = read_whole_file(file, where);
    files_.insert(file.lexically_normal());
    if (!read_.insert(file).second) read_again_ += std::max<uint64_t>(text.size(), kCostOfReading);
    if (read_again_ > kMostReadAgain)
        throw Error(ErrorKind::limit, where,
                    "files are included again and again, more than 1 GiB of text in all; expected "
                    "objects and instances for what occurs so often");
    add_to_hash(hash_of(text));
    return text;
}

void SceneFiles::add_to_hash(uint64_t hash_of_a_file) {
    hash_ = hash_combine(hash_, hash_of_a_file);
}

void require_regular(const fs::path& file, const SourceLocation& where) {
    const std::string kind = irregular_kind(file);
    if (!kind.empty())
        throw Error(ErrorKind::scene, where,
                    path_in_quotes(file.string()) + " is " + kind + "; expected a regular file");
}

std::string read_whole_file(const fs::path& file, const SourceLocation& where) {
    require_regular(file, where);
    if (file.extension() == ".gz") return read_compressed(file, where);
    std::error_code failed;
    if (!fs::exists(file, failed))
        throw Error(ErrorKind::scene, where,
                    "file " + path_in_quotes(file.string()) + " not found");
    const auto size = fs::file_size(file, failed);
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> in(std::fopen(file.c_str(), "rb"),
                                                             std::fclose);
    if (failed || !in)
        throw Error(ErrorKind::scene, where,
                    "can't open " + path_in_quotes(file.string()) + ": " +
                        (failed ? failed.message() : std::string(std::strerror(errno))));
    std::string text;
    text.resize(size);
    if (std::fread(text.data(), 1, size, in.get()) != size)
        throw Error(ErrorKind::io, where, "reading " + path_in_quotes(file.string()) + " failed");
    return text;
}

uint64_t hash_of(std::string_view bytes) {
    uint64_t h = bytes.size();
    size_t i = 0;
    for (; i + 8 <= bytes.size(); i += 8) {
        uint64_t word;
        std::memcpy(&word, bytes.data() + i, 8);
        h = hash_combine(h, word);
    }
    uint64_t rest = 0;
    if (i < bytes.size()) std::memcpy(&rest, bytes.data() + i, bytes.size() - i);
    return hash_combine(h, rest);
}

}  // namespace covtrace
