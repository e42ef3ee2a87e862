#include "cli/render_outputs.h"

#include <algorithm>
#include <system_error>
#include <vector>

#include "cli/frames.h"
#include "cli/message.h"
#include "cli/picture_name.h"
#include "cli/same_file.h"
#include "core/error.h"
#include "image/output_file.h"
#include "image/write_image.h"
#include "render/film_file.h"
#include "render/methods/idle_options.h"

namespace covtrace::cli {

namespace fs = std::filesystem;

namespace {

/// Whether a file is in the working folder or below it, whatever links its path has; the file and
/// its folders need not exist.
bool is_in_working_folder(const fs::path& file) {
    std::error_code error;
    const fs::path here = fs::canonical(".", error);
    const fs::path place =
        fs::weakly_canonical(fs::absolute(OutputFile::resolved(file), error), error);
    return !error &&
           std::mismatch(here.begin(), here.end(), place.begin(), place.end()).first == here.end();
}

/// Throws Error(usage) where the file's folder does not exist, or as OutputFile does where the file
/// cannot be written.
void require_writable(const fs::path& file) {
    const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    std::error_code error;
    if (!fs::is_directory(folder, error))
        throw Error(ErrorKind::usage,
                    "the folder of the output '" + file.string() + "' does not exist");
    const OutputFile probe(file);  // creates a temporary file, and removes it
}

}  // namespace

fs::path image_path(const RenderArguments& a, SceneDescription& scene) {
    if (!a.output.empty()) return a.output;
    const std::string otherwise =
        a.frame ? frame_file(scene.name + ".exr", *a.frame) : scene.name + ".exr";
    if (scene.film.filename.empty()) return otherwise;
    fs::path name = scene.film.filename;
    const fs::path last = name.filename();
    const bool names_file = !last.empty() && last != "." && last != "..";
    // A film that asks for another format gets OpenEXR all the same, which holds all layers, under
    // its own name with another ending.
    if (names_file && name.extension() != ".exr") name.replace_extension(".exr");
    if (names_file && is_in_working_folder(name)) return name;
    const bool may_be_here = names_file && is_in_working_folder(name.filename());
    const fs::path here = may_be_here ? name.filename() : fs::path(otherwise);
    scene.warnings.push_back(
        {scene.film.where, "the film's file '" + scene.film.filename + "' is " +
                               (names_file ? "outside of the working folder" : "a folder") + "; '" +
                               here.string() + "' takes its place (--output writes anywhere)"});
    return here;
}

void check_outputs(const RenderArguments& a, const fs::path& image, const SceneDescription& scene) {
    if (!image.empty()) require_image_name("--output", image, a.layers);
    require_picture_name("--png", a.png);
    std::vector<fs::path> inputs = scene.files;
    inputs.push_back(a.scene);
    if (!a.denoiser.library.empty()) inputs.push_back(a.denoiser.library);
    add_inputs(a.display.options, inputs);
    std::vector<NamedOutput> outputs{{"--output", image}, {"--png", a.png}, {"--stats", a.stats}};
    add_film(outputs, "--checkpoint", a.film.checkpoint);
    // The final film may have the checkpoint's name.
    if (a.film.film != a.film.checkpoint) add_film(outputs, "--film", a.film.film);
    require_distinct(outputs, inputs);
    // A shard only reads the checkpoint, which need not be writable.
    const fs::path checkpoint = a.film.shard ? fs::path() : fs::path(a.film.checkpoint);
    for (const fs::path& file :
         {image, fs::path(a.png), fs::path(a.stats), fs::path(a.film.film), checkpoint})
        if (!file.empty()) require_writable(file);
    for (const fs::path& file : {image, fs::path(a.png), fs::path(a.stats)})
        if (!file.empty()) remove_leftovers(file);
}

void warn_of_idle(const RenderArguments& a, const fs::path& image) {
    const bool insists = a.denoiser.choice == DenoiserChoice::oidn;
    for (const std::string& text : idle_options(a.options, insists)) say("warning: {}\n", text);
    if (a.layer_names && !image.empty() && written_format(image) != WrittenFormat::exr)
        say("warning: --layer-names changes nothing: '{}' holds no layers\n", image.string());
    const bool has_files =
        !(a.png.empty() && a.stats.empty() && a.film.film.empty() && a.film.checkpoint.empty());
    if (a.debug_pixel && has_files)
        say("warning: --debug-pixel: no file is written, but the sample's path is told\n");
}

}  // namespace covtrace::cli
