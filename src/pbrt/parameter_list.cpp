#include "pbrt/parameter_list.h"

#include <algorithm>
#include <unordered_map>

#include "scene/names.h"
#include "scene/warning_log.h"

namespace covtrace {

namespace {

std::string type_name(ParameterType t) {
    switch (t) {
        case ParameterType::floats:
            return "float";
        case ParameterType::integer:
            return "integer";
        case ParameterType::boolean:
            return "bool";
        case ParameterType::string:
            return "string";
        case ParameterType::point2:
            return "point2";
        case ParameterType::vector2:
            return "vector2";
        case ParameterType::point3:
            return "point3";
        case ParameterType::vector3:
            return "vector3";
        case ParameterType::normal3:
            return "normal";
        case ParameterType::rgb:
            return "rgb";
        case ParameterType::blackbody:
            return "blackbody";
        case ParameterType::spectrum:
            return "spectrum";
        case ParameterType::texture:
            return "texture";
    }
    return {};
}

[[noreturn]] void wrong_count(const Parameter& p, size_t count, const std::string& expected) {
    throw Error(ErrorKind::scene, p.where,
                "parameter " + in_quotes(p.name) + " has " + std::to_string(count) +
                    " values; expected " + expected);
}

void expect_one(const Parameter& p, size_t count) {
    if (count != 1) wrong_count(p, count, "one");
}

void expect_multiple(const Parameter& p, size_t n) {
    if (p.numbers.size() % n != 0)
        wrong_count(p, p.numbers.size(), "a multiple of " + std::to_string(n));
}

}  // namespace

ParameterList::ParameterList(std::vector<Parameter> own, InheritedParameters inherited)
    : own_(std::move(own)), inherited_(std::move(inherited)) {}

const Parameter* ParameterList::last(std::string_view name) const {
    for (auto it = own_.rbegin(); it != own_.rend(); ++it)
        if (it->name == name) return &*it;
    return inherited_.find(name);
}

const Parameter* ParameterList::find(std::string_view name,
                                     std::initializer_list<ParameterType> types) {
    for (auto p = own_.rbegin(); p != own_.rend(); ++p) {
        if (p->name != name) continue;
        if (std::find(types.begin(), types.end(), p->type) != types.end()) {
            p->looked_up = true;
            return &*p;
        }
        std::string expected;
        for (const ParameterType t : types)
            expected += (expected.empty() ? "" : " or ") + type_name(t);
        throw Error(ErrorKind::scene, p->where,
                    "parameter " + in_quotes(p->name) + " has the type " + type_name(p->type) +
                        "; expected " + expected);
    }
    // An `Attribute` is for all directives of its kind, of which others may take another type.
    return inherited_.find(name, types);
}

bool ParameterList::has(std::string_view name) const {
    return last(name) != nullptr;
}

std::optional<float> ParameterList::number(std::string_view name) {
    const Parameter* p = find(name, {ParameterType::floats});
    if (!p) return std::nullopt;
    expect_one(*p, p->numbers.size());
    return p->numbers[0];
}

float ParameterList::number(std::string_view name, float otherwise) {
    return number(name).value_or(otherwise);
}

int ParameterList::integer(std::string_view name, int otherwise) {
    const Parameter* p = find(name, {ParameterType::integer});
    if (!p) return otherwise;
    expect_one(*p, p->integers.size());
    return p->integers[0];
}

bool ParameterList::flag(std::string_view name, bool otherwise) {
    const Parameter* p = find(name, {ParameterType::boolean});
    if (!p) return otherwise;
    expect_one(*p, p->integers.size());
    return p->integers[0] != 0;
}

std::string ParameterList::text(std::string_view name, std::string otherwise) {
    const Parameter* p = find(name, {ParameterType::string});
    if (!p) return otherwise;
    expect_one(*p, p->strings.size());
    return p->strings[0];
}

Vec3 ParameterList::triple(std::string_view name, Vec3 otherwise) {
    const std::vector<Vec3> all = triples(name);
    if (all.empty()) return otherwise;
    if (all.size() != 1) wrong_count(*last(name), 3 * all.size(), "three");
    return all[0];
}

std::vector<float> ParameterList::numbers(std::string_view name) {
    const Parameter* p = find(name, {ParameterType::floats});
    return p ? p->numbers : std::vector<float>{};
}

std::vector<int> ParameterList::integers(std::string_view name) {
    const Parameter* p = find(name, {ParameterType::integer});
    return p ? p->integers : std::vector<int>{};
}

std::vector<std::string> ParameterList::texts(std::string_view name) {
    const Parameter* p = find(name, {ParameterType::string});
    return p ? p->strings : std::vector<std::string>{};
}

std::vector<Vec2> ParameterList::pairs(std::string_view name) {
    const Parameter* p = find(name, {ParameterType::point2, ParameterType::vector2});
    std::vector<Vec2> all;
    if (!p) return all;
    expect_multiple(*p, 2);
    all.reserve(p->numbers.size() / 2);
    for (size_t i = 0; i < p->numbers.size(); i += 2)
        all.push_back({p->numbers[i], p->numbers[i + 1]});
    return all;
}

std::vector<Vec3> ParameterList::triples(std::string_view name) {
    const Parameter* p =
        find(name, {ParameterType::point3, ParameterType::vector3, ParameterType::normal3});
    std::vector<Vec3> all;
    if (!p) return all;
    expect_multiple(*p, 3);
    all.reserve(p->numbers.size() / 3);
    for (size_t i = 0; i < p->numbers.size(); i += 3)
        all.push_back({p->numbers[i], p->numbers[i + 1], p->numbers[i + 2]});
    return all;
}

SourceLocation ParameterList::where(std::string_view name, const SourceLocation& otherwise) const {
    const Parameter* p = last(name);
    return p ? p->where : otherwise;
}

void ParameterList::ignore(std::initializer_list<std::string_view> names) {
    for (Parameter& p : own_)
        if (std::find(names.begin(), names.end(), p.name) != names.end()) p.looked_up = true;
}

void ParameterList::ignore_all() {
    for (Parameter& p : own_) p.looked_up = true;
}

void ParameterList::warn_unused(WarningLog& log, const std::string& owner) const {
    std::unordered_map<std::string_view, size_t> last_of_name;
    for (size_t i = 0; i < own_.size(); ++i) last_of_name[own_[i].name] = i;
    for (size_t i = 0; i < own_.size(); ++i) {
        const Parameter& p = own_[i];
        if (last_of_name[p.name] != i) {
            log.add(p.where, "parameter " + in_quotes(p.name) + " of " + owner +
                                 " is given twice; the last one counts");
        } else if (!p.looked_up) {
            log.add(p.where,
                    "parameter " + in_quotes(p.name) + " is not known to " + owner + "; ignored");
        }
    }
}

Rgb rgb_value(const Parameter& p) {
    if (p.numbers.size() != 3) wrong_count(p, p.numbers.size(), "three");
    const Rgb c{p.numbers[0], p.numbers[1], p.numbers[2]};
    if (c.r < 0 || c.g < 0 || c.b < 0)
        throw Error(ErrorKind::scene, p.where,
                    "parameter " + in_quotes(p.name) +
                        " has a negative component; expected rgb values >= 0");
    return clipped_to_rec709(c, p.colour_space);
}

}  // namespace covtrace
