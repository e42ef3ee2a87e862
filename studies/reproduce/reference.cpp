#include "reproduce/reference.h"

#include <fmt/format.h>

#include "image/compare.h"
#include "render/image_hash.h"
#include "render/version.h"

namespace covtrace::reproduce {

namespace {

constexpr std::array<uint64_t, 2> kSeeds{1000, 1001};  // seeds that no experiment uses

/// Everything that the pixels of a half depend on; empty where the code is not known.
std::string origin(const LoadedScene& scene, const RenderOptions& options) {
    if (!kCommitIsExact) return {};
    const SceneDescription& d = scene.scene->description;
    return fmt::format("{} {:016x} images {} {} spp seed {}", std::string(kCommit), d.content_hash,
                       image_hash(d), *options.spp, options.seed);
}

}  // namespace

Reference::Reference(Workshop& workshop, LoadedScene& scene) {
    const fs::path folder = workshop.output / "references";
    std::error_code error;
    fs::create_directories(folder, error);
    for (size_t k = 0; k < 2; ++k) {
        RenderOptions options;
        options.method = Method::uniform;
        options.spp = workshop.settings.reference_spp;
        options.seed = kSeeds[k];
        // Emitters in view are kept apart, so that the floors of the filters can be found by
        // filtering both parts of the light, each with its own filters.
        options.emitters_apart = true;
        const std::string made_by = origin(scene, options);
        commands_[k] = render_command(scene, options);
        const fs::path file =
            folder / fmt::format("{}-{}x{}-{}.exr", scene.name, scene.resolution[0],
                                 scene.resolution[1], kSeeds[k]);
        if (!made_by.empty() && fs::is_regular_file(file, error)) {
            halves_[k] = read_image(file);
            const auto found = halves_[k].metadata.find("covtrace:origin");
            if (found != halves_[k].metadata.end() && found->second == MetadataValue(made_by))
                continue;
        }
        workshop.tell(fmt::format("{}: reference, half {} of 2, {:g} samples per pixel", scene.name,
                                  k + 1, workshop.settings.reference_spp));
        halves_[k] = workshop.render(scene, options).result.image;
        halves_[k].metadata["covtrace:origin"] = made_by;
        write_exr(halves_[k], file, 2);
    }
    mean_.data = halves_[0].data;
    mean_.display = halves_[0].display;
    for (const char* name : {"R", "G", "B"}) {
        Channel& channel = mean_.add_channel(name);
        const Channel &a = *halves_[0].find(name), &b = *halves_[1].find(name);
        for (size_t i = 0; i < channel.values.size(); ++i)
            channel.values[i] = 0.5f * (a.values[i] + b.values[i]);
    }
    noise_ = 0.5 * compare(halves_[0], halves_[1]).relmse_trimmed;
}

double Reference::noise(std::optional<PixelBounds> crop) const {
    return crop ? 0.5 * compare(halves_[0], halves_[1], crop).relmse_trimmed : noise_;
}

double Reference::error(const Image& image, std::optional<PixelBounds> crop) const {
    const double against = 0.5 * (compare(image, halves_[0], crop).relmse_trimmed +
                                  compare(image, halves_[1], crop).relmse_trimmed);
    return against - noise(crop);
}

LoadedScene& shared_scene(Workshop& workshop, const std::string& name) {
    return workshop.shared<LoadedScene>("scene " + name, [&] {
        return workshop.load(name, workshop.scenes.generated(name), workshop.settings.scene);
    });
}

Reference& shared_reference(Workshop& workshop, const std::string& name) {
    return workshop.shared<Reference>(
        "reference " + name, [&] { return Reference(workshop, shared_scene(workshop, name)); });
}

}  // namespace covtrace::reproduce
