#include <fmt/format.h>

#include "reproduce/panels.h"
#include "reproduce/study.h"
#include "viewer/report.h"

namespace covtrace::reproduce {

namespace {

constexpr std::array<Ink, 4> kInks{kRed, kOrange, kCyan, Ink{190, 90, 255}};
constexpr float kPageWidth = 1120;

const Image& image_of(const Sampled& s) {
    return s.first.result.image;
}

const MethodStudy& method(const SceneStudy& s, const std::string& name) {
    for (const MethodStudy& m : s.methods)
        if (m.name == name) return m;
    throw Error(ErrorKind::internal, "a study without the method " + name);
}

/// A copy of the image with these channels alone.
Image with_layers(const Image& image, const std::vector<std::string>& channels) {
    Image result;
    result.data = image.data;
    result.display = image.display;
    for (const std::string& name : channels)
        if (const Channel* c = image.find(name)) result.channels.push_back(*c);
    return result;
}

void write_viewer_page(Section& section, const SceneStudy& s, const Workshop& workshop) {
    const std::vector<std::string> root{"R", "G", "B"};
    const std::vector<std::string> more{"R",         "G",         "B",         "samples.Y",
                                        "density.Y", "filter.xx", "filter.xy", "filter.yy"};
    std::vector<std::pair<std::string, Image>> images;
    for (const MethodStudy& m : s.methods) {
        images.emplace_back(m.label, with_layers(image_of(m.ours), more));
        images.emplace_back("path tracer, time of " + m.label,
                            with_layers(image_of(m.equal_time.uniform), root));
    }
    images.emplace_back("reference", s.reference->mean());
    viewer::Report report;
    report.title = s.name;
    for (const auto& [name, image] : images)
        report.images.push_back(
            {name,
             &image,
             {{"relMSE, trimmed", fmt::format("{:.5f}", s.reference->error(image))}},
             {}});
    const std::string file = s.name + ".html";
    viewer::write_report(report, workshop.output / file);
    section.pages.push_back(file);
}

}  // namespace

void add_pictures(Section& section, const SceneStudy& s, Workshop& workshop,
                  const std::vector<std::array<double, 4>>& insets, const std::string& content) {
    const auto size = s.scene->resolution;
    const MethodStudy &cov = method(s, "covariance"), &hybrid = method(s, "hybrid");
    std::vector<Crop> marks;
    for (size_t i = 0; i < insets.size(); ++i)
        marks.push_back({part(s.reference->mean(), insets[i]), kInks[i % kInks.size()]});

    const float scale = (kPageWidth - 24) / 2 / float(size[0]);
    Sheet images(size, scale, 2, 2);
    const auto show = [&](int column, int row, const std::string& title, const Image& image) {
        images.picture(column, row, title, display(image));
        for (const Crop& c : marks) images.mark(column, row, c.bounds, c.ink);
    };
    const auto spp = [](double n) { return fmt::format("{:.3g} samples", n); };
    show(0, 0, "covariance, " + spp(cov.ours.mean_spp()), image_of(cov.ours));
    show(1, 0, "path tracer in the same time, " + spp(cov.equal_time.spp),
         image_of(cov.equal_time.uniform));
    show(0, 1, "hybrid, " + spp(hybrid.ours.mean_spp()), image_of(hybrid.ours));
    show(1, 1, "reference, " + spp(2 * workshop.settings.reference_spp), s.reference->mean());
    const std::vector<std::string> commands{
        cov.ours.first.command, cov.equal_time.uniform.first.command, hybrid.ours.first.command,
        s.reference->command(0), s.reference->command(1)};
    section.figures.push_back({s.name, content + " The frames are the insets of the next figure.",
                               images.drawing, commands});

    std::vector<std::pair<std::string, const Image*>> columns{
        {"covariance", &image_of(cov.ours)},
        {"tracer, same time", &image_of(cov.equal_time.uniform)}};
    std::vector<std::string> inset_commands = commands;
    if (cov.equal_error.found) {
        columns.emplace_back("tracer, same error", &image_of(cov.equal_error.uniform));
        inset_commands.push_back(cov.equal_error.uniform.first.command);
    }
    columns.emplace_back("hybrid", &image_of(hybrid.ours));
    columns.emplace_back("tracer, hybrid's time", &image_of(hybrid.equal_time.uniform));
    columns.emplace_back("reference", &s.reference->mean());
    inset_commands.push_back(hybrid.equal_time.uniform.first.command);
    section.figures.push_back(
        {s.name + "-insets",
         "Insets, magnified: covariance, the path tracer in its time and at its error, hybrid, the "
         "path tracer in hybrid's time, the reference.",
         crops(columns, marks, kPageWidth), inset_commands});

    Sheet maps(size, scale, 2, 2, {true, true});
    const auto error_of = [&](const Image& i) { return relative_error(i, s.reference->mean()); };
    const std::vector<float> uniform_error = error_of(image_of(cov.equal_time.uniform));
    const ColourMap error_map{0.005f, 1, "|image - reference| over reference, luminance"};
    maps.map(0, 0, "error of covariance", error_of(image_of(cov.ours)), error_map);
    maps.map(1, 0, "error of the path tracer in the same time", uniform_error, error_map);
    const auto& counts = image_of(cov.ours).find("samples.Y")->values;
    maps.map(0, 1, "samples of covariance", counts, map_for(counts, "samples per pixel"));
    const std::vector<float> sizes = sizes_of(matrices(image_of(cov.ours), "filter."));
    maps.map(1, 1, "filters of covariance", sizes,
             map_for(sizes, "geometric mean deviation of the filter, pixels"));
    section.figures.push_back({s.name + "-maps",
                               "Where the errors are, against the mean of the reference's halves, "
                               "and what the prediction did: samples and filters.",
                               maps.drawing,
                               {commands[0], commands[1]}});
    write_viewer_page(section, s, workshop);
}

}  // namespace covtrace::reproduce
