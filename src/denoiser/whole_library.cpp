#include "denoiser/whole_library.h"

#include <elf.h>

#include <cstring>
#include <fstream>

#include "core/error.h"

namespace covtrace {

void require_whole(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary | std::ios::ate);
    if (!in) throw Error(ErrorKind::usage, file.string() + ": cannot be read");
    const auto size = static_cast<uint64_t>(in.tellg());
    const auto read = [&](uint64_t at, void* to, size_t bytes) {
        in.seekg(static_cast<std::streamoff>(at));
        return at <= size && bytes <= size - at &&
               in.read(static_cast<char*>(to), static_cast<std::streamsize>(bytes));
    };
    Elf64_Ehdr header;
    if (!read(0, &header, sizeof header) || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 ||
        header.e_ident[EI_CLASS] != ELFCLASS64)
        return;
    for (size_t i = 0; i < header.e_phnum; ++i) {
        Elf64_Phdr part;
        const bool is_there = read(header.e_phoff + i * sizeof part, &part, sizeof part);
        if (!is_there || (part.p_type == PT_LOAD &&
                          (part.p_offset > size || part.p_filesz > size - part.p_offset)))
            throw Error(ErrorKind::usage, file.string() + ": its end is missing");
    }
}

}  // namespace covtrace
