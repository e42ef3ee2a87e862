/// Scenes of textures only, and image files to load.
#pragma once

#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <string>
#include <vector>

#include "image/raster.h"
#include "scene/scene_description.h"

namespace covtrace {

/// Appends a value in [0, 1], rounded to what the raster holds.
inline void add_value(RasterImage& raster, float value) {
    if (raster.is_8bit)
        raster.bytes.push_back(uint8_t(value * 255 + 0.5f));
    else
        raster.values.push_back(value);
}

/// Collects textures; `add` returns the id.
struct TextureScene {
    SceneDescription description;

    template <typename Texture>
    TextureId add(Texture texture, bool is_spectrum = true) {
        description.textures.push_back({"", is_spectrum, std::move(texture), {}});
        return TextureId(description.textures.size()) - 1;
    }
    TextureId add_constant(Rgb value) { return add(ConstantTexture{value}); }
    TextureId add_float(float value) { return add(ConstantTexture{Rgb(value)}, false); }
};

/// A folder of its own that vanishes with the object.
class TemporaryFolder {
  public:
    explicit TemporaryFolder(const std::string& name)
        : path_(std::filesystem::temp_directory_path() / ("covtrace_" + name)) {
        std::filesystem::remove_all(path_);
        std::filesystem::create_directories(path_);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    /// 8-bit; `texels` holds R, G, B row by row from the top.
    std::filesystem::path write_ppm(const std::string& name, int width, int height,
                                    const std::vector<uint8_t>& texels) const {
        std::ofstream out(path_ / name, std::ios::binary);
        out << "P6\n" << width << ' ' << height << "\n255\n";
        out.write(reinterpret_cast<const char*>(texels.data()), std::streamsize(texels.size()));
        return path_ / name;
    }
    /// Grey float image; `texels` row by row from the top.
    std::filesystem::path write_pfm(const std::string& name, int width, int height,
                                    const std::vector<float>& texels) const {
        static_assert(std::endian::native == std::endian::little);
        std::ofstream out(path_ / name, std::ios::binary);
        out << "Pf\n" << width << ' ' << height << "\n-1.0\n";
        for (int y = height - 1; y >= 0; --y)
            out.write(reinterpret_cast<const char*>(texels.data() + size_t(y) * size_t(width)),
                      std::streamsize(size_t(width) * sizeof(float)));
        return path_ / name;
    }

  private:
    std::filesystem::path path_;
};

inline ImageTexture image_texture(const std::filesystem::path& file) {
    ImageTexture t;
    t.file = file;
    return t;
}

}  // namespace covtrace
