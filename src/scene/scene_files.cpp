#include "scene/scene_files.h"

#include <zlib.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <system_error>

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
            // The smallest of several, so that the choice doesn't depend on the order of the
            // folder.
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

std::string read_compressed(const fs::path& file, const SourceLocation& where) {
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
        text.append(block.data(), static_cast<size_t>(n));
    }
}

}  // namespace

std::optional<fs::path> SceneFiles::find_optional(const std::string& name,
                                                  const SourceLocation& where) {
    if (name.empty()) throw Error(ErrorKind::scene, where, "the file name is empty");
    if (name.find('\0') != std::string::npos)
        throw Error(ErrorKind::scene, where, "the file name holds a zero byte");
    std::string plain = name;
    std::replace(plain.begin(), plain.end(), '\\', '/');
    std::vector<fs::path> roots{folder_};
    roots.insert(roots.end(), search_paths_.begin(), search_paths_.end());
    roots.emplace_back();
    for (const fs::path& root : roots) {
        const fs::path p = root / name;
        if (is_file(p)) return p.lexically_normal();
    }
    for (const fs::path& root : roots) {
        const auto p = find_without_case(fs::path(plain).is_absolute() ? "/" : root,
                                         fs::path(plain).relative_path());
        if (!p) continue;
        log_.add(where, "file " + path_in_quotes(name) + " does not exist as written; " +
                            path_in_quotes(p->lexically_normal().string()) + " is used");
        return p->lexically_normal();
    }
    return std::nullopt;
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
    std::string text;
    if (file.extension() == ".gz") {
        text = read_compressed(file, where);
    } else {
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
        text.resize(size);
        if (std::fread(text.data(), 1, size, in.get()) != size)
            throw Error(ErrorKind::io, where,
                        "reading " + path_in_quotes(file.string()) + " failed");
    }
    add_to_hash(text);
    return text;
}

void SceneFiles::add_to_hash(std::string_view bytes) {
    uint64_t h = hash_combine(hash_, bytes.size());
    size_t i = 0;
    for (; i + 8 <= bytes.size(); i += 8) {
        uint64_t word;
        std::memcpy(&word, bytes.data() + i, 8);
        h = hash_combine(h, word);
    }
    uint64_t rest = 0;
    if (i < bytes.size()) std::memcpy(&rest, bytes.data() + i, bytes.size() - i);
    hash_ = hash_combine(h, rest);
}

}  // namespace covtrace
