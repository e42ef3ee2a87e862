#include "render/film_file.h"

#include <unistd.h>
#include <xxhash.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>
#include <system_error>

#include "core/file_kind.h"
#include "core/parallel.h"
#include "image/output_file.h"
#include "render/film_arrays.h"
#include "render/film_format3.h"
#include "render/film_header.h"

namespace covtrace {

namespace {

namespace fs = std::filesystem;

constexpr std::array<char, 8> kMagic{'\x89', 'C', 'V', 'F', '\r', '\n', '\x1a', '\n'};
constexpr std::array<char, 8> kEnd{'c', 'v', 'f', ' ', 'e', 'n', 'd', '\n'};
constexpr uint32_t kMostHeader = 1 << 20;  // bytes
constexpr size_t kBlockRecords = 1 << 16;  // pixels in a block
constexpr size_t kRecordsAtOnce = 256;     // records whose bytes are moved before the next ones
constexpr size_t kBlocksAtOnce = 32;       // blocks in memory, compressed or being so
constexpr int kLevel = 1;  // fast: noise does not compress better at any other level

#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
// Otherwise damaged bytes would hardly ever get past the checksums.
constexpr bool kChecksums = false;
#else
constexpr bool kChecksums = true;
#endif

struct BlockHead {
    uint32_t stored_size;
    uint32_t raw_size;
    uint64_t hash;  // XXH3-64 of the stored bytes
};
static_assert(sizeof(BlockHead) == 16);

/// A piece of an array, compressed as a whole.
struct Block {
    char* records;
    size_t record_size, count;
    size_t raw_size() const { return record_size * count; }
};

std::vector<Block> blocks_of(const std::vector<FilmArray>& arrays) {
    std::vector<Block> blocks;
    for (const FilmArray& a : arrays)
        for (size_t i = 0; i < a.count; i += kBlockRecords)
            blocks.push_back({static_cast<char*>(a.records) + i * a.record_size, a.record_size,
                              std::min(kBlockRecords, a.count - i)});
    return blocks;
}

/// Calls `move(records, bytes, n)` for every four bytes of all records, n records at a time, which
/// stay in the processor's first cache. `bytes`: the places of their first to fourth bytes. The
/// first bytes of all records have the first places, then the second ones, and so on: signs and
/// exponents of neighbours are alike.
template <typename Byte, typename Move>
void for_words(const Block& b, Byte* shuffled, const Move& move) {
    for (size_t first = 0; first < b.count; first += kRecordsAtOnce)
        for (size_t byte = 0; byte < b.record_size; byte += sizeof(uint32_t)) {
            Byte* at = shuffled + byte * b.count + first;
            move(b.records + first * b.record_size + byte,
                 std::array{at, at + b.count, at + 2 * b.count, at + 3 * b.count},
                 std::min(kRecordsAtOnce, b.count - first));
        }
}

void shuffle(const Block& b, uint8_t* out) {
    std::array<uint32_t, kRecordsAtOnce> word;
    for_words(b, out, [&](const char* records, const auto& bytes, size_t n) {
        for (size_t i = 0; i < n; ++i)
            std::memcpy(&word[i], records + i * b.record_size, sizeof(uint32_t));
        for (size_t k = 0; k < bytes.size(); ++k)
            for (size_t i = 0; i < n; ++i) bytes[k][i] = uint8_t(word[i] >> (8 * k));
    });
}

void unshuffle(const uint8_t* in, const Block& b) {
    std::array<uint32_t, kRecordsAtOnce> word;
    for_words(b, in, [&](char* records, const auto& bytes, size_t n) {
        for (size_t i = 0; i < n; ++i)
            word[i] = uint32_t(bytes[0][i]) | uint32_t(bytes[1][i]) << 8 |
                      uint32_t(bytes[2][i]) << 16 | uint32_t(bytes[3][i]) << 24;
        for (size_t i = 0; i < n; ++i)
            std::memcpy(records + i * b.record_size, &word[i], sizeof(uint32_t));
    });
}

struct Compressor {
    ZSTD_CCtx* context = ZSTD_createCCtx();
    ~Compressor() { ZSTD_freeCCtx(context); }
};

std::string compressed(const Block& block) {
    static thread_local Compressor compressor;
    const auto raw = std::make_unique_for_overwrite<uint8_t[]>(block.raw_size());
    std::string stored(ZSTD_compressBound(block.raw_size()), '\0');
    shuffle(block, raw.get());
    const size_t size = ZSTD_compressCCtx(compressor.context, stored.data(), stored.size(),
                                          raw.get(), block.raw_size(), kLevel);
    if (ZSTD_isError(size))
        throw Error(ErrorKind::internal,
                    std::string("cannot compress a film: ") + ZSTD_getErrorName(size));
    stored.resize(size);
    return stored;
}

class FilmReader {
  public:
    FilmReader(std::istream& in, uint64_t size, const std::string& name)
        : name_(name), in_(in), left_(size) {}

