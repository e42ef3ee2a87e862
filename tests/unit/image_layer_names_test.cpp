// Layer names of other renderers' own files.
#include "image/layer_names.h"

#include <gtest/gtest.h>

#include <set>

namespace covtrace {
namespace {

Image image_with(const std::vector<std::string>& names) {
    Image image;
    image.data = image.display = {0, 0, 2, 1};
    for (const std::string& name : names) image.add_channel(name);
    return image;
}

std::multiset<std::string> restored(Image image) {
    restore_layer_names(image);
    std::multiset<std::string> names;
    for (const Channel& c : image.channels) names.insert(c.name);
    return names;
}

TEST(LayerNames, PbrtsTwoNormalsStayTwoLayers) {
    EXPECT_EQ(restored(image_with({"R", "Albedo.R", "N.X", "Ns.X", "Variance.R", "P.X"})),
              (std::multiset<std::string>{"R", "albedo.R", "Ng.X", "N.X", "variance.R", "P.X"}));
}

TEST(LayerNames, OursComeBack) {
    const std::vector<std::string> ours{"R", "albedo.R", "N.X", "variance.R", "Z", "raw.R"};
    for (LayerNames names : {LayerNames::pbrt, LayerNames::blender}) {
        Image image = image_with({ours});
        rename_layers(image, names);
        EXPECT_EQ(restored(image), (std::multiset<std::string>(ours.begin(), ours.end())));
    }
}

}  // namespace
}  // namespace covtrace
