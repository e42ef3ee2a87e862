// The part of Open Image Denoise's interface that covtrace uses, around a box of 3 x 3 pixels. One
// of the definitions FAKE_… says what is wrong with it. Where the environment has
// FAKE_OIDN_THREADS, no other number of threads is accepted; where it has FAKE_OIDN_IMAGES, "color
// albedo", no others for light; where it has FAKE_OIDN_QUALITY, no other quality for light; where
// it has FAKE_OIDN_FEATURES, "clean" or "noisy", no others beside light.
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <thread>
#include <vector>

namespace {

#ifdef FAKE_VERSION_ONE
constexpr int kVersion = 10403;
#elif defined(FAKE_VERSION_TWO)
constexpr int kVersion = 20201;
#else
constexpr int kVersion = 20399;
#endif

struct Device {
    int threads = 0;
    const char* error = nullptr;
};

struct Filter {
    Device* device = nullptr;
    const float* input = nullptr;
    float* output = nullptr;
    size_t width = 0, height = 0;
    std::string images;  // the names of its inputs, in order
    int quality = 0;
    bool has_clean_features = false;
};

#ifdef FAKE_NO_DEVICE
const char* no_device = "no CPU that this library supports";
#endif

void blur(const Filter& f) {
    const std::vector<float> in(f.input, f.input + 3 * f.width * f.height);
    for (size_t y = 0; y < f.height; ++y)
        for (size_t x = 0; x < f.width; ++x)
            for (size_t c = 0; c < 3; ++c) {
                float sum = 0, count = 0;
                for (size_t v = y - (y > 0); v <= y + 1 && v < f.height; ++v)
                    for (size_t u = x - (x > 0); u <= x + 1 && u < f.width; ++u) {
                        sum += in[3 * (v * f.width + u) + c];
                        ++count;
                    }
                f.output[3 * (y * f.width + x) + c] = sum / count;
            }
}

}  // namespace

extern "C" {

Device* oidnNewDevice(int) {
#ifdef FAKE_NO_DEVICE
    return nullptr;
#else
    return new Device;
#endif
}

void oidnReleaseDevice(Device* device) {
    delete device;
}

void oidnSetDeviceBool(Device*, const char*, bool) {}

void oidnSetDeviceInt(Device* device, const char* name, int value) {
    if (std::strcmp(name, "numThreads") == 0) device->threads = value;
}

int oidnGetDeviceInt(Device*, const char* name) {
    return std::strcmp(name, "version") == 0 ? kVersion : 0;
}

void oidnCommitDevice(Device* device) {
#ifdef FAKE_COMMIT_FAILS
    device->error = "the device is out of order";
#endif
    const char* threads = std::getenv("FAKE_OIDN_THREADS");
    if (threads && std::atoi(threads) != device->threads)
        device->error = "another number of threads";
}

int oidnGetDeviceError(Device* device, const char** message) {
#ifdef FAKE_NO_DEVICE
    if (!device) {
        *message = no_device;
        return 1;
    }
#endif
    *message = device->error;
    device->error = nullptr;
    return *message ? 1 : 0;
}

Filter* oidnNewFilter(Device* device, const char*) {
    return new Filter{.device = device};
}

void oidnReleaseFilter(Filter* filter) {
    delete filter;
}

void oidnSetSharedFilterImage(Filter* filter, const char* name, void* data, int, size_t width,
                              size_t height, size_t, size_t, size_t) {
    if (std::strcmp(name, "output") != 0)
        filter->images += (filter->images.empty() ? "" : " ") + std::string(name);
    if (std::strcmp(name, "output") == 0)
        filter->output = static_cast<float*>(data);
    else if (std::strcmp(name, "color") == 0 || !filter->input)
        filter->input = static_cast<const float*>(data);
    filter->width = width;
    filter->height = height;
}

void oidnSetFilterBool(Filter* filter, const char* name, bool value) {
    if (std::strcmp(name, "cleanAux") == 0) filter->has_clean_features = value;
}
void oidnSetFilterInt(Filter* filter, const char* name, int value) {
    if (std::strcmp(name, "quality") == 0) filter->quality = value;
}

#ifndef FAKE_LACKS_A_FUNCTION
void oidnCommitFilter(Filter*) {}
#endif

void oidnExecuteFilter(Filter* filter) {
    const char* images = std::getenv("FAKE_OIDN_IMAGES");
    if (images && filter->images.starts_with("color") && filter->images != images)
        filter->device->error = "the filter gets other images";
    const char* quality = std::getenv("FAKE_OIDN_QUALITY");
    if (quality && filter->images.starts_with("color") && filter->quality != std::atoi(quality))
        filter->device->error = "the filter gets another quality";
    // Features are cleaned by filters of their own
    const char* features = std::getenv("FAKE_OIDN_FEATURES");
    const bool wants_clean = features && std::strcmp(features, "clean") == 0;
    const bool is_of_light = filter->images.starts_with("color");
    if (features && (is_of_light ? filter->has_clean_features != wants_clean : !wants_clean))
        filter->device->error = "the filter gets other features";
#ifdef FAKE_EXECUTE_FAILS
    filter->device->error = "the filter is out of order";
#else
    blur(*filter);
#endif
#ifdef FAKE_SLOW
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
#endif
#ifdef FAKE_NOT_A_NUMBER
    for (size_t i = 0; i < 3 * filter->width * filter->height; i += 7)
        filter->output[i] = i % 2 ? std::numeric_limits<float>::infinity() : std::nanf("");
#endif
}

}  // extern "C"
