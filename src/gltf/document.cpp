#include "gltf/document.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <system_error>

#include "core/hash.h"
#include "gltf/animated_properties.h"
#include "gltf/checked_json.h"
#include "gltf/codecs/draco.h"
#include "gltf/codecs/meshopt.h"
#include "gltf/plain_json.h"
#include "gltf/range_text.h"
#include "scene/names.h"
#include "scene/scene_files.h"

namespace covtrace::gltf {
namespace {

namespace fs = std::filesystem;

/// Size of the largest file: the library counts bytes in 32 bits.
constexpr uintmax_t kLargestFile = (uintmax_t{1} << 32) - 1;

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

std::string decode_percent(const std::string& uri) {
    std::string name;
    for (size_t i = 0; i < uri.size(); ++i) {
        const int high = i + 2 < uri.size() && uri[i] == '%' ? hex_digit(uri[i + 1]) : -1;
        const int low = high >= 0 ? hex_digit(uri[i + 2]) : -1;
        if (low >= 0) {
            name += static_cast<char>(16 * high + low);
            i += 2;
        } else {
            name += uri[i];
        }
    }
    return name;
}

bool has_scheme(const std::string& uri) {
    const size_t colon = uri.find(':');
    return colon != std::string::npos && uri.find('/') > colon;
}

bool is_inside(const fs::path& file, const fs::path& folder) {
    std::error_code failed;
    const fs::path f = fs::weakly_canonical(file, failed);
    if (failed) return false;
    const fs::path root = fs::weakly_canonical(folder.empty() ? "." : folder, failed);
    if (failed) return false;
    const auto [mismatch, unused] = std::mismatch(root.begin(), root.end(), f.begin(), f.end());
    return mismatch == root.end();
}

/// Data of the library's file callbacks.
struct Reading {
    const Document* document;
    SceneFiles* files;
};

bool file_exists(const std::string&, void*) {
    return true;  // read_file tells what is wrong with the name
}
std::string same_path(const std::string& name, void*) {
    return name;
}
bool read_file(std::vector<unsigned char>* bytes, std::string*, const std::string& name,
               void* data) {
    const auto& reading = *static_cast<const Reading*>(data);
    // Percent signs are encoded again: the library has decoded them, and a name may hold them.
    std::string uri;
    for (const char c : name) uri += c == '%' ? std::string("%25") : std::string(1, c);
    const fs::path file = find_file(*reading.document, uri, "buffers");
    std::error_code failed;
    if (fs::file_size(file, failed) > kLargestFile && !failed)
        throw Error(ErrorKind::limit, reading.document->name + ": buffers: file " +
                                          path_in_quotes(file.string()) + " is larger than 4 GiB");
    const std::string content = reading.files->read(file, reading.document->place("buffers"));
    bytes->assign(content.begin(), content.end());
    return true;
}

/// Keeps the encoded file of an image, in place of the library's decoder.
bool keep_image(tinygltf::Image* image, int, std::string*, std::string*, int, int,
                const unsigned char* bytes, int size, void*) {
    image->image.assign(bytes, bytes + size);
    return true;
}

/// The first line of the library's message, in ASCII.
std::string first_line(const std::string& text) {
    std::string line = text.substr(0, text.find('\n'));
    for (char& c : line)
        if (c < 0x20 || c > 0x7e) c = '?';
    constexpr size_t kLongest = 200;
    return line.substr(0, kLongest);
}

bool is_binary(std::string_view bytes) {
    return bytes.starts_with("glTF");
}

uint32_t word_at(std::string_view bytes, size_t offset) {
    uint32_t word = 0;
    if (offset + sizeof word <= bytes.size())
        std::memcpy(&word, bytes.data() + offset, sizeof word);
    return word;
}

/// The JSON chunk of a binary file. Its lengths are held against the bytes that are there: the
/// library overlooks the eight bytes of the second chunk's header.
std::string_view json_chunk(std::string_view bytes, const std::string& name) {
    constexpr size_t kHeader = 12, kChunk = 8;
    // The version decides where lengths stand
    if (const uint32_t version = word_at(bytes, 4); bytes.size() >= kHeader && version != 2)
        throw Error(ErrorKind::scene, name + ": binary glTF of version " + std::to_string(version) +
                                          "; expected version 2");
    const size_t total = word_at(bytes, 8), length = word_at(bytes, kHeader);
    const auto holds = [&](size_t begin, size_t size) {
        return begin <= total && size <= total - begin;
    };
    const size_t second = kHeader + kChunk + length;
    const bool has_second = holds(second, kChunk);
    if (total > bytes.size() || !holds(kHeader + kChunk, length) ||
        (has_second && !holds(second + kChunk, word_at(bytes, second))))
        throw Error(ErrorKind::scene, name + ": the binary glTF file is cut short");
    return bytes.substr(kHeader + kChunk, length);
}

/// A binary file, up to the end that its header tells, with another JSON chunk.
std::string with_json_chunk(std::string_view bytes, std::string_view old_json, std::string json) {
    const auto word = [](size_t v) {
        const auto bits = static_cast<uint32_t>(v);
        std::string s(sizeof bits, '\0');
        std::memcpy(s.data(), &bits, sizeof bits);
        return s;
    };
    json.resize((json.size() + 3) / 4 * 4, ' ');
    bytes = bytes.substr(0, word_at(bytes, 8));
    const auto rest = static_cast<size_t>(old_json.data() + old_json.size() - bytes.data());
    std::string all = std::string(bytes.substr(0, 8));
    all += word(20 + json.size() + bytes.size() - rest) + word(json.size()) + "JSON" + json;
    return all.append(bytes.substr(rest));
}

/// Checks the file's JSON; returns the file as tinygltf takes it.
std::string checked_file(std::string bytes, const std::string& name) {
    const bool binary = is_binary(bytes);
    const std::string_view json = binary ? json_chunk(bytes, name) : std::string_view(bytes);
    const std::string json_name = binary ? name + " (JSON chunk)" : name;
    check_json(json, json_name);
    std::optional<std::string> plain = plain_json(json, binary);
    if (!plain) return bytes;
    check_json(*plain, json_name);
    return binary ? with_json_chunk(bytes, json, std::move(*plain)) : std::move(*plain);
}

void parse(Document& document, std::string_view bytes, SceneFiles& files) {
    Reading reading{&document, &files};
    tinygltf::TinyGLTF library;
    library.SetFsCallbacks({file_exists, same_path, read_file, nullptr, &reading});
    library.SetImageLoader(keep_image, nullptr);
    std::string error, warning;
    bool parsed = false;
    const auto size = static_cast<unsigned>(bytes.size());
    try {
        parsed = is_binary(bytes)
                     ? library.LoadBinaryFromMemory(
                           &document.model, &error, &warning,
                           reinterpret_cast<const unsigned char*>(bytes.data()), size, "")
                     : library.LoadASCIIFromString(&document.model, &error, &warning, bytes.data(),
                                                   size, "");
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& e) {
        error = e.what();
    }
    if (!parsed || !error.empty())
        throw Error(ErrorKind::scene,
                    document.name + ": this is no valid glTF: " + first_line(error));
}

/// Decodes what codecs have compressed. What they made counts in the document's budgets.
void decode(Document& document, WarningLog& log) {
    document.decoded = budget_of_decoded(document.bytes);
    const size_t read = document.model.buffers.size();
    decode_meshopt(document);
    decode_draco(document, log);
    uint64_t made = 0;
    for (size_t i = read; i < document.model.buffers.size(); ++i)
        made += document.model.buffers[i].data.size();
    document.bytes += bytes_for_decoded(made);
}

}  // namespace

SourceLocation Document::place(const std::string& path) const {
    return {std::make_shared<const std::string>(path.empty() ? name : name + ": " + path), 0, 0};
}

void Document::refuse(const std::string& path, const std::string& text) const {
    throw Error(ErrorKind::scene, place(path), text);
}

namespace {

Document document_of(std::string bytes, const std::string& name, const fs::path& folder,
                     const std::vector<fs::path>& search_paths, SceneFiles& files,
                     WarningLog& log) {
    Document document;
    document.name = name;
    document.folder = folder;
    document.roots = {document.folder};
    document.roots.insert(document.roots.end(), search_paths.begin(), search_paths.end());
    if (bytes.size() > kLargestFile)
        throw Error(ErrorKind::limit, document.name + ": the file is larger than 4 GiB");
    document.bytes = bytes.size();
    const std::string file = checked_file(std::move(bytes), document.name);
    document.properties =
        json_of_properties(is_binary(file) ? json_chunk(file, name) : std::string_view(file));
    parse(document, file, files);
    document.content_hash = files.content_hash();
    for (const fs::path& read : files.files()) document.files.insert(read);
    for (const tinygltf::Buffer& buffer : document.model.buffers)
        document.bytes += buffer.data.size();
    decode(document, log);
    document.numbers = budget_of_numbers(document.bytes);
    return document;
}

}  // namespace

Document read_document(const fs::path& file, const std::vector<fs::path>& search_paths,
                       WarningLog& log) {
    SceneFiles files(file.parent_path(), search_paths, log);
    return document_of(files.read(file, {}), file.string(), file.parent_path(), search_paths, files,
                       log);
}

Document parse_document(const std::string& bytes, const std::string& name, const fs::path& folder,
                        const std::vector<fs::path>& search_paths, WarningLog& log) {
    SceneFiles files(folder, search_paths, log);
    files.add_to_hash(hash_of(bytes));
    return document_of(bytes, name, folder, search_paths, files, log);
}

fs::path find_file(const Document& document, const std::string& uri, const std::string& place) {
    const std::string name = decode_percent(uri);
    if (name.empty() || name.find('\0') != std::string::npos || has_scheme(uri) ||
        fs::path(name).is_absolute())
        document.refuse(place, "the URI " + in_quotes(uri) +
                                   " names no file beside the scene; expected a relative path");
    bool escapes = false;
    for (const fs::path& root : document.roots) {
        const fs::path candidate = (root / name).lexically_normal();
        std::error_code ignored;
        if (!fs::is_regular_file(candidate, ignored)) continue;
        const bool inside = std::any_of(document.roots.begin(), document.roots.end(),
                                        [&](const fs::path& r) { return is_inside(candidate, r); });
        if (inside) return *document.files.insert(candidate).first;
        escapes = true;
    }
    if (escapes)
        document.refuse(place, "file " + path_in_quotes(name) +
                                   " lies outside the scene's folder; expected a file in it or in "
                                   "a folder given as search path");
    for (const fs::path& root : document.roots) require_regular(root / name, document.place(place));
    document.refuse(place,
                    "file " + path_in_quotes(name) + " not found; looked in " +
                        path_in_quotes(document.folder.empty() ? "." : document.folder.string()) +
                        (document.roots.size() > 1 ? " and the search paths" : ""));
}

std::string element(std::string_view list, size_t index) {
    return std::string(list) + "[" + std::to_string(index) + "]";
}

const tinygltf::Value* extension(const tinygltf::ExtensionMap& extensions, const char* name) {
    const auto it = extensions.find(name);
    return it != extensions.end() && it->second.IsObject() ? &it->second : nullptr;
}

namespace {

double checked(const Document& document, const tinygltf::Value& value, double least, double most,
               const std::string& place) {
    const double v = value.IsNumber() ? value.GetNumberAsDouble() : std::nan("");
    if (!(v >= least && v <= most))
        document.refuse(place, "expected a number " + range_text(least, most));
    return v;
}

}  // namespace

double nearest(const Document& document, double value, double least, double most,
               const std::string& place, WarningLog& log) {
    if (!std::isfinite(value))
        document.refuse(place, "expected a number " + range_text(least, most));
    const double end = std::clamp(value, least, most);
    constexpr double kRounding = 1e-5;  // of exporters that count in single precision
    if (std::abs(value - end) > kRounding)
        log.add(document.place(place), "expected a number " + range_text(least, most) + ", found " +
                                           number_text(value) + "; " + number_text(end) +
                                           " takes its place");
    return end;
}

double number(const Document& document, const tinygltf::Value& object, const char* key,
              double otherwise, double least, double most, const std::string& place) {
    if (!object.Has(key)) return otherwise;
    return checked(document, object.Get(key), least, most, place + "." + key);
}

template <size_t n>
std::array<double, n> numbers(const Document& document, const tinygltf::Value& object,
                              const char* key, std::array<double, n> otherwise, double least,
                              const std::string& place) {
    if (!object.Has(key)) return otherwise;
    const tinygltf::Value& list = object.Get(key);
    if (!list.IsArray() || list.ArrayLen() != n)
        document.refuse(place + "." + key, "expected " + std::to_string(n) + " numbers");
    std::array<double, n> result{};
    for (size_t i = 0; i < n; ++i)
        result[i] = checked(document, list.Get(i), least, 1e30, place + "." + key);
    return result;
}
template std::array<double, 2> numbers(const Document&, const tinygltf::Value&, const char*,
                                       std::array<double, 2>, double, const std::string&);
template std::array<double, 3> numbers(const Document&, const tinygltf::Value&, const char*,
                                       std::array<double, 3>, double, const std::string&);
template std::array<double, 4> numbers(const Document&, const tinygltf::Value&, const char*,
                                       std::array<double, 4>, double, const std::string&);

tinygltf::TextureInfo texture_info(const Document& document, const tinygltf::Value& object,
                                   const char* key, const std::string& place) {
    tinygltf::TextureInfo info;
    if (!object.Has(key)) return info;
    const tinygltf::Value& value = object.Get(key);
    const std::string here = place + "." + key;
    if (!value.IsObject() || !value.Has("index"))
        document.refuse(here, "expected an object with an \"index\"");
    constexpr double kLargestIndex = 1 << 30;
    info.index = static_cast<int>(number(document, value, "index", 0, 0, kLargestIndex, here));
    info.texCoord =
        static_cast<int>(number(document, value, "texCoord", 0, 0, kLargestIndex, here));
    if (value.Has("extensions") && value.Get("extensions").IsObject())
        for (const std::string& name : value.Get("extensions").Keys())
            info.extensions[name] = value.Get("extensions").Get(name);
    return info;
}

}  // namespace covtrace::gltf
