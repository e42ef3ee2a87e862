#include "denoiser/oidn_denoiser.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "denoiser/input_range.h"
#include "denoiser/oidn_library.h"

namespace covtrace {

namespace {

/// Limit of memory for the network's own values, kBytes of them per pixel. Larger images are
/// denoised in tiles that overlap, to the same bits.
constexpr int kMostMegabytes = 2000;
constexpr size_t kBytes = 700;
/// Memory of the library and its weights.
constexpr size_t kLibraryBytes = size_t(64) << 20;
/// The first version with the quality kFast, 2.3.0.
constexpr int kFirstWithFast = 20300;

/// Whether a feature tells anything: one that is 0 everywhere is not known.
bool is_known(const std::array<Plane, 3>& feature) {
    return std::any_of(feature.begin(), feature.end(), [](const Plane& p) {
        return std::any_of(p.values.begin(), p.values.end(), [](float v) { return v != 0; });
    });
}

/// Three planes in the layout of the library's pixels.
class Pixels {
  public:
    Pixels(const std::array<Plane, 3>& planes, const InputRange& range)
        : planes_(planes), range_(range), values_(3 * planes[0].size()) {
        for (size_t i = 0; i < planes[0].size(); ++i) read(i);
    }
    size_t width() const { return size_t(planes_[0].width); }
    size_t height() const { return size_t(planes_[0].height); }
    float* data() { return values_.data(); }
    /// Turns the library's input or output by half a turn.
    void turn() {
        for (size_t i = 0, j = values_.size(); i + 3 < j; i += 3) {
            j -= 3;
            std::swap_ranges(&values_[i], &values_[i] + 3, &values_[j]);
        }
        turned_ = !turned_;
    }
    /// Restores pixels for which the library left values that are not finite to what they were
    /// before.
    void repair() {
        for (size_t i = 0; i < planes_[0].size(); ++i) {
            const float* v = &values_[3 * place(i)];
            if (!std::isfinite(v[0]) || !std::isfinite(v[1]) || !std::isfinite(v[2])) read(i);
        }
    }
    std::array<Plane, 3> planes() const {
        std::array<Plane, 3> result = planes_;
        for (size_t c = 0; c < 3; ++c)
            for (size_t i = 0; i < result[c].size(); ++i)
                result[c][i] = range_.from_network(values_[3 * place(i) + c]);
        return result;
    }

  private:
    void read(size_t i) {
        for (size_t c = 0; c < 3; ++c) values_[3 * place(i) + c] = range_.to_network(planes_[c][i]);
    }
    size_t place(size_t i) const { return turned_ ? planes_[0].size() - 1 - i : i; }
    const std::array<Plane, 3>& planes_;
    const InputRange range_;
    std::vector<float> values_;
    bool turned_ = false;
};

}  // namespace

struct OidnDenoiser::Impl {
    explicit Impl(oidn::Library library)
        : api(library.api), file(std::move(library.file)), device(api.new_device(oidn::kCpu)) {
        if (!device) throw Error(ErrorKind::usage, file.string() + ": " + error());
        const int number = api.get_device_int(device, "version");
        if (number >= kFirstWithFast) draft = oidn::kFast;
        version = std::to_string(number / 10000) + "." + std::to_string(number / 100 % 100) + "." +
                  std::to_string(number % 100);
        try {
            if (number / 10000 != 2)
                throw Error(ErrorKind::usage, file.string() + ": is version " + version +
                                                  "; expected Open Image Denoise 2");
            // The library's threads are those of the render, which may share the machine.
            api.set_device_bool(device, "setAffinity", false);
            api.set_device_int(device, "numThreads", ThreadLimit::current());
            api.commit_device(device);
            if (const std::string message = error(); !message.empty())
                throw Error(ErrorKind::usage, file.string() + ": " + message);
        } catch (...) {
            api.release_device(device);
            throw;
        }
    }
    ~Impl() { api.release_device(device); }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    /// The library's message of its first error; empty where there was none.
    std::string error() const {
        const char* message = nullptr;
        if (api.get_device_error(device, &message) == 0) return {};
        return message && *message ? message : "unknown error";
    }
    std::string name() const { return "Open Image Denoise " + version; }
    void check() const {
        const std::string message = error();
        if (!message.empty()) throw Error(ErrorKind::limit, name() + ": " + message);
    }

