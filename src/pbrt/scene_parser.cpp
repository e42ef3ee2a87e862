#include "pbrt/scene_parser.h"

#include <functional>
#include <unordered_map>

#include "pbrt/parameter_parser.h"
#include "pbrt/version_three.h"
#include "scene/names.h"

namespace covtrace {

namespace {

/// Part of a file in which a directive may stand.
enum class Place { anywhere, before_world, in_world };

class Parser {
  public:
    Parser(TokenStream& tokens, SceneBuilder& builder, SceneFiles& files, WarningLog& log)
        : tokens_(tokens), builder_(builder), files_(files), log_(log) {}

    void run() {
        while (tokens_.peek().kind != Token::Kind::end) directive();
    }

  private:
    struct Directive {
        Place place;
        std::function<void(Parser&)> read;
    };
    static const std::unordered_map<std::string_view, Directive>& directives();

    void directive() {
        const Token token = tokens_.next();
        where_ = token.where();
        if (token.kind != Token::Kind::word)
            throw Error(ErrorKind::scene, where_,
                        "expected a directive, found " + in_quotes(token.text));
        const auto it = directives().find(token.text);
        if (it == directives().end()) {
            std::vector<std::string> known;
            for (const auto& [name, d] : directives()) known.emplace_back(name);
            const std::string name(token.text);
            if (is_version_three_name("directive", name))
                throw version_three_error(where_, in_quotes(name));
            throw Error(ErrorKind::scene, where_,
                        "unknown directive " + in_quotes(name) + did_you_mean(name, known));
        }
        if (it->second.place == Place::before_world && builder_.in_world())
            throw Error(ErrorKind::scene, where_,
                        token.text == "WorldBegin"
                            ? "a second WorldBegin; a scene has one"
                            : std::string(token.text) + " must stand before WorldBegin");
        if (it->second.place == Place::in_world && !builder_.in_world())
            throw Error(ErrorKind::scene, where_,
                        std::string(token.text) + " must stand after WorldBegin");
        builder_.begin_directive();
        it->second.read(*this);
    }

    /// Reads an entity: type and parameters. Those of `Attribute "target"` come after the
    /// directive's own.
    Entity entity(const char* attributes = nullptr) {
        Entity e;
        e.where = where_;
        e.directive = builder_.directive();
        e.type = tokens_.expect_string("a type in quotes");
        e.parameters = parameters(attributes);
        return e;
    }
    ParameterList parameters(const char* attributes) {
        const GraphicsState& state = builder_.state();
        return {parse_parameters(tokens_, state.colour_space),
                attributes ? state.attributes.at(attributes) : InheritedParameters()};
    }
    std::string name() { return tokens_.expect_string("a name in quotes"); }
    template <size_t N>
    std::array<double, N> numbers() {
        std::array<double, N> v;
        for (double& x : v) x = tokens_.expect_number("a number");
        return v;
    }
    CurrentTransform matrix() {
        tokens_.expect(Token::Kind::open_bracket, "[ before the 16 numbers of a matrix");
        const auto v = numbers<16>();
        tokens_.expect(Token::Kind::close_bracket, "] after the 16 numbers of a matrix");
        return transform_of_matrix(v, where_);
    }
    static Vec3 vector(double x, double y, double z) {
        return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
    }

    void translate() {
        const auto v = numbers<3>();
        builder_.state().concatenate(Transform::translate(vector(v[0], v[1], v[2])), where_);
    }
    void rotate() {
        const auto v = numbers<4>();
        builder_.state().concatenate(transform_of_rotation(v[0], vector(v[1], v[2], v[3]), where_),
                                     where_);
    }
    void scale() {
        const auto v = numbers<3>();
        builder_.state().concatenate(transform_of_scale(v[0], v[1], v[2], where_), where_);
    }
    void look_at() {
        const auto v = numbers<9>();
        builder_.state().concatenate(
            transform_of_look_at(vector(v[0], v[1], v[2]), vector(v[3], v[4], v[5]),
                                 vector(v[6], v[7], v[8]), where_),
            where_);
    }

