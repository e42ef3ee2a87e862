#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/picture_name.h"
#include "cli/pixel_description.h"
#include "cli/report_file.h"
#include "cli/same_file.h"
#include "cli/values.h"
#include "image/compare.h"
#include "image/layer_names.h"
#include "reconstruction/gather.h"

namespace covtrace::cli {

namespace {

struct CompareArguments {
    std::string image, reference, crop, report;
    bool json = false;
    double smooth = 0;
};

/// Blurs an image by a Gaussian of the given standard deviation in pixels: the baseline that any
/// renderer can have.
void smooth_root(Image& image, double deviation) {
    if (!image.find("R") || !image.find("G") || !image.find("B"))
        throw Error(ErrorKind::usage, "--smooth: expected an image with the channels R, G and B");
    const auto variance = float(deviation * deviation);
    const std::vector<covariance::Sym2<float>> same(image.pixel_count(), {variance, 0, variance});
    std::vector<Rgb> mean(image.pixel_count());
    for (size_t i = 0; i < mean.size(); ++i) mean[i] = image.rgb(i);
    const std::vector<float> no_variance(mean.size(), 0.0f);
    const std::vector<uint32_t> count(mean.size(), 1);
    const FilteredImage smoothed =
        gather(mean, no_variance, count, {image.width(), image.height(), same});
    for (Channel& c : image.channels)
        for (int k = 0; k < 3; ++k)
            if (c.name == std::string(1, "RGB"[k]))
                for (size_t i = 0; i < mean.size(); ++i) c.values[i] = smoothed.color[i][k];
}

/// Ratios as text, one after the other; those of nothing to nothing, which are not a number, are
/// dashes.
template <typename Format>
std::string ratios_as_text(std::span<const double> ratios, const Format& format) {
    std::vector<std::string> texts;
    for (const double ratio : ratios) texts.push_back(std::isnan(ratio) ? "-" : format(ratio));
    return fmt::format("{}", fmt::join(texts, " "));
}

/// Writes a page with both images side by side, the FLIP map and the measures.
void write_comparison(const CompareArguments& a, const Image& image, const Image& reference,
                      const Comparison& c) {
    const auto name = [](const std::string& file) {
        return std::filesystem::path(file).filename().string();
    };
    const auto part = [&](const Image& whole) {
        return whole.data == c.bounds ? whole : cropped(whole, c.bounds);
    };
    const Image shown_image = part(image), shown_reference = part(reference);
    viewer::Report report;
    report.title = name(a.image) + " against " + name(a.reference);
    report.images = {{name(a.image), &shown_image, {}, {{1, c.flip_map}}},
                     {name(a.reference), &shown_reference, {}, {}}};
    report.facts = {{"relMSE", format_number(c.relmse)},
                    {"relMSE, trimmed", format_number(c.relmse_trimmed)},
                    {"relMSE at the median's exposure", format_number(c.relmse_median)},
                    {"MSE", format_number(c.mse)},
                    {"PSNR", format_number(c.psnr) + " dB"},
                    {"FLIP", format_number(c.flip)},
                    {"mean A / mean B", ratios_as_text(c.mean_ratio, format_number)},
                    {"mean A / mean B by brightness, darkest first",
                     ratios_as_text(c.decile_ratio, format_number)}};
    if (c.nonfinite > 0)
        report.facts.push_back({"values that are not finite", std::to_string(c.nonfinite)});
    write_report_file(report, a.report);
}

int compare_images(const CompareArguments& a) {
    require_distinct({{"--report", a.report}}, {a.image, a.reference});
    require_report_name("--report", a.report);
    std::optional<PixelBounds> crop;
    if (!a.crop.empty()) crop = parse_crop("--crop", a.crop);
    const auto read = [](const std::string& file) {
        Image i = read_image(file);
        restore_layer_names(i);
        return i;
    };
    Image image = read(a.image);
    const Image reference = read(a.reference);
    if (a.smooth > 0) smooth_root(image, a.smooth);
    const Comparison c = compare(image, reference, crop);
    if (!a.report.empty()) write_comparison(a, image, reference, c);
    if (a.json) {
        // Infinity is null, as JSON has none: the psnr of equal images, and 0 / 0.
        nlohmann::json j = {
            {"mse", c.mse},
            {"relmse", c.relmse},
            {"relmse_trimmed", c.relmse_trimmed},
            {"relmse_median", c.relmse_median},
            {"psnr", std::isfinite(c.psnr) ? nlohmann::json(c.psnr) : nlohmann::json()},
            {"flip", c.flip},
            {"mean_ratio", c.mean_ratio},
            {"decile_ratio", c.decile_ratio},
            {"nonfinite", c.nonfinite},
            {"identical", c.identical}};
        fmt::print("{}\n", j.dump());
        return 0;
    }
    const auto digits = [](double ratio) { return fmt::format("{:.5f}", ratio); };
    fmt::print(
        "mse             {:.6g}\nrelmse          {:.6g}\nrelmse_trimmed  {:.6g}\n"
        "relmse_median   {:.6g}\npsnr            {:.3f} dB\nflip            {:.5f}\n"
        "mean_ratio      {}\ndecile_ratio    {}\nnonfinite       {}\n"
        "identical       {}\n",
        c.mse, c.relmse, c.relmse_trimmed, c.relmse_median, c.psnr, c.flip,
        ratios_as_text(c.mean_ratio, digits), ratios_as_text(c.decile_ratio, digits), c.nonfinite,
        c.identical ? "yes" : "no");
    return 0;
}

}  // namespace

void add_compare(CLI::App& app, Invocation& invocation) {
    auto a = std::make_shared<CompareArguments>();
    CLI::App* c = app.add_subcommand("compare", "Measure an image against a reference");
    c->add_option("IMAGE", a->image, "the image")->required()->option_text(" ");
    c->add_option("REFERENCE", a->reference, "what it should be")->required()->option_text(" ");
    c->add_option("--crop", a->crop, "only these pixels, end exclusive")
        ->check(not_empty())
        ->option_text("x0,y0,x1,y1");
    c->add_option_function<std::string>(
         "--smooth",
         [a](const std::string& text) {
             // The least deviation is no blur at all; the squares of much smaller ones are zero.
             constexpr double kLeast = 1e-3, kMost = 1000;
             a->smooth = parse_positive("--smooth", text, kMost, kLeast);
         },
         "first blur the image: a Gaussian of N pixels")
        ->option_text("N");
    c->add_option("--report", a->report, "also a page for any browser with both images")
        ->check(not_empty())
        ->option_text("FILE.html");
    c->add_flag("--json", a->json, "one JSON object on standard output");
    c->callback([a, &invocation] { invocation.action = [a] { return compare_images(*a); }; });
}

}  // namespace covtrace::cli
