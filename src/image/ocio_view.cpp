#include "image/ocio_view.h"

#include <OpenColorIO/OpenColorIO.h>

#include <algorithm>
#include <array>
#include <mutex>
#include <regex>
#include <string_view>

#include "core/colour_space.h"
#include "image/read_file.h"

namespace covtrace {

namespace ocio = OCIO_NAMESPACE;

namespace {

/// The place in the config that a message of the library names; the last one, which is the nearest.
SourceLocation place_in(const std::filesystem::path& config, const std::string& message) {
    static const std::regex place(R"(line ([0-9]{1,9})(, column ([0-9]{1,9}))?)");
    SourceLocation where{std::make_shared<const std::string>(config.string())};
    for (std::sregex_iterator m(message.begin(), message.end(), place), end; m != end; ++m) {
        where.line = std::stoi((*m)[1]);
        where.column = (*m)[3].matched ? std::stoi((*m)[3]) : 0;
    }
    return where;
}

/// The message without what the library begins all of a kind with, which names the config again.
std::string without_preamble(const std::string& message) {
    constexpr std::string_view kEnd = "' failed. ";
    const size_t end = message.find(kEnd);
    return message.starts_with("Error: Loading") && end != std::string::npos
               ? message.substr(end + kEnd.size())
               : message;
}

/// Takes the library's warnings, which it would write to standard error. It has one function that
/// it gives them to, for all threads: one at a time takes them.
class WarningsTaken {
  public:
    WarningsTaken(const std::filesystem::path& config, Warnings& warnings) : alone_(mutex_) {
        ocio::SetLoggingFunction([&config, &warnings](const char* message) {
            constexpr std::string_view kWarning = "[OpenColorIO Warning]: ";
            const std::string text = message;
            if (text.starts_with(kWarning))
                warnings.push_back(
                    {place_in(config, text), one_line(text.substr(kWarning.size()))});
        });
    }
    ~WarningsTaken() { ocio::ResetToDefaultLoggingFunction(); }
    WarningsTaken(const WarningsTaken&) = delete;
    WarningsTaken& operator=(const WarningsTaken&) = delete;

  private:
    static inline std::mutex mutex_;
    const std::lock_guard<std::mutex> alone_;
};

/// The names that `name_of(i)` gives for i < count, for messages.
template <typename NameOf>
std::string listed(int count, NameOf name_of) {
    constexpr int kMost = 50;
    std::string text;
    for (int i = 0; i < std::min(count, kMost); ++i)
        text += (i ? ", '" : "'") + one_line(name_of(i)) + "'";
    if (count > kMost) text += " and " + std::to_string(count - kMost) + " more";
    return count == 0 ? "it has none" : "it has " + text;
}

/// A config and the names in it that were asked for. Functions throw Error(usage) for names that
/// the config does not have.
struct Names {
    const OcioChoice& choice;
    const ocio::ConstConfigRcPtr& config;

    [[noreturn]] void refuse(std::string_view option, const std::string& message) const {
        throw Error(ErrorKind::usage, OptionName{option}, message);
    }

    std::string file() const { return "'" + choice.config.string() + "'"; }

    std::string display() const {
        if (choice.display.empty()) {
            if (const std::string name = config->getDefaultDisplay(); !name.empty()) return name;
            throw_unreadable(choice.config, {}, "the config has no display");
        }
        if (config->getDisplayAllByName(choice.display.c_str()) >= 0) return choice.display;
        refuse("ocio_display",
               "'" + choice.display + "' is no display of " + file() + "; " +
                   listed(config->getNumDisplays(), [&](int i) { return config->getDisplay(i); }));
    }

    std::string view(const std::string& display) const {
        const char* of = display.c_str();
        if (choice.view.empty()) {
            if (const std::string name = config->getDefaultView(of); !name.empty()) return name;
            throw_unreadable(choice.config, {}, "the display '" + display + "' has no view");
        }
        const char* name = choice.view.c_str();
        if (*config->getDisplayViewColorSpaceName(of, name) ||
            *config->getDisplayViewTransformName(of, name))
            return choice.view;
        refuse("view", "'" + choice.view + "' is no view of the display '" + display + "' of " +
                           file() + "; " + listed(config->getNumViews(of), [&](int i) {
                               return config->getView(of, i);
                           }));
    }

    /// Text such as "+warm, -soft | plain" that the library takes for looks.
    const std::string& look() const {
        constexpr std::string_view kSpace = " \t\r\n";
        const std::string& all = choice.look;
        for (size_t begin = 0; begin < all.size();) {
            const size_t end = std::min(all.find_first_of(",:|", begin), all.size());
            std::string_view name = std::string_view(all).substr(begin, end - begin);
            begin = end + 1;
            name.remove_prefix(std::min(name.find_first_not_of(kSpace), name.size()));
            name = name.substr(0, name.find_last_not_of(kSpace) + 1);
            if (name.starts_with('+') || name.starts_with('-')) name.remove_prefix(1);
            const std::string text(name);
            if (text.empty() || !config->getLook(text.c_str()))
                refuse("ocio_look", "'" + text + "' is no look of " + file() + "; " +
                                        listed(config->getNumLooks(), [&](int i) {
                                            return config->getLookNameByIndex(i);
                                        }));
        }
        return all;
    }

