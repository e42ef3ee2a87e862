#include "render/image_hash.h"

#include <xxhash.h>

#include <filesystem>
#include <fstream>
#include <iomanip>
#include <memory>
#include <set>
#include <sstream>
#include <variant>
#include <vector>

#include "core/hash.h"
#include "core/parallel.h"

namespace covtrace {

namespace fs = std::filesystem;

std::vector<fs::path> image_files(const SceneDescription& scene) {
    std::set<fs::path> files;
    for (const TextureDescription& texture : scene.textures)
        if (const auto* image = std::get_if<ImageTexture>(&texture.value); image && !image->content)
            files.insert(image->file);
    for (const LightDescription& light : scene.lights) {
        if (const auto* l = std::get_if<GoniometricLight>(&light.value); l && l->image)
            files.insert(*l->image);
        if (const auto* l = std::get_if<ProjectionLight>(&light.value)) files.insert(l->image);
        if (const auto* l = std::get_if<InfiniteLight>(&light.value); l && l->image)
            files.insert(*l->image);
    }
    for (const AreaLightDescription& light : scene.area_lights)
        if (light.goniometric) files.insert(*light.goniometric);
    return {files.begin(), files.end()};
}

namespace {

uint64_t hash_of(const fs::path& file) {
    const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                                XXH3_freeState);
    XXH3_64bits_reset(state.get());
    std::ifstream in(file, std::ios::binary);
    std::vector<char> block(1 << 20);
    while (in) {
        in.read(block.data(), std::streamsize(block.size()));
        XXH3_64bits_update(state.get(), block.data(), size_t(in.gcount()));
    }
    if (!in.eof()) throw Error(ErrorKind::scene, "cannot read '" + file.string() + "'");
    return XXH3_64bits_digest(state.get());
}

}  // namespace

std::string image_hash(const SceneDescription& scene) {
    const std::vector<fs::path> files = image_files(scene);
    std::vector<uint64_t> hashes(files.size());
    parallel_for(int64_t(files.size()),
                 [&](int64_t i) { hashes[size_t(i)] = hash_of(files[size_t(i)]); });
    uint64_t all = 0;
    for (uint64_t h : hashes) all = hash_combine(all, h);
    std::ostringstream out;
    out << std::hex << std::setw(16) << std::setfill('0') << all;
    return out.str();
}

}  // namespace covtrace
