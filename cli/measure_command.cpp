#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/commands.h"
#include "cli/message.h"
#include "cli/options.h"
#include "cli/override_options.h"
#include "cli/scene_input.h"
#include "core/parallel.h"
#include "geometry/instruction_set.h"
#include "laboratory/filter_change.h"
#include "laboratory/local_spectrum.h"
#include "laboratory/prediction.h"
#include "occluders/voxel_grid.h"
#include "render/methods/idle_options.h"
#include "render/overrides.h"
#include "render/session.h"

namespace covtrace::cli {

namespace {

struct MeasureArguments {
    std::string scene, pixel;
    std::optional<InstructionSet> isa;
    Occlusion occlusion = RenderOptions{}.occlusion;
    BrdfCovariance brdf_covariance = RenderOptions{}.brdf_covariance;
    SceneOverrides overrides;
    ReadOptions reading;
    MeasureOptions measure;
    int voxels = RenderOptions{}.voxels, threads = 0;
    uint32_t paths = 1024;
    bool json = false, quiet = false;
};

constexpr std::array<const char*, 5> kAxes{"pixel_x", "pixel_y", "lens_x", "lens_y", "shutter"};

/// Prediction and measurement of one pixel, and the quantities by which they are compared.
struct PixelComparison {
    std::array<int, 2> pixel{}, resolution{};
    covariance::SymmetricMatrix5<double> predicted;
    double luminance = 0;  ///< luminance along the central ray
    MeasuredSpectrum measured;
    /// Changes of the image by the two filters, which follow from prediction and measurement.
    FilterChange change_predicted, change_measured;