    struct Input {
        const char* name;
        Pixels& pixels;
    };
    struct FilterSettings {
        oidn::Quality quality;
        bool hdr = false;
        bool clean_features = false;
    };
    struct Release {
        const oidn::Api* api;
        void operator()(oidn::Filter f) const { api->release_filter(f); }
    };
    /// Filters that are no longer used, but whose working memory the next ones share: to ask for
    /// it anew takes a tenth of the time.
    using Filters = std::vector<std::unique_ptr<oidn::OIDNFilterImpl, Release>>;
    /// Denoises the first input in place, guided by the others, by a filter that it leaves in
    /// `filters`.
    void filter(const std::vector<Input>& inputs, const FilterSettings& settings,
                Filters& filters) const {
        filters.emplace_back(api.new_filter(device, "RT"), Release{&api});
        const oidn::Filter f = filters.back().get();
        check();
        const auto set = [&](const char* name, Pixels& p) {
            api.set_image(f, name, p.data(), oidn::kFloat3, p.width(), p.height(), 0, 0, 0);
        };
        for (const Input& input : inputs) set(input.name, input.pixels);
        set("output", inputs.begin()->pixels);
        if (settings.hdr) api.set_filter_bool(f, "hdr", true);
        if (settings.clean_features) api.set_filter_bool(f, "cleanAux", true);
        api.set_filter_int(f, "quality", settings.quality);
        api.set_filter_int(f, "maxMemoryMB", kMostMegabytes);
        api.commit_filter(f);
        api.execute_filter(f);
        check();
        inputs.begin()->pixels.repair();
    }

    const oidn::Api api;
    const std::filesystem::path file;
    const oidn::Device device;
    std::string version;
    oidn::Quality draft = oidn::kBalanced;  ///< quality of images that are drafts
};

OidnDenoiser::OidnDenoiser(const std::filesystem::path& file)
    : impl_(std::make_unique<Impl>(oidn::load_library(file))) {}

OidnDenoiser::~OidnDenoiser() = default;

std::vector<ColorPlanes> OidnDenoiser::denoise(const NoisyFeatures& features,
                                               std::vector<NoisyImage> images) const try {
    Pixels albedo(features.albedo, InputRange()), normal(features.normal, InputRange());
    // The library takes normals only beside an albedo.
    const bool has_albedo = is_known(features.albedo),
               has_normal = has_albedo && is_known(features.normal),
               cleans = features.cleaning != FeatureCleaning::none;
    const oidn::Quality quality =
        features.cleaning == FeatureCleaning::draft ? oidn::kBalanced : oidn::kHigh;
    Impl::Filters filters;
    if (cleans && has_albedo) impl_->filter({{"albedo", albedo}}, {.quality = quality}, filters);
    if (cleans && has_normal) impl_->filter({{"normal", normal}}, {.quality = quality}, filters);
    bool turned = false;
    std::vector<ColorPlanes> results;
    for (NoisyImage& image : images) {
        const InputRange light(image.color);
        if (light.is_dark()) {  // in black images networks see light that is not there
            const Plane black(image.color[0].width, image.color[0].height);
            results.push_back({black, black, black});
            continue;
        }
        Pixels color(image.color, light);
        if (image.turned != turned) {
            albedo.turn();
            normal.turn();
            turned = image.turned;
        }
        if (turned) color.turn();
        std::vector<Impl::Input> inputs{{"color", color}};
        if (has_albedo) inputs.push_back({"albedo", albedo});
        if (has_normal) inputs.push_back({"normal", normal});
        // The library has weights for features without noise where it gets both of them.
        impl_->filter(inputs,
                      {.quality = image.draft ? impl_->draft : oidn::kHigh,
                       .hdr = true,
                       .clean_features = cleans && has_normal},
                      filters);
        results.push_back(color.planes());
        image = {};
    }
    return results;
} catch (const std::bad_alloc&) {
    throw Error(ErrorKind::limit, name() + ": not enough memory");
}

size_t OidnDenoiser::memory(size_t pixels) const {
    constexpr size_t kPixels = 9 * sizeof(float);
    return kLibraryBytes + kPixels * pixels +
           std::min(kBytes * pixels, size_t(kMostMegabytes) << 20);
}

std::string OidnDenoiser::name() const {
    return impl_->name();
}

const std::filesystem::path& OidnDenoiser::file() const {
    return impl_->file;
}

}  // namespace covtrace
