#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/commands.h"
#include "cli/image_summary.h"
#include "cli/options.h"
#include "cli/picture_name.h"
#include "cli/pixel_description.h"
#include "cli/report_file.h"
#include "cli/same_file.h"
#include "cli/values.h"
#include "image/layer_names.h"

namespace covtrace::cli {

namespace {

struct InspectArguments {
    std::string image, pixel, crop, report;
    bool json = false;
};

/// The summary's main figures, for the page.
std::vector<viewer::Fact> facts_of(const ImageSummary& summary) {
    std::vector<viewer::Fact> facts;
    if (!summary.origin.empty()) facts.push_back({"made by", summary.origin});
    for (const Quantity& q : summary.quantities)
        facts.push_back(
            {q.title,
             fmt::format("{} (from {} to {})", format_number(q.distribution.mean),
                         format_number(q.distribution.least), format_number(q.distribution.most))});
    if (!summary.uncertain.empty())
        facts.push_back({"estimated error, sqrt(relMSE)", format_number(summary.estimated_error)});
    for (const UncertainPixel& p : summary.uncertain)
        facts.push_back({fmt::format("uncertain: {},{}", p.x, p.y), p.certainty.sentence,
                         std::array{p.x, p.y}});
    if (summary.nonfinite > 0)
        facts.push_back({"values that are not finite", std::to_string(summary.nonfinite)});
    return facts;
}

int inspect_image(const InspectArguments& a) {
    require_distinct({{"--report", a.report}}, {a.image});
    require_report_name("--report", a.report);
    std::optional<std::array<int, 2>> pixel;
    if (!a.pixel.empty()) pixel = parse_pixel("--pixel", a.pixel);
    Image image = read_image(a.image);
    restore_layer_names(image);
    if (!a.crop.empty()) {
        const PixelBounds crop = intersection(image.data, parse_crop("--crop", a.crop));
        if (crop.empty()) throw Error(ErrorKind::usage, "--crop: the image has no such pixels");
        image = cropped(image, crop);
    }
    std::optional<PixelDescription> chosen;
    if (pixel) chosen = describe_pixel(image, (*pixel)[0], (*pixel)[1]);

    const bool needs_summary = a.json || !a.report.empty() || !pixel;
    const ImageSummary summary = needs_summary ? summarize(image) : ImageSummary{};
    if (!a.report.empty()) {
        const std::string name = std::filesystem::path(a.image).filename().string();
        write_report_file({name, {{name, &image, facts_of(summary), {}}}, {}, pixel}, a.report);
    }
    if (a.json) {
        nlohmann::json j = to_json(summary, image, a.image);
        if (chosen) j["pixel"] = to_json(*chosen);
        fmt::print("{}\n", j.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    } else if (chosen) {
        fmt::print("{}", to_text(*chosen));
    } else if (a.report.empty()) {
        fmt::print("{}", to_text(summary, image, a.image));
    }
    return 0;
}

}  // namespace

void add_inspect(CLI::App& app, Invocation& invocation) {
    auto a = std::make_shared<InspectArguments>();
    CLI::App* c = app.add_subcommand("inspect", "Tell of samples, filters and errors");
    c->add_option("IMAGE", a->image, "an image, best with the layers of 'render'")
        ->required()
        ->option_text(" ");
    c->add_option("--pixel", a->pixel, "all about one pixel: covariance, filter, samples")
        ->check(not_empty())
        ->option_text("x,y");
    c->add_option("--crop", a->crop, "only these pixels, end exclusive")
        ->check(not_empty())
        ->option_text("x0,y0,x1,y1");
    c->add_option("--report", a->report, "a page for any browser instead of text")
        ->check(not_empty())
        ->option_text("FILE.html");
    c->add_flag("--json", a->json, "one JSON object on standard output");
    c->callback([a, &invocation] { invocation.action = [a] { return inspect_image(*a); }; });
}

}  // namespace covtrace::cli
