#include "denoiser/oidn_denoiser.h"

#include <dlfcn.h>

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "denoiser/oidn_api.h"

namespace covtrace {

namespace {

using oidn::Api;

/// dlopen()'s handle; never closed: the library's own threads may outlive every use of it.
void* load(const std::filesystem::path& file) {
    void* library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library) return library;
    const char* why = ::dlerror();
    throw Error(ErrorKind::usage, why ? why : file.string() + ": cannot be loaded");
}

template <typename Function>
void find(void* library, const std::filesystem::path& file, const char* name, Function& function) {
    void* symbol = ::dlsym(library, name);
    if (!symbol)
        throw Error(ErrorKind::usage, file.string() + ": has no function " + name +
                                          "; expected Open Image Denoise 2");
    function = reinterpret_cast<Function>(symbol);
}

Api functions_of(void* library, const std::filesystem::path& file) {
    Api api{};
    find(library, file, "oidnNewDevice", api.new_device);
    find(library, file, "oidnReleaseDevice", api.release_device);
    find(library, file, "oidnSetDeviceBool", api.set_device_bool);
    find(library, file, "oidnSetDeviceInt", api.set_device_int);
    find(library, file, "oidnGetDeviceInt", api.get_device_int);
    find(library, file, "oidnCommitDevice", api.commit_device);
    find(library, file, "oidnGetDeviceError", api.get_device_error);
    find(library, file, "oidnNewFilter", api.new_filter);
    find(library, file, "oidnReleaseFilter", api.release_filter);
    find(library, file, "oidnSetSharedFilterImage", api.set_image);
    find(library, file, "oidnSetFilterBool", api.set_filter_bool);
    find(library, file, "oidnSetFilterInt", api.set_filter_int);
    find(library, file, "oidnCommitFilter", api.commit_filter);
    find(library, file, "oidnExecuteFilter", api.execute_filter);
    return api;
}

std::filesystem::path place_of(const void* symbol, const std::filesystem::path& otherwise) {
    Dl_info info{};
    return ::dladdr(symbol, &info) && info.dli_fname ? info.dli_fname : otherwise;
}

/// Three planes as the library has pixels.
class Pixels {
  public:
    Pixels(const std::array<Plane, 3>& planes)
        : width_(size_t(planes[0].width)),
          height_(size_t(planes[0].height)),
          values_(3 * planes[0].size()) {
        for (size_t c = 0; c < 3; ++c)
            for (size_t i = 0; i < planes[c].size(); ++i) values_[3 * i + c] = planes[c][i];
    }
    size_t width() const { return width_; }
    size_t height() const { return height_; }
    float* data() { return values_.data(); }
    void write_to(std::array<Plane, 3>& planes) const {
        for (size_t c = 0; c < 3; ++c)
            for (size_t i = 0; i < planes[c].size(); ++i) planes[c][i] = values_[3 * i + c];
    }

  private:
    size_t width_, height_;
    std::vector<float> values_;
};

}  // namespace

struct OidnDenoiser::Impl {
    explicit Impl(const std::filesystem::path& path) {
        void* library = load(path);
        api = functions_of(library, path);
        file = place_of(reinterpret_cast<const void*>(api.new_device), path);
        device = api.new_device(oidn::kCpu);
        if (!device) throw Error(ErrorKind::usage, file.string() + ": " + error());
        const int number = api.get_device_int(device, "version");
        version = std::to_string(number / 10000) + "." + std::to_string(number / 100 % 100) + "." +
                  std::to_string(number % 100);
        try {
            if (number / 10000 != 2)
                throw Error(ErrorKind::usage, file.string() + ": is version " + version +
                                                  "; expected Open Image Denoise 2");
            // Its threads are those of the render, which may share the machine.
            api.set_device_bool(device, "setAffinity", false);
            api.set_device_int(device, "numThreads", ThreadLimit::current());
            api.commit_device(device);
            check(ErrorKind::usage);
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
    void check(ErrorKind kind) const {
        const std::string message = error();
        if (!message.empty()) throw Error(kind, file.string() + ": " + message);
    }

    struct Input {
        const char* name;
        Pixels& pixels;
    };
    /// Denoises the first input in place, guided by the others.
    void filter(std::initializer_list<Input> inputs, bool hdr) const {
        const auto release = [this](oidn::Filter f) { api.release_filter(f); };
        const std::unique_ptr<oidn::OIDNFilterImpl, decltype(release)> f(
            api.new_filter(device, "RT"), release);
        check(ErrorKind::limit);
        const auto set = [&](const char* name, Pixels& p) {
            api.set_image(f.get(), name, p.data(), oidn::kFloat3, p.width(), p.height(), 0, 0, 0);
        };
        for (const Input& input : inputs) set(input.name, input.pixels);
        set("output", inputs.begin()->pixels);
        if (hdr) {
            api.set_filter_bool(f.get(), "hdr", true);
            api.set_filter_bool(f.get(), "cleanAux", true);
        }
        api.set_filter_int(f.get(), "quality", oidn::kHigh);
        api.commit_filter(f.get());
        api.execute_filter(f.get());
        check(ErrorKind::limit);
    }

    Api api;
    std::filesystem::path file;
    std::string version;
    oidn::Device device = nullptr;
};

OidnDenoiser::OidnDenoiser(const std::filesystem::path& file)
    : impl_(std::make_unique<Impl>(file)) {}

OidnDenoiser::~OidnDenoiser() = default;

std::vector<ColorPlanes> OidnDenoiser::denoise(std::vector<NoisyImage> images) const {
    std::vector<ColorPlanes> results;
    for (NoisyImage& image : images) {
        Pixels color(image.color), albedo(image.albedo), normal(image.normal);
        impl_->filter({{"albedo", albedo}}, false);
        impl_->filter({{"normal", normal}}, false);
        impl_->filter({{"color", color}, {"albedo", albedo}, {"normal", normal}}, true);
        color.write_to(image.color);
        results.push_back(std::move(image.color));
    }
    return results;
}

std::string OidnDenoiser::name() const {
    return "Open Image Denoise " + impl_->version;
}

const std::filesystem::path& OidnDenoiser::file() const {
    return impl_->file;
}

}  // namespace covtrace