    RenderState read() {
        std::array<char, 8> magic{};
        uint32_t format = 0, header_size = 0;
        uint64_t header_hash = 0;
        get(magic.data(), magic.size());
        if (magic != kMagic) fail("this is no film file");
        get(&format, sizeof format);
        if (format < kOldestFilmFormat || format > kFilmFormat)
            throw FilmOfOtherVersion(name_ + ": a film of format " + std::to_string(format) +
                                     ", of another version of covtrace; this version, " +
                                     program_version() + ", reads the formats " +
                                     std::to_string(kOldestFilmFormat) + " and " +
                                     std::to_string(kFilmFormat));
        get(&header_size, sizeof header_size);
        get(&header_hash, sizeof header_hash);
        if (header_size > kMostHeader) fail("the header is damaged");
        std::string header(header_size, '\0');
        get(header.data(), header.size());
        if (kChecksums && XXH3_64bits(header.data(), header.size()) != header_hash)
            fail("the header is damaged");
        RenderState state = parsed(header, format);
        if (format == 3) {
            FilmFormat3 old(state);
            read_blocks(blocks_of(old.arrays()));
            old.make_features();
        } else {
            read_blocks(blocks_of(film_arrays(state)));
        }
        return state;
    }

  private:
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(ErrorKind::scene, name_ + ": " + what);
    }

    void get(void* bytes, size_t count) {
        if (count > left_) fail("the film ends too early: it is damaged");
        in_.read(static_cast<char*>(bytes), std::streamsize(count));
        if (!in_) fail("cannot be read to its end");
        left_ -= count;
    }

    RenderState parsed(const std::string& header, uint32_t format) const {
        const double memory = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGE_SIZE));
        // A block may compress to nothing but zeros, yet its head is there: heads bound the pixels.
        const double plausible = double(left_) / double(sizeof(BlockHead)) * double(kBlockRecords) *
                                 double(sizeof(PathFeatures) + 2 * sizeof(FilmPixel));
        try {
            return parse_film_header(header, size_t(std::min(memory, plausible)), format);
        } catch (const Error& e) {
            const std::string version = version_of_film(header), own = program_version();
            if (e.kind() != ErrorKind::scene || version.empty() || version == own)
                throw Error(e.kind(), name_ + ": " + e.what());
            throw FilmOfOtherVersion(name_ + ": a film of version " + version +
                                     ", which this version, " + own + ", cannot read: " + e.what());
        }
    }

    void read_blocks(const std::vector<Block>& blocks) {
        std::vector<std::string> stored(std::min(kBlocksAtOnce, blocks.size()));
        std::vector<char> wrong(stored.size());
        XXH64_hash_t all = 0;
        for (size_t first = 0; first < blocks.size(); first += stored.size()) {
            const size_t count = std::min(stored.size(), blocks.size() - first);
            std::vector<BlockHead> heads(count);
            for (size_t i = 0; i < count; ++i) {
                get(&heads[i], sizeof(BlockHead));
                if (heads[i].raw_size != blocks[first + i].raw_size() ||
                    heads[i].stored_size > ZSTD_compressBound(heads[i].raw_size))
                    fail("a block has a size that cannot be: the film is damaged");
                stored[i].resize(heads[i].stored_size);
                get(stored[i].data(), stored[i].size());
                all = XXH3_64bits_withSeed(&heads[i].hash, sizeof heads[i].hash, all);
            }
            parallel_for(int64_t(count), [&](int64_t i) {
                wrong[size_t(i)] =
                    !expand(stored[size_t(i)], heads[size_t(i)].hash, blocks[first + size_t(i)]);
            });
            if (std::find(wrong.begin(), wrong.begin() + long(count), 1) !=
                wrong.begin() + long(count))
                fail("the checksum of a block is wrong: the film is damaged");
        }
        std::array<char, 8> end{};
        XXH64_hash_t expected = 0;
        get(end.data(), end.size());
        get(&expected, sizeof expected);
        if (end != kEnd || (kChecksums && expected != all) || left_ != 0)
            fail("its end is wrong: the film is damaged");
    }

    static bool expand(const std::string& stored, uint64_t hash, const Block& block) {
        if (kChecksums && XXH3_64bits(stored.data(), stored.size()) != hash) return false;
        const auto raw = std::make_unique_for_overwrite<uint8_t[]>(block.raw_size());
        if (ZSTD_decompress(raw.get(), block.raw_size(), stored.data(), stored.size()) !=
            block.raw_size())
            return false;
        unshuffle(raw.get(), block);
        return true;
    }

    const std::string& name_;
    std::istream& in_;
    uint64_t left_;
};

}  // namespace

