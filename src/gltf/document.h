/// Private to this folder: a glTF file and the buffers that it names, in memory.
#pragma once

#include <tiny_gltf.h>

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "gltf/budget.h"
#include "scene/warning_log.h"

namespace covtrace::gltf {

/// A glTF file, parsed. Indices in the model are unchecked: `at` checks them.
struct Document {
    std::string name;                          ///< as messages call the file
    std::filesystem::path folder;              ///< the file's own
    std::vector<std::filesystem::path> roots;  ///< folders that files may be read from
    tinygltf::Model model;
    std::string properties;  ///< JSON of what KHR_animation_pointer may move of `model`
    uint64_t content_hash = 0;
    uint64_t bytes = 0;                             ///< of the file and its buffers
    Budget decoded;                                 ///< what codecs may still decode to
    mutable Budget numbers;                         ///< what accessors may still be read as
    mutable std::set<std::filesystem::path> files;  ///< files that were read or found

    /// A place in the document, such as "meshes[2].primitives[0]".
    SourceLocation place(const std::string& path) const;
    [[noreturn]] void refuse(const std::string& path, const std::string& text) const;
};

/// Reads the file and its buffers, embedded images too. Throws the errors of read_gltf.
Document read_document(const std::filesystem::path& file,
                       const std::vector<std::filesystem::path>& search_paths, WarningLog& log);

/// The same of a file in memory, whose buffers are in `folder`.
Document parse_document(const std::string& bytes, const std::string& name,
                        const std::filesystem::path& folder,
                        const std::vector<std::filesystem::path>& search_paths, WarningLog& log);

/// The existing file that a URI means, percent signs decoded: in the scene's folder or a search
/// path. Errors: Error(scene) where it is missing, absolute, has a scheme, or leaves all of them.
std::filesystem::path find_file(const Document& document, const std::string& uri,
                                const std::string& place);

/// Name of an element in messages, such as "nodes[3]".
std::string element(std::string_view list, size_t index);

/// The element of a list; refuses at `place` an index that is not in it.
template <typename T>
const T& at(const Document& document, const std::vector<T>& list, int index,
            std::string_view list_name, const std::string& place) {
    if (index < 0 || static_cast<size_t>(index) >= list.size())
        document.refuse(
            place, "there is no " + std::string(list_name) + "[" + std::to_string(index) + "]; " +
                       (list.empty() ? "the file has none"
                                     : "expected less than " + std::to_string(list.size())));
    return list[static_cast<size_t>(index)];
}

/// The extension of that name, null where there is none or it is no object.
const tinygltf::Value* extension(const tinygltf::ExtensionMap& extensions, const char* name);
/// The value, or the nearer end of [least, most] with a warning where it lies outside of them;
/// rounding errors need no warning. Refuses what is not finite.
double nearest(const Document& document, double value, double least, double most,
               const std::string& place, WarningLog& log);
/// A number of an extension's object. Refuses other types and values outside [least, most].
double number(const Document& document, const tinygltf::Value& object, const char* key,
              double otherwise, double least, double most, const std::string& place);
/// Several numbers of an extension's object, of a fixed count, each in [least, most].
template <size_t n>
std::array<double, n> numbers(const Document& document, const tinygltf::Value& object,
                              const char* key, std::array<double, n> otherwise, double least,
                              const std::string& place);
/// A texture reference inside an extension; index -1 where there is none.
tinygltf::TextureInfo texture_info(const Document& document, const tinygltf::Value& object,
                                   const char* key, const std::string& place);

}  // namespace covtrace::gltf
