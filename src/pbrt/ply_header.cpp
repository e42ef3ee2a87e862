#include "pbrt/ply_header.h"

#include <array>
#include <charconv>
#include <optional>
#include <utility>

#include "scene/names.h"

namespace covtrace {

namespace {

std::optional<PlyNumber> number_named(std::string_view name) {
    using enum PlyNumber;
    constexpr std::array<std::pair<std::string_view, PlyNumber>, 16> known{{{"char", int8},
                                                                            {"int8", int8},
                                                                            {"uchar", uint8},
                                                                            {"uint8", uint8},
                                                                            {"short", int16},
                                                                            {"int16", int16},
                                                                            {"ushort", uint16},
                                                                            {"uint16", uint16},
                                                                            {"int", int32},
                                                                            {"int32", int32},
                                                                            {"uint", uint32},
                                                                            {"uint32", uint32},
                                                                            {"float", float32},
                                                                            {"float32", float32},
                                                                            {"double", float64},
                                                                            {"float64", float64}}};
    for (const auto& [n, type] : known)
        if (n == name) return type;
    return std::nullopt;
}

std::vector<std::string_view> words(std::string_view line) {
    constexpr std::string_view blanks = " \t\r";
    std::vector<std::string_view> all;
    for (;;) {
        const size_t start = line.find_first_not_of(blanks);
        if (start == std::string_view::npos) return all;
        line.remove_prefix(start);
        const size_t length = std::min(line.find_first_of(blanks), line.size());
        all.push_back(line.substr(0, length));
        line.remove_prefix(length);
    }
}

class HeaderParser {
  public:
    HeaderParser(std::string_view bytes, std::shared_ptr<const std::string> file)
        : bytes_(bytes), file_(std::move(file)) {}

    PlyHeader parse() {
        if (words(line()) != std::vector<std::string_view>{"ply"})
            refuse("not a PLY file; expected a first line \"ply\"", line_);
        bool has_format = false;
        for (;;) {
            const std::string_view text = line();
            const auto w = words(text);
            if (w.empty() || w[0] == "comment" || w[0] == "obj_info") continue;
            if (w[0] == "end_header") break;
            if (w[0] == "format") {
                set_format(w);
                has_format = true;
            } else if (w[0] == "element") {
                add_element(w);
            } else if (w[0] == "property") {
                add_property(w);
            } else {
                refuse("unknown line " + in_quotes(text) +
                           " in the header of a PLY file; expected \"comment\", \"element\", "
                           "\"property\" or \"end_header\"",
                       w[0]);
            }
        }
        if (!has_format)
            refuse("the header of the PLY file ends without a line \"format\"; expected one before",
                   line_);
        header_.size = position_;
        header_.lines = line_number_;
        return std::move(header_);
    }

  private:
    /// The place of a part of the present line.
    SourceLocation where(std::string_view part) const {
        return {file_, line_number_, int(part.data() - line_.data()) + 1};
    }
    [[noreturn]] void refuse(const std::string& text, std::string_view at) const {
        throw Error(ErrorKind::scene, where(at), text);
    }

    std::string_view line() {
        const size_t end = bytes_.find('\n', position_);
        ++line_number_;
        line_ = bytes_.substr(position_, end - position_);
        if (end == std::string_view::npos)
            refuse("the PLY file ends in its header; expected \"end_header\"",
                   line_.substr(line_.size()));
        position_ = end + 1;
        return line_;
    }

    void set_format(const std::vector<std::string_view>& w) {
        using enum PlyHeader::Format;
        if (w.size() != 3 || w[2] != "1.0")
            refuse("expected \"format\", its name, and version 1.0", w.size() < 3 ? w[0] : w[2]);
        if (w[1] == "ascii") {
            header_.format = ascii;
        } else if (w[1] == "binary_little_endian") {
            header_.format = little_endian;
        } else if (w[1] == "binary_big_endian") {
            header_.format = big_endian;
        } else {
            refuse(unknown_name("PLY format", w[1],
                                {"ascii", "binary_little_endian", "binary_big_endian"}),
                   w[1]);
        }
    }

    void add_element(const std::vector<std::string_view>& w) {
        PlyElement e;
        // A count beyond 64 bits is also read to its end and leaves 0: only the error of from_chars
        // tells it from a count of 0.
        const std::string_view count = w.size() == 3 ? w[2] : std::string_view{};
        const char* end = count.data() + count.size();
        const auto [rest, error] = std::from_chars(count.data(), end, e.count);
        if (error != std::errc{} || rest != end)
            refuse("expected \"element\", its name, and a count >= 0", w.size() == 3 ? w[2] : w[0]);
        e.name = w[1];
        e.where = where(w[0]);
        header_.elements.push_back(std::move(e));
    }

    void add_property(const std::vector<std::string_view>& w) {
        if (header_.elements.empty())
            refuse("a property stands before the first element; expected \"element\"", w[0]);
        PlyProperty p;
        p.is_list = w.size() > 1 && w[1] == "list";
        if (w.size() != (p.is_list ? 5u : 3u))
            refuse("expected \"property type name\" or \"property list type type name\"", w[0]);
        p.name = w.back();
        p.type = number(w[w.size() - 2]);
        if (p.is_list) {
            p.count_type = number(w[2]);
            if (p.count_type == PlyNumber::float32 || p.count_type == PlyNumber::float64)
                refuse("the length of a list is " + in_quotes(w[2]) + "; expected an integer type",
                       w[2]);
        }
        header_.elements.back().properties.push_back(std::move(p));
    }

    PlyNumber number(std::string_view name) const {
        const auto type = number_named(name);
        if (!type)
            refuse(unknown_name(
                       "number type", name,
                       {"char", "uchar", "short", "ushort", "int", "uint", "float", "double"}),
                   name);
        return *type;
    }

    std::string_view bytes_, line_;
    std::shared_ptr<const std::string> file_;
    size_t position_ = 0;
    int line_number_ = 0;
    PlyHeader header_;
};

}  // namespace

size_t size_of(PlyNumber type) {
    constexpr std::array<size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[static_cast<size_t>(type)];
}

uint64_t PlyElement::smallest_size(bool ascii) const {
    // A number in ascii takes at least a digit and a blank. The file's last number may lack the
    // blank, for which callers allow one character.
    uint64_t sum = 0;
    for (const PlyProperty& p : properties)
        sum += ascii ? 2 : size_of(p.is_list ? p.count_type : p.type);
    return sum;
}

PlyHeader read_ply_header(std::string_view bytes, const std::shared_ptr<const std::string>& file) {
    return HeaderParser(bytes, file).parse();
}

}  // namespace covtrace