fs::path earlier_film(const fs::path& file) {
    fs::path earlier = OutputFile::resolved(file);
    earlier += ".prev";
    return earlier;
}

void write_film(const RenderState& state, const fs::path& file) {
    OutputFile out(file);
    const auto put = [&out](const auto& value) { out.write(&value, sizeof value); };
    const std::string header = film_header(state);
    put(kMagic);
    put(kFilmFormat);
    put(uint32_t(header.size()));
    put(uint64_t(XXH3_64bits(header.data(), header.size())));
    out.write(header.data(), header.size());

    const std::vector<Block> blocks = blocks_of(film_arrays(const_cast<RenderState&>(state)));
    XXH64_hash_t all = 0;
    for (size_t first = 0; first < blocks.size(); first += kBlocksAtOnce) {
        const size_t count = std::min(kBlocksAtOnce, blocks.size() - first);
        std::vector<std::string> stored(count);
        parallel_for(int64_t(count),
                     [&](int64_t i) { stored[size_t(i)] = compressed(blocks[first + size_t(i)]); });
        for (size_t i = 0; i < count; ++i) {
            const BlockHead head{uint32_t(stored[i].size()), uint32_t(blocks[first + i].raw_size()),
                                 XXH3_64bits(stored[i].data(), stored[i].size())};
            put(head);
            out.write(stored[i].data(), stored[i].size());
            all = XXH3_64bits_withSeed(&head.hash, sizeof head.hash, all);
        }
    }
    put(kEnd);
    put(uint64_t(all));
    out.commit(earlier_film(file));
}

bool is_film(const fs::path& file) {
    std::array<char, 8> magic{};
    if (!irregular_kind(file).empty()) return false;
    std::ifstream in(file, std::ios::binary);
    return in.read(magic.data(), magic.size()) && magic == kMagic;
}

RenderState read_film(std::istream& in, uint64_t size, const std::string& name) {
    try {
        return FilmReader(in, size, name).read();
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::limit, name + ": not enough memory for the film");
    }
}

RenderState read_film(const fs::path& file) {
    const auto fail = [&file](const std::string& why) {
        throw Error(ErrorKind::scene, file.string() + ": " + why);
    };
    const std::string kind = irregular_kind(file);
    if (!kind.empty()) fail("it is " + kind + "; expected a film file");
    std::ifstream in(file, std::ios::binary);
    if (!in) fail(std::generic_category().message(errno));
    std::error_code error;
    const uint64_t size = fs::file_size(file, error);
    if (error) fail(error.message());
    return read_film(in, size, file.string());
}

FoundFilm find_film(const fs::path& file) {
    const fs::path earlier = earlier_film(file);
    std::error_code ignored;
    const bool has_earlier = fs::exists(earlier, ignored);
    if (!fs::exists(file, ignored)) {
        if (!has_earlier) return {};
        return {read_film(earlier), file.string() + ": does not exist"};
    }
    try {
        return {read_film(file), {}};
    } catch (const FilmOfOtherVersion&) {
        throw;  // the film is whole: whoever has its version goes on from it
    } catch (const Error& e) {
        if (e.kind() != ErrorKind::scene || !has_earlier) throw;
        return {read_film(earlier), e.what()};
    }
}

fs::path set_aside(const fs::path& file) {
    const fs::path target = OutputFile::resolved(file);  // a link stays a link
    fs::path damaged = target;
    damaged += ".damaged";
    std::error_code error;
    fs::rename(target, damaged, error);
    if (error)
        throw Error(ErrorKind::io, "cannot set the damaged film '" + file.string() +
                                       "' aside: " + error.message());
    return damaged;
}

void remove_leftovers(const fs::path& file) {
    const fs::path target = OutputFile::resolved(file);
    const std::string newer = target.filename().string();
    const std::string older = earlier_film(file).filename().string();
    const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
        const std::string name = entry.path().filename().string();
        if (OutputFile::is_leftover(name, newer) || OutputFile::is_leftover(name, older))
            fs::remove(entry.path(), ignored);
    }
}

}  // namespace covtrace