    double bandwidth(const covariance::SymmetricMatrix5<double>& s, size_t axis) const {
        return std::sqrt(std::max(0.0, s(axis, axis)));
    }
    /// Predicted over measured bandwidth, where the measurement stands out of its noise.
    std::optional<double> ratio(size_t axis) const {
        const double m = bandwidth(measured.sigma, axis);
        if (!(m > 3 * measured.bandwidth_error[axis])) return std::nullopt;
        return bandwidth(predicted, axis) / m;
    }
};

nlohmann::json matrix_json(const covariance::SymmetricMatrix5<double>& s) {
    nlohmann::json rows = nlohmann::json::array();
    for (size_t i = 0; i < 5; ++i) {
        nlohmann::json row = nlohmann::json::array();
        for (size_t j = 0; j < 5; ++j) row.push_back(s(i, j));
        rows.push_back(row);
    }
    return rows;
}

/// Deviations of a filter along its axes, pixels, the longer one first.
std::array<double, 2> deviations(const covariance::SymmetricMatrix5<double>& sigma) {
    const auto eigenvalues = covariance::eigen(filter_of(sigma));
    return {std::sqrt(eigenvalues.high), std::sqrt(eigenvalues.low)};
}

nlohmann::json filter_json(const covariance::SymmetricMatrix5<double>& sigma,
                           const FilterChange& change) {
    return {{"deviations", deviations(sigma)}, {"change", change.change}, {"noise", change.noise}};
}

nlohmann::json to_json(const PixelComparison& c, const MeasureArguments& a) {
    nlohmann::json j = {{"pixel", c.pixel},
                        {"resolution", c.resolution},
                        {"samples", a.measure.samples},
                        {"paths", a.paths},
                        {"seed", a.measure.seed},
                        {"axes", kAxes},
                        {"predicted", matrix_json(c.predicted)},
                        {"measured", matrix_json(c.measured.sigma)},
                        {"window", c.measured.window},
                        {"luminance_predicted", c.luminance},
                        {"luminance_measured", c.measured.mean},
                        {"bandwidth_error", c.measured.bandwidth_error},
                        {"filter_predicted", filter_json(c.predicted, c.change_predicted)},
                        {"filter_measured", filter_json(c.measured.sigma, c.change_measured)}};
    for (size_t i = 0; i < 5; ++i) {
        const auto ratio = c.ratio(i);
        j["bandwidth_predicted"].push_back(c.bandwidth(c.predicted, i));
        j["bandwidth_measured"].push_back(c.bandwidth(c.measured.sigma, i));
        j["ratio"].push_back(ratio ? nlohmann::json(*ratio) : nlohmann::json());
    }
    return j;
}

void print_matrix(const char* title, const covariance::SymmetricMatrix5<double>& s) {
    fmt::print("{}\n", title);
    for (size_t i = 0; i < 5; ++i) {
        fmt::print("  {:<8}", kAxes[i]);
        for (size_t j = 0; j < 5; ++j) fmt::print(" {:>11.4g}", s(i, j));
        fmt::print("\n");
    }
}

void print_table(const PixelComparison& c, const MeasureArguments& a) {
    fmt::print("pixel {},{} of {}x{}: {} paths predict, {} samples measure, seed {}\n", c.pixel[0],
               c.pixel[1], c.resolution[0], c.resolution[1], a.paths, a.measure.samples,
               a.measure.seed);
    print_matrix("predicted covariance, (cycles per pixel, lens radius, shutter)^2", c.predicted);
    print_matrix("measured covariance", c.measured.sigma);
    fmt::print("bandwidth   predicted   measured      error     window  predicted/measured\n");
    for (size_t i = 0; i < 5; ++i) {
        const auto ratio = c.ratio(i);
        fmt::print("  {:<8} {:>10.4g} {:>10.4g} {:>10.2g} {:>10.4g}  {}\n", kAxes[i],
                   c.bandwidth(c.predicted, i), c.bandwidth(c.measured.sigma, i),
                   c.measured.bandwidth_error[i], c.measured.window[i],
                   ratio ? fmt::format("{:.3f}", *ratio) : "-");
    }
    fmt::print("filter, c = 2     deviations, pixels  change of the 5x5 pixels around, rms\n");
    const auto print_filter = [](const char* name,
                                 const covariance::SymmetricMatrix5<double>& sigma,
                                 const FilterChange& change) {
        const auto [major, minor] = deviations(sigma);
        fmt::print("  of the {:<10} {:>7.2f} by {:>5.2f}  {:.2f} % (noise of a pixel {:.2f} %)\n",
                   name, major, minor, 100 * change.change, 100 * change.noise);
    };
    print_filter("prediction", c.predicted, c.change_predicted);
    print_filter("measured", c.measured.sigma, c.change_measured);
}

int measure_pixel(MeasureArguments a) {
    // Read the scene
    const ThreadLimit threads(a.threads);
    const std::array<int, 2> pixel = parse_pixel("--pixel", a.pixel);

    a.reading.shutter = a.overrides.shutter;
    SceneDescription description = read_scene(a.scene, a.reading);
    apply(a.overrides, description);
    const int width = description.film.width, height = description.film.height;
    if (pixel[0] < 0 || pixel[1] < 0 || pixel[0] >= width || pixel[1] >= height)
        throw Error(ErrorKind::usage, fmt::format("--pixel: {},{} is outside the frame of {}x{}",
                                                  pixel[0], pixel[1], width, height));
    RenderScene scene(std::move(description), isa_name(a.isa));
    if (!a.quiet) {
        print_warnings(scene.description.warnings);
        print_warnings(scene.materials.warnings());
        RenderOptions prediction;
        prediction.method = Method::covariance;
        prediction.occlusion = a.occlusion;
        prediction.voxels = a.voxels;
        for (const std::string& text : idle_options(prediction, false)) say("warning: {}\n", text);
    }
    // Prepare the analysis
    const SceneSpectra spectra(scene);
    std::optional<VoxelGrid> grid;
    std::optional<OccluderQuery> query;
    if (asks_grid(a.occlusion))
        grid.emplace(scene.geometry, VoxelGridOptions{.width = a.voxels});
    else if (a.occlusion == Occlusion::query)
        query.emplace(scene.geometry);

    // Predict, measure, and compare by filters
    const SensorRays rays(scene, {float(pixel[0]) + 0.5f, float(pixel[1]) + 0.5f});
    const int depth = scene.description.max_depth;
    const PathReplay replay(
        scene, spectra,
        {grid ? &*grid : nullptr, query ? &*query : nullptr, a.occlusion == Occlusion::voxels},
        a.brdf_covariance);
    const PathCovariance predicted = predict(scene, replay, rays, depth, a.paths, a.measure.seed);
    PixelComparison c{pixel, {width, height}, predicted.sigma, predicted.weight, {}, {}, {}};
    a.measure.axes = sensor_axes(scene);
    const LocalField field = radiance_field(scene, rays, depth, a.measure.seed);
    c.measured = measure(field, a.measure);
    const auto change_by = [&](const covariance::SymmetricMatrix5<double>& sigma) {
        return filter_change(field, filter_of(sigma), a.measure.samples, a.measure.seed);
    };
    c.change_predicted = change_by(c.predicted);
    c.change_measured = change_by(c.measured.sigma);
    if (!(c.measured.mean > 0) && !a.quiet)
        say("warning: no light reaches pixel {},{}: nothing was measured\n", pixel[0], pixel[1]);
    if (a.json)
        fmt::print("{}\n", to_json(c, a).dump());
    else
        print_table(c, a);
    return 0;
}

}  // namespace

void add_measure(CLI::App& app, Invocation& invocation) {
    auto a = std::make_shared<MeasureArguments>();
    CLI::App* c = app.add_subcommand("measure", "Hold a pixel's prediction against measurement");
    c->add_option("SCENE", a->scene, "the scene: a pbrt-v4 or glTF 2.0 file, or -")
        ->required()
        ->option_text(" ");
    c->add_option("--pixel", a->pixel, "the pixel whose middle is looked through")
        ->required()
        ->option_text("x,y");
    add_whole(c, "--samples", a->measure.samples, 1 << 12, 1 << 28,
              "radiance samples (default 262144, twice)");
    add_whole(c, "--paths", a->paths, 1, 1 << 24,
              "covariance paths of the prediction (default 1024)");
    add_choice(c, "--occlusion", a->occlusion, "how the prediction finds edges beside paths");
    add_choice(c, "--brdf-covariance", a->brdf_covariance,
               "a BRDF's frequencies: at the path, or its peak's");
    add_whole(c, "--voxels", a->voxels, 1, 2048, "width of the occlusion grid (default 200)");
    c->add_option_function<std::string>(
         "--seed", [a](const std::string& text) { a->measure.seed = parse_seed("--seed", text); },
         "seed of all random numbers (default 0)")
        ->option_text("N");
    add_whole(c, "--threads", a->threads, 1, 4096, "worker threads (default: all cores)");
    add_choice(c, "--isa", a->isa, "instruction set of the ray tracing");
    add_override_options(c, a->overrides, a->reading);
    c->add_flag("--json", a->json, "one JSON object on standard output");
    c->add_flag("--quiet", a->quiet, "errors only");
    c->callback([a, &invocation] { invocation.action = [a] { return measure_pixel(*a); }; });
}

}  // namespace covtrace::cli
