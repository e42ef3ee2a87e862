#include "cli/render_options.h"

#include "cli/frames.h"
#include "cli/options.h"
#include "cli/override_options.h"

namespace covtrace::cli {

namespace {

/// How much is sampled, and how the image is made of it.
void add_method_options(CLI::App* c, RenderArguments& a) {
    add_choice(c, "--preset", a.preset, "4, 32 or 512 samples; other options go first");
    add_choice(c, "--method", a.options.method, "plain, the thesis' method, or hybrid (default)");
    add_positive(c, "--spp", a.options.spp, 1 << 30,
                 "average samples per pixel (default: the scene's)");
    c->add_option("--time", a.seconds, "wall-clock budget: 2.5, 45s, 3m, 1h30m")
        ->check(not_empty())
        ->option_text("T");
    add_positive(c, "--error", a.options.error, 1e6, "stop at this estimated sqrt(relMSE)");
    c->add_option_function<std::string>(
         "--cov-spp",
         [&a](const std::string& text) { a.options.cov_spp = parse_paths("--cov-spp", text); },
         "covariance paths per pixel (default 2, hybrid 1)")
        ->option_text("N");
    add_choice(c, "--density", a.options.density, "how counts follow from the prediction");
    add_positive(c, "--k", a.options.density_factor, 1e12,
                 "density thesis: the k of N = k sqrt|S|");
    add_whole(c, "--max-spp", a.options.max_spp, 1, 1 << 30,
              "most samples in a pixel (default: 16 x average)");
    c->add_flag("--progressive", a.options.progressive, "covariance: rounds of samples on demand");
    c->add_flag("--even-counts", a.options.even_counts, "hybrid: the same count in every pixel");
    add_denoiser_options(c, a.denoiser);
    add_choice(c, "--occlusion", a.options.occlusion, "occluders beside the rays of the analysis");
    add_whole(c, "--voxels", a.options.voxels, 1, 2048,
              "width of the occlusion grid (default 200)");
    add_choice(c, "--brdf-covariance", a.options.brdf_covariance,
               "a BRDF's frequencies: at the path, or its peak's");
    add_choice(c, "--texture-bandwidth", a.options.texture_bandwidth,
               "textures' frequencies: own, or the image's");
    add_choice(c, "--filter", a.options.filter, "its constant: verified, c = 1, thesis' eq. 5.7");
    add_choice(c, "--guides", a.options.guides, "learnt guides to light: where they pay, or none");
    c->add_option_function<std::string>(
         "--seed", [&a](const std::string& text) { a.options.seed = parse_seed("--seed", text); },
         "seed of all random numbers (default 0)")
        ->option_text("N");
}

/// The scene's files, the part of it that is shown, and the values that replace its own.
void add_scene_options(CLI::App* c, RenderArguments& a) {
    add_override_options(c, a.overrides, a.reading);
    c->add_option_function<std::string>(
         "--crop", [&a](const std::string& text) { a.overrides.crop = parse_crop("--crop", text); },
         "only these pixels, end exclusive")
        ->option_text("x0,y0,x1,y1");
    c->add_option_function<std::string>(
         "--frames", [&a](const std::string& text) { a.frames = parse_frames("--frames", text); },
         "frames of an animation, each to files of its own")
        ->option_text("A-B|A-BxN");
    c->add_option_function<std::string>(
         "--fps",
         [&a](const std::string& text) { a.fps = parse_positive("--fps", text, 1e6, 1e-3); },
         "of --frames (default 24)")
        ->option_text("N");
    c->add_option("--search-path", a.search_paths,
                  "also look here for the scene's files; repeatable")
        ->check(CLI::ExistingDirectory.description(""))
        ->allow_extra_args(false)
        ->take_all()
        ->option_text("DIR");
}

/// The files beside the image, and the messages meanwhile.
void add_output_options(CLI::App* c, RenderArguments& a) {
    c->add_option("--png", a.png, "also an 8-bit sRGB picture")
        ->check(not_empty())
        ->option_text("FILE");
    add_display_options(c, a.display);
    add_layers(c, "--layers", a.layers, "all, or name,name…: layers beside the image");
    add_choice(c, "--layer-names", a.layer_names, "of layers in EXRs: default, pbrt or blender");
    c->get_option("--layer-names")->option_text("WHOSE");  // all of them would take another line
    c->add_option("--tev", a.tev, "show the image in the viewer tev while it renders")
        ->check(not_empty())
        ->option_text("HOST:PORT");
    add_layers(c, "--tev-layers", a.tev_layers, "layers that tev shows, too (default: none)");
    add_choice(c, "--progress", a.progress, "how progress is shown on standard error");
    c->add_option("--stats", a.stats, "counters, phase times and memory as JSON")
        ->check(not_empty())
        ->option_text("FILE");
    c->add_flag("--reproducible", a.reproducible, "write no command, seconds and date");
    c->add_flag("--quiet", a.quiet, "errors only");
}

/// Limits of the machine's processors and memory.
void add_machine_options(CLI::App* c, RenderArguments& a) {
    add_whole(c, "--threads", a.threads, 1, 4096, "worker threads (default: all cores)");
    add_choice(c, "--isa", a.isa, "instruction set of the ray tracing");
    c->add_option_function<std::string>(
         "--texture-memory",
         [&a](const std::string& text) { a.texture_bytes = parse_size("--texture-memory", text); },
         "most bytes of texture images: 500M, 2G")
        ->option_text("SIZE");
    c->add_option_function<std::string>(
         "--max-memory",
         [&a](const std::string& text) { a.max_memory = parse_size("--max-memory", text); },
         "refuse renders that need more than 500M, 2G")
        ->option_text("SIZE");
    c->add_option_function<std::string>(
         "--debug-pixel",
         [&a](const std::string& text) { a.debug_pixel = parse_sample("--debug-pixel", text); },
         "trace this one sample and tell its path")
        ->option_text("x,y,sample");
}

}  // namespace

void add_render_options(CLI::App* c, RenderArguments& a) {
    c->add_option("SCENE", a.scene, "the scene: a pbrt-v4 or glTF 2.0 file, or -")
        ->required()
        ->option_text(" ");
    c->add_option("-o,--output", a.output, "the image: .exr .png .pfm .hdr (default: film's)")
        ->check(not_empty())
        ->option_text("FILE");
    add_method_options(c, a);
    add_scene_options(c, a);
    add_output_options(c, a);
    add_film_options(c, a.film);
    add_machine_options(c, a);
}

}  // namespace covtrace::cli
