#include "render/film_header.h"

#include <algorithm>
#include <concepts>
#include <nlohmann/json.hpp>
#include <utility>

#include "render/film_arrays.h"
#include "render/film_format3.h"

namespace covtrace {

namespace {

using nlohmann::json;

json to_json(const PixelBounds& b) {
    return {b.x0, b.y0, b.x1, b.y1};
}
json to_json(const Metadata& metadata) {
    json object = json::object();
    for (const auto& [name, value] : metadata)
        std::visit([&, &key = name](const auto& v) { object[key] = v; }, value);
    return object;
}
json to_json(const std::optional<double>& v) {
    return v ? json(*v) : json(nullptr);
}

[[noreturn]] void refuse(const std::string& what) {
    throw Error(ErrorKind::scene, "the header of the film is wrong: " + what);
}

/// Reads an integer and refuses one that does not fit: the JSON library would cut it.
template <std::integral Integer>
Integer integer(const json& j) {
    if (j.is_number_unsigned() && std::in_range<Integer>(j.get<uint64_t>()))
        return static_cast<Integer>(j.get<uint64_t>());
    if (j.is_number_integer() && !j.is_number_unsigned() &&
        std::in_range<Integer>(j.get<int64_t>()))
        return static_cast<Integer>(j.get<int64_t>());
    refuse(j.is_number() ? "the integer " + j.dump()
                         : "no integer, but " + std::string(j.type_name()));
}

PixelBounds bounds(const json& j) {
    constexpr int kMost = 1 << 24;  // pixels a side
    const auto side = [&](size_t i) { return integer<int>(j.at(i)); };
    const PixelBounds b{side(0), side(1), side(2), side(3)};
    for (int v : {b.x0, b.y0, b.x1, b.y1})
        if (v < -kMost || v > kMost) refuse("a window of " + j.dump());
    if (b.empty()) refuse("an empty window");
    return b;
}

Metadata metadata(const json& j) {
    Metadata m;
    for (const auto& [name, value] : j.items()) {
        if (value.is_number_integer())
            m[name] = integer<int>(value);
        else if (value.is_number_float())
            m[name] = value.get<float>();
        else if (value.is_string())
            m[name] = value.get<std::string>();
        else
            m[name] = value.get<std::vector<float>>();
    }
    return m;
}

std::optional<double> number(const json& j) {
    return j.is_null() ? std::nullopt : std::optional(j.get<double>());
}

/// Reads the value of an enum by its name. Messages call it `what`.
template <NamedEnum Enum>
Enum named(const json& j, const char* what) {
    const auto name = j.get<std::string>();
    if (const auto value = value_named<Enum>(name)) return *value;
    refuse(std::string("the ") + what + " '" + name + "'");
}

/// Adds all arrays that the header names to a state.
void add_arrays(RenderState& s, const json& arrays, uint32_t format) {
    const auto has = [&](const std::string& name) {
        return std::any_of(arrays.begin(), arrays.end(),
                           [&](const json& a) { return a.at("name") == name; });
    };
    FilmParts kept = film_parts(s.method);
    if (s.method == Method::uniform) {
        kept.in_view = has("film0.in_view");
        kept.features = has("film0.features");
    }
    kept.surfaces = has("film0.surfaces");
    kept.opacity = has("film0.opacity");
    for (size_t k = 0; k < (s.method == Method::hybrid ? 2 : 1); ++k) {
        s.films.emplace_back(s.region, kept);
        if (format == 3) s.films.back().features = {};
        if (has("film0.plan")) s.plan.emplace_back(s.pixels());
    }
    if (s.method == Method::hybrid && s.stage == Stage::rounds)
        s.covariances = std::vector<PackedCovariance>(s.pixels());
    else if (s.method != Method::uniform)
        s.covariances = CovarianceBuffers(s.region.width(), s.region.height());
    if (has("density")) s.density.resize(s.pixels());
}

/// Bytes that every pixel needs. Refuses arrays that are not those of the method and stage.
size_t bytes_per_pixel(RenderState s, const json& arrays, uint32_t format) {
    s.region = {0, 0, 1, 1};
    add_arrays(s, arrays, format);
    const std::vector<FilmArray> expected = format == 3 ? FilmFormat3(s).arrays() : film_arrays(s);
    bool agree = expected.size() == arrays.size();
    size_t sum = 0;
    for (size_t i = 0; agree && i < expected.size(); ++i) {
        agree = arrays[i].at("name") == expected[i].name &&
                arrays[i].at("record") == expected[i].record_size;
        sum += expected[i].record_size;
    }
    if (!agree) refuse("its arrays are not those of its method and stage");
    return sum;
}

/// Refuses a list of shards that is wrong: each must be there once, in order, and none where the
/// film has all pixels.
void check_shards(const RenderState& s) {
    if (s.shards < 1) refuse("the number of shards");
    if (s.present.empty() != (s.shards == 1)) refuse("the shards");
    int last = -1;
    for (int k : s.present) {
        if (k <= last || k >= s.shards) refuse("the shards");
        last = k;
    }
}

RenderState parse(const json& j, size_t most_bytes, uint32_t format) {
    RenderState s;
    s.identity = j.at("identity").get<RenderIdentity>();
    s.method = named<Method>(j.at("method"), "method");
    s.filter = named<FilterRule>(j.at("filter"), "filter");
    s.region = bounds(j.at("region"));
    s.display = bounds(j.at("display"));
    s.has_holes = j.at("has_holes");
    s.metadata = metadata(j.at("metadata"));
    s.stage = named<Stage>(j.at("stage"), "stage");
    s.covariance_spp = j.at("covariance_spp");
    s.weight_limit = number(j.at("weight_limit"));
    s.taken = j.at("taken");
    s.target = j.at("target");
    s.spp = number(j.at("spp"));
    s.complete = j.at("complete");
    s.seconds = j.at("seconds");
    s.seconds_spp = j.at("seconds_spp");
    const json& goal = j.at("error_goal");
    s.goal = {goal.at(0), goal.at(1), goal.at(2)};
    s.rejected = integer<decltype(s.rejected)>(j.at("rejected"));
    for (const json& r : j.at("first_rejected"))
        s.first_rejected.push_back({integer<int>(r.at(0)), integer<int>(r.at(1)),
                                    integer<decltype(RejectedSample::sample)>(r.at(2))});
    s.shards = integer<int>(j.at("shards"));
    for (const json& k : j.at("present")) s.present.push_back(integer<int>(k));
    if (s.method == Method::uniform && s.stage != Stage::rounds) refuse("a stage of 'uniform'");
    check_shards(s);

    const json& arrays = j.at("arrays");
    if (bytes_per_pixel(s, arrays, format) > most_bytes / s.pixels())
        throw Error(ErrorKind::limit, "not enough memory for a film of " +
                                          std::to_string(s.region.width()) + "x" +
                                          std::to_string(s.region.height()) + " pixels");
    add_arrays(s, arrays, format);
    return s;
}

}  // namespace

std::string film_header(const RenderState& s) {
    json arrays = json::array(), rejected = json::array();
    for (const FilmArray& a : film_arrays(const_cast<RenderState&>(s)))
        arrays.push_back({{"name", a.name}, {"record", a.record_size}});
    for (const RejectedSample& r : s.first_rejected) rejected.push_back({r.x, r.y, r.sample});
    const json j{{"identity", s.identity},
                 {"method", name_of(s.method)},
                 {"filter", name_of(s.filter)},
                 {"region", to_json(s.region)},
                 {"display", to_json(s.display)},
                 {"has_holes", s.has_holes},
                 {"metadata", to_json(s.metadata)},
                 {"stage", name_of(s.stage)},
                 {"covariance_spp", s.covariance_spp},
                 {"weight_limit", to_json(s.weight_limit)},
                 {"taken", s.taken},
                 {"target", s.target},
                 {"spp", to_json(s.spp)},
                 {"complete", s.complete},
                 {"seconds", s.seconds},
                 {"seconds_spp", s.seconds_spp},
                 {"error_goal", {s.goal.taken, s.goal.error, s.goal.power}},
                 {"rejected", s.rejected},
                 {"first_rejected", rejected},
                 {"shards", s.shards},
                 {"present", s.present},
                 {"arrays", arrays}};
    return j.dump(1);
}

std::string version_of_film(const std::string& header) {
    const json j = json::parse(header, nullptr, false);
    if (!j.is_object() || !j.contains("identity")) return {};
    const json& identity = j["identity"];
    if (!identity.is_object() || !identity.contains("version")) return {};
    return identity["version"].is_string() ? identity["version"].get<std::string>() : "";
}

RenderState parse_film_header(const std::string& text, size_t most_bytes, uint32_t format) {
    try {
        return parse(json::parse(text), most_bytes, format);
    } catch (const json::exception& e) {
        refuse(e.what());
    }
}

}  // namespace covtrace