    bool has_space(const std::string& name) const {
        return config->getColorSpace(name.c_str()) != nullptr;
    }

    std::string spaces() const {
        return listed(config->getNumColorSpaces(),
                      [&](int i) { return config->getColorSpaceNameByIndex(i); });
    }

    bool is_tied_to_aces() const {
        return choice.source.empty() && has_space(ocio::ROLE_INTERCHANGE_SCENE);
    }

    std::string source() const {
        if (choice.source.empty()) {
            if (has_space(ocio::ROLE_SCENE_LINEAR)) return ocio::ROLE_SCENE_LINEAR;
            if (is_tied_to_aces()) return ocio::ROLE_INTERCHANGE_SCENE;
            refuse("ocio_source",
                   file() +
                       " has no role scene_linear; expected the name of the colour space "
                       "instead that renders are in; " +
                       spaces());
        }
        if (has_space(choice.source)) return choice.source;
        refuse("ocio_source",
               "'" + choice.source + "' is no colour space of " + file() + "; " + spaces());
    }
};

ocio::TransformRcPtr aces_from_rec709() {
    const auto matrix = ocio::MatrixTransform::Create();
    std::array<double, 16> m{};
    const std::array<Rgb, 3> columns{to_rec709({1, 0, 0}, ColourSpace::aces2065_1),
                                     to_rec709({0, 1, 0}, ColourSpace::aces2065_1),
                                     to_rec709({0, 0, 1}, ColourSpace::aces2065_1)};
    for (size_t j = 0; j < 3; ++j) {
        m[j] = double(columns[j].r);
        m[4 + j] = double(columns[j].g);
        m[8 + j] = double(columns[j].b);
    }
    m[15] = 1;
    matrix->setMatrix(m.data());
    matrix->setDirection(ocio::TRANSFORM_DIR_INVERSE);
    return matrix;
}

/// All that happens to a colour, in order.
ocio::ConstTransformRcPtr transform_of(const Names& names) {
    const auto all = ocio::GroupTransform::Create();
    std::string source = names.source();
    if (names.is_tied_to_aces()) {
        all->appendTransform(aces_from_rec709());
        const auto from_aces = ocio::ColorSpaceTransform::Create();
        from_aces->setSrc(ocio::ROLE_INTERCHANGE_SCENE);
        from_aces->setDst(source.c_str());
        all->appendTransform(from_aces);
    }
    const auto view = ocio::DisplayViewTransform::Create();
    const std::string display = names.display();
    view->setDisplay(display.c_str());
    view->setView(names.view(display).c_str());
    if (const std::string& looks = names.look(); !looks.empty()) {
        const auto look = ocio::LookTransform::Create();
        look->setSrc(source.c_str());
        const ocio::ConstContextRcPtr context = names.config->getCurrentContext();
        source =
            ocio::LookTransform::GetLooksResultColorSpace(names.config, context, looks.c_str());
        look->setDst(source.c_str());
        look->setLooks(looks.c_str());
        all->appendTransform(look);
        view->setLooksBypass(true);
    }
    view->setSrc(source.c_str());
    all->appendTransform(view);
    return all;
}

}  // namespace

struct OcioView::Processor {
    ocio::ConstCPUProcessorRcPtr on_cpu;
};

OcioView::OcioView(const OcioChoice& choice) {
    const std::filesystem::path& file = choice.config;
    require_file(file, {});
    const WarningsTaken taken(file, warnings_);
    ocio::ConstConfigRcPtr config;
    try {
        config = ocio::Config::CreateFromFile(file.c_str());
        const auto processor = config->getProcessor(transform_of({choice, config}));
        processor_.reset(new Processor{processor->getDefaultCPUProcessor()});
        files_.push_back(file);
        const auto used = processor->getProcessorMetadata();
        for (int i = 0; i < used->getNumFiles(); ++i) files_.emplace_back(used->getFile(i));
    } catch (const ocio::Exception& e) {
        // Once the config is read, lines are those of other files that it names.
        throw_unreadable(file, place_in(file, config ? "" : e.what()), without_preamble(e.what()));
    }
}

OcioView::~OcioView() = default;

Rgb OcioView::shown(Rgb linear) const {
    std::array<float, 3> values{linear.r, linear.g, linear.b};
    processor_->on_cpu->applyRGB(values.data());
    return {values[0], values[1], values[2]};
}

}  // namespace covtrace