    void active_transform() {
        const Token t = tokens_.next();
        auto& active = builder_.state().active;
        if (t.text == "All") {
            active = {true, true};
        } else if (t.text == "StartTime") {
            active = {true, false};
        } else if (t.text == "EndTime") {
            active = {false, true};
        } else {
            throw Error(ErrorKind::scene, t.where(),
                        unknown_name("active transform", t.text, {"StartTime", "EndTime", "All"}));
        }
    }
    void transform_times() {
        const auto v = numbers<2>();
        if (!(v[0] < v[1]))
            throw Error(ErrorKind::scene, where_, "TransformTimes expects a start before the end");
        builder_.state().start_time = static_cast<float>(v[0]);
        builder_.state().end_time = static_cast<float>(v[1]);
    }

    void colour_space() {
        const std::string n = name();
        const auto space = colour_space_named(n);
        if (!space)
            throw Error(ErrorKind::scene, where_,
                        unknown_name("colour space", n, colour_space_names()));
        builder_.state().colour_space = *space;
    }

    void option() {
        static const std::vector<std::string> known{"disablepixeljitter",
                                                    "disabletexturefiltering",
                                                    "disablewavelengthjitter",
                                                    "displacementedgescale",
                                                    "forcediffuse",
                                                    "msereferenceimage",
                                                    "msereferenceout",
                                                    "pixelstats",
                                                    "rendercoordsys",
                                                    "seed",
                                                    "wavefront"};
        const std::string n = name();
        if (const size_t space = n.find(' '); space != std::string::npos)
            throw Error(ErrorKind::scene, where_,
                        "option " + in_quotes(n) + " has a type; expected its name alone, " +
                            in_quotes(n.substr(space + 1)));
        const Token value = tokens_.next();
        if (value.kind != Token::Kind::word && value.kind != Token::Kind::string)
            throw Error(ErrorKind::scene, value.where(),
                        "option " + in_quotes(n) + " has no value");
        // Option names are compared without case and separators, which pbrt disregards.
        std::string plain;
        for (const char c : n)
            if (c != '_' && c != '-')
                plain += static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
        if (std::find(known.begin(), known.end(), plain) == known.end())
            throw Error(ErrorKind::scene, where_, unknown_name("option", n, known));
        if (plain == "displacementedgescale") {
            const double scale = parse_number(value);
            if (!(scale > 0))
                throw Error(ErrorKind::scene, value.where(),
                            "option " + in_quotes(n) + " must be greater than 0");
            builder_.scale_displacement_edges(static_cast<float>(scale));
            return;
        }
        // Colours here have no noise of wavelengths that could be the same in each pixel.
        const bool changes_nothing = value.text == "false" || plain == "rendercoordsys" ||
                                     plain == "wavefront" || plain == "disablewavelengthjitter";
        if (!changes_nothing) log_.add(where_, "option " + in_quotes(n) + " is ignored");
    }

    void medium_interface() {
        GraphicsState& state = builder_.state();
        state.inside_medium = name();
        state.outside_medium = tokens_.peek().kind == Token::Kind::string
                                   ? std::string(tokens_.next().text)
                                   : state.inside_medium;
    }

    void named_material() {
        std::string n = name();
        Entity e{{}, parameters("material"), where_, builder_.directive()};
        builder_.named_material(std::move(n), std::move(e));
    }
    void named_medium() {
        std::string n = name();
        Entity e{{}, parameters("medium"), where_, builder_.directive()};
        builder_.medium(std::move(n), std::move(e));
    }

    void texture() {
        std::string n = name();
        const std::string kind = tokens_.expect_string("\"float\" or \"spectrum\"");
        if (kind != "float" && kind != "spectrum")
            throw unknown_type_error(where_, "texture", kind, {"float", "spectrum"});
        builder_.texture(std::move(n), kind == "spectrum", entity("texture"));
    }

    void attribute() {
        const std::string target = tokens_.expect_string("an attribute target in quotes");
        builder_.attribute(target, parse_parameters(tokens_, builder_.state().colour_space),
                           where_);
    }

    void import() {
        const std::string file = tokens_.expect_string("a quoted file name after Import");
        builder_.import_begin(where_);
        TokenStream inner(file, where_, files_, tokens_.open_files());
        parse_directives(inner, builder_, files_, log_);
        builder_.import_end();
    }

