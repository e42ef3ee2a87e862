// Layers by the names that renderers write.
#include "foreign/layer_search.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "foreign_fixtures.h"
#include "image/layer_names.h"

namespace covtrace {
namespace {

using namespace test;

struct Names {
    std::string color, variance, albedo, normal, depth;
};

std::string name_of(const std::optional<LayerChannels>& channels) {
    if (!channels) return "";
    std::string text;
    for (const Channel* c : *channels) text += (text.empty() ? "" : " ") + c->name;
    return text;
}

Names found_in(Image image, const LayerNaming& naming = {}) {
    restore_layer_names(image);
    const FoundLayers found = find_layers(image, naming, "a.exr");
    return {name_of(found.color), name_of(found.variance), name_of(found.albedo),
            name_of(found.normal), found.depth ? found.depth->name : name_of(found.place)};
}

/// The channels of pbrt-v4's "gbuffer" film.
Image gbuffer() {
    Image image = image_with({"Albedo.B",
                              "Albedo.G",
                              "Albedo.R",
                              "B",
                              "G",
                              "N.X",
                              "N.Y",
                              "N.Z",
                              "Ns.X",
                              "Ns.Y",
                              "Ns.Z",
                              "P.X",
                              "P.Y",
                              "P.Z",
                              "R",
                              "RelativeVariance.B",
                              "RelativeVariance.G",
                              "RelativeVariance.R",
                              "Variance.B",
                              "Variance.G",
                              "Variance.R",
                              "dzdx",
                              "dzdy",
                              "u",
                              "v"});
    image.metadata["samplesPerPixel"] = 16;
    return image;
}

TEST(LayerSearch, KnowsPbrt) {
    const Names names = found_in(gbuffer());
    EXPECT_EQ(names.color, "R G B");
    EXPECT_EQ(names.variance, "variance.R variance.G variance.B");
    EXPECT_EQ(names.albedo, "albedo.R albedo.G albedo.B");
    EXPECT_EQ(names.normal, "N.X N.Y N.Z");
    EXPECT_EQ(names.depth, "P.X P.Y P.Z");
    // Its variance is that of a sample.
    EXPECT_TRUE(find_layers(gbuffer(), {}, "a").is_variance_of_one);
    EXPECT_EQ(samples_in_metadata(gbuffer()), 16.0f);
}

TEST(LayerSearch, TakesPbrtsShadingNormals) {
    Image image = gbuffer();
    for (Channel& c : image.channels)
        if (c.name.starts_with("Ns.")) c.values.assign(c.values.size(), 0.5f);
    restore_layer_names(image);
    const FoundLayers found = find_layers(image, {}, "a");
    for (const Channel* c : *found.normal) EXPECT_EQ(c->values[0], 0.5f);
    EXPECT_TRUE(image.find("Ng.X"));
}

TEST(LayerSearch, KnowsTheFirstPbrtV4) {
    const Names names =
        found_in(image_with({"R", "G", "B", "Albedo.R", "Albedo.G", "Albedo.B", "Px", "Py", "Pz",
                             "Nx", "Ny", "Nz", "Nsx", "Nsy", "Nsz"}));
    EXPECT_EQ(names.normal, "Nsx Nsy Nsz");
    EXPECT_EQ(names.depth, "Px Py Pz");
}

TEST(LayerSearch, KnowsMitsuba) {
    // aovs "albedo:albedo,nn:sh_normal,dd.y:depth" around an integrator called "img"
    const Names names =
        found_in(image_with({"B", "G", "R", "albedo.B", "albedo.G", "albedo.R", "dd.y.T", "img.A",
                             "img.B", "img.G", "img.R", "nn.X", "nn.Y", "nn.Z"}));
    EXPECT_EQ(names.color, "R G B");
    EXPECT_EQ(names.albedo, "albedo.R albedo.G albedo.B");
    EXPECT_EQ(names.normal, "nn.X nn.Y nn.Z");
    EXPECT_EQ(names.depth, "dd.y.T");
    EXPECT_EQ(names.variance, "");
}

TEST(LayerSearch, KnowsCycles) {
    std::vector<std::string> channels;
    for (const char* name :
         {"Combined.A", "Combined.B", "Combined.G", "Combined.R", "Debug Sample Count.X",
          "Denoising Albedo.B", "Denoising Albedo.G", "Denoising Albedo.R", "Denoising Depth.Z",
          "Denoising Normal.X", "Denoising Normal.Y", "Denoising Normal.Z"})
        channels.push_back(std::string("View Layer.001.") + name);
    Names names = found_in(image_with(channels));
    EXPECT_EQ(names.color, "R G B");
    EXPECT_EQ(names.albedo, "albedo.R albedo.G albedo.B");
    EXPECT_EQ(names.normal, "N.X N.Y N.Z");
    EXPECT_EQ(names.depth, "Denoising Depth.Z");
    // Where Cycles has denoised already, the noisy image is a pass of its own.
    for (const char* c : {"R", "G", "B", "A"})
        channels.push_back("View Layer.001.Noisy Image." + std::string(c));
    EXPECT_EQ(found_in(image_with(channels)).color, "raw.R raw.G raw.B");
    Image image = image_with(channels);
    image.metadata["cycles.View Layer.samples"] = std::string("128");
    EXPECT_EQ(samples_in_metadata(image), 128.0f);
    restore_layer_names(image);
    EXPECT_EQ(find_layers(image, {}, "a").samples_unit, 128);
}

TEST(LayerSearch, TakesTheViewLayerBesideTheCompositorsImage) {
    const std::vector<std::string> features{"Denoising Albedo.R", "Denoising Albedo.G",
                                            "Denoising Albedo.B", "Denoising Depth.Z"};
    std::vector<std::string> names;
    for (const char* layer : {"Composite.", "Background.", "Scene."})
        for (const char* c : {"Combined.R", "Combined.G", "Combined.B"})
            names.push_back(std::string(layer) + c);
    Image plain = image_with(names);
    for (const std::string& f : features) names.push_back("Scene." + f);
    Image image = image_with(names);
    const auto colour = [](Image& of, const std::string& layer) {
        for (Channel& c : of.channels)
            c.values.assign(c.values.size(), c.name.starts_with(layer) ? 1.0f : 0.0f);
        restore_layer_names(of);
        return find_layers(of, {}, "a").color[0]->values[0];
    };
    EXPECT_EQ(colour(image, "Scene."), 1);
    EXPECT_EQ(name_of(find_layers(image, {}, "a").albedo), "albedo.R albedo.G albedo.B");
    EXPECT_EQ(colour(plain, "Background."), 1);
    Image alone =
        image_with({"Composite.Combined.R", "Composite.Combined.G", "Composite.Combined.B"});
    EXPECT_EQ(colour(alone, "Composite."), 1);
}

TEST(LayerSearch, KnowsWhatOtherDenoisersRead) {
    const Names arnold = found_in(image_with({"R", "G", "B", "denoise_albedo.R", "denoise_albedo.G",
                                              "denoise_albedo.B", "N.X", "N.Y", "N.Z", "Z"}));
    EXPECT_EQ(arnold.albedo, "denoise_albedo.R denoise_albedo.G denoise_albedo.B");
    const Names renderman =
        found_in(image_with({"Ci.r", "Ci.g", "Ci.b", "a", "albedo.r", "albedo.g", "albedo.b",
                             "normal.x", "normal.y", "normal.z", "z"}));
    EXPECT_EQ(renderman.color, "Ci.r Ci.g Ci.b");
    EXPECT_EQ(renderman.albedo, "albedo.r albedo.g albedo.b");
    EXPECT_EQ(renderman.normal, "normal.x normal.y normal.z");
    EXPECT_EQ(renderman.depth, "z");
    const Names vray = found_in(
        image_with({"R", "G", "B", "VRayDiffuseFilter.R", "VRayDiffuseFilter.G",
                    "VRayDiffuseFilter.B", "VRayNormals.X", "VRayNormals.Y", "VRayNormals.Z",
                    "VRayZDepth.Z", "VRayCryptomatte00.R", "VRayCryptomatte00.G"}));
    EXPECT_EQ(vray.albedo, "VRayDiffuseFilter.R VRayDiffuseFilter.G VRayDiffuseFilter.B");
    EXPECT_EQ(vray.normal, "VRayNormals.X VRayNormals.Y VRayNormals.Z");
    EXPECT_EQ(vray.depth, "VRayZDepth.Z");
}

TEST(LayerSearch, KnowsCyclesInParts) {
    // Each pass is a part of the file that is named by it; the reader leaves out the first's name.
    const Names names =
        found_in(image_with({"R", "G", "B", "A", "ViewLayer.Denoising Albedo.R",
                             "ViewLayer.Denoising Albedo.G", "ViewLayer.Denoising Albedo.B",
                             "ViewLayer.Denoising Normal.X", "ViewLayer.Denoising Normal.Y",
                             "ViewLayer.Denoising Normal.Z", "ViewLayer.Denoising Depth.Z"}));
    EXPECT_EQ(names.color, "R G B");
    EXPECT_EQ(names.albedo, "albedo.R albedo.G albedo.B");
    EXPECT_EQ(names.normal, "N.X N.Y N.Z");
    EXPECT_EQ(names.depth, "Denoising Depth.Z");
}

TEST(LayerSearch, TakesOurNoisyPixelsAndWhatMirrorsShow) {
    const Names names = found_in(
        image_with({"R", "G", "B", "raw.R", "raw.G", "raw.B", "N.X", "N.Y", "N.Z", "featureN.X",
                    "featureN.Y", "featureN.Z", "albedo.R", "albedo.G", "albedo.B", "Z"}));
    EXPECT_EQ(names.color, "raw.R raw.G raw.B");
    EXPECT_EQ(names.normal, "featureN.X featureN.Y featureN.Z");
    EXPECT_EQ(names.depth, "Z");
}

TEST(LayerSearch, TakesTheLayersThatAreNamed) {
    const Image image =
        image_with({"R", "G", "B", "raw.R", "raw.G", "raw.B", "albedo.R", "albedo.G", "albedo.B",
                    "my.color.R", "my.color.G", "my.color.B", "way.V"});
    const Names names = found_in(image, {.color = "root", .albedo = "my.color", .depth = "way"});
    EXPECT_EQ(names.color, "R G B");
    EXPECT_EQ(names.albedo, "my.color.R my.color.G my.color.B");
    EXPECT_EQ(names.depth, "way.V");
    EXPECT_EQ(found_in(image, {.albedo = "none"}).albedo, "");
}

std::string message_of(const Image& image, const LayerNaming& naming) {
    try {
        find_layers(image, naming, "a.exr");
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::usage);
        return e.what();
    }
    return "";
}

TEST(LayerSearch, RefusesLayersThatAreMissing) {
    const Image image = image_with({"R", "G", "B", "u", "P.X", "P.Y"});
    EXPECT_EQ(message_of(image, {.albedo = "base"}),
              "albedo: a.exr has no layer 'base' with the channels R, G, B or X, Y, Z; there are "
              "B, G, P, R, u");
    EXPECT_EQ(message_of(image, {.depth = "P"}),
              "depth: a.exr has no layer 'P' with one channel, or with X, Y, Z; there are B, G, P, "
              "R, u");
    EXPECT_EQ(message_of(image_with({"Y"}), {}),
              "color: a.exr has no channels R, G, B; expected the name of the layer with the noisy "
              "colour, of Y");
    EXPECT_NE(message_of(image, {.color = "none"}), "");
}

}  // namespace
}  // namespace covtrace