    TokenStream& tokens_;
    SceneBuilder& builder_;
    SceneFiles& files_;
    WarningLog& log_;
    SourceLocation where_;  ///< place of the current directive
};

const std::unordered_map<std::string_view, Parser::Directive>& Parser::directives() {
    using enum Place;
    using P = Parser;
    static const std::unordered_map<std::string_view, Directive> all{
        {"Accelerator", {before_world, [](P& p) { p.builder_.accelerator(p.entity()); }}},
        {"ActiveTransform", {anywhere, &P::active_transform}},
        {"AreaLightSource", {in_world, [](P& p) { p.builder_.area_light(p.entity("light")); }}},
        {"Attribute", {anywhere, &P::attribute}},
        {"AttributeBegin", {in_world, [](P& p) { p.builder_.attribute_begin(p.where_); }}},
        {"AttributeEnd", {in_world, [](P& p) { p.builder_.attribute_end(p.where_); }}},
        {"Camera", {before_world, [](P& p) { p.builder_.camera(p.entity()); }}},
        {"ColorSpace", {anywhere, &P::colour_space}},
        {"ConcatTransform",
         {anywhere, [](P& p) { p.builder_.state().concatenate(p.matrix(), p.where_); }}},
        {"CoordSysTransform",
         {anywhere, [](P& p) { p.builder_.use_coordinate_system(p.name(), p.where_); }}},
        {"CoordinateSystem", {anywhere, [](P& p) { p.builder_.coordinate_system(p.name()); }}},
        {"Film", {before_world, [](P& p) { p.builder_.film(p.entity()); }}},
        {"Identity", {anywhere, [](P& p) { p.builder_.state().replace(Transform()); }}},
        {"Import", {in_world, &P::import}},
        {"Integrator", {before_world, [](P& p) { p.builder_.integrator(p.entity()); }}},
        {"LightSource", {in_world, [](P& p) { p.builder_.light(p.entity("light")); }}},
        {"LookAt", {anywhere, &P::look_at}},
        {"MakeNamedMaterial", {in_world, &P::named_material}},
        {"MakeNamedMedium", {anywhere, &P::named_medium}},
        {"Material", {in_world, [](P& p) { p.builder_.material(p.entity("material")); }}},
        {"MediumInterface", {anywhere, &P::medium_interface}},
        {"NamedMaterial",
         {in_world, [](P& p) { p.builder_.use_named_material(p.name(), p.where_); }}},
        {"ObjectBegin", {in_world, [](P& p) { p.builder_.object_begin(p.name(), p.where_); }}},
        {"ObjectEnd", {in_world, [](P& p) { p.builder_.object_end(p.where_); }}},
        {"ObjectInstance",
         {in_world, [](P& p) { p.builder_.object_instance(p.name(), p.where_); }}},
        {"Option", {anywhere, &P::option}},
        {"PixelFilter", {before_world, [](P& p) { p.builder_.filter(p.entity()); }}},
        {"ReverseOrientation",
         {in_world,
          [](P& p) {
              bool& reversed = p.builder_.state().reverse_orientation;
              reversed = !reversed;
          }}},
        {"Rotate", {anywhere, &P::rotate}},
        {"Sampler", {before_world, [](P& p) { p.builder_.sampler(p.entity()); }}},
        {"Scale", {anywhere, &P::scale}},
        {"Shape", {in_world, [](P& p) { p.builder_.shape(p.entity("shape")); }}},
        {"Texture", {in_world, &P::texture}},
        {"Transform", {anywhere, [](P& p) { p.builder_.state().replace(p.matrix()); }}},
        {"TransformBegin", {in_world, [](P& p) { p.builder_.attribute_begin(p.where_); }}},
        {"TransformEnd", {in_world, [](P& p) { p.builder_.attribute_end(p.where_); }}},
        {"TransformTimes", {before_world, &P::transform_times}},
        {"Translate", {anywhere, &P::translate}},
        {"WorldBegin", {before_world, [](P& p) { p.builder_.world_begin(); }}},
    };
    return all;
}

}  // namespace

void parse_directives(TokenStream& tokens, SceneBuilder& builder, SceneFiles& files,
                      WarningLog& log) {
    Parser(tokens, builder, files, log).run();
}

}  // namespace covtrace
