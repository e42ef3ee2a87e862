#include "geometry/embree_device.h"

#include "core/error.h"

namespace covtrace {

namespace {

/// The instruction set that Embree chose by itself, told from the widest packets that it traces
/// natively.
std::string chosen_isa(RTCDevice device) {
    if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)) return "avx512";
    if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED))
        return __builtin_cpu_supports("avx2") ? "avx2" : "avx";
    return "sse2";
}

}  // namespace

EmbreeDevice::EmbreeDevice(const std::string& isa) : isa_(isa) {
    device_ = rtcNewDevice(isa.empty() ? nullptr : ("isa=" + isa).c_str());
    if (!device_) {
        if (rtcGetDeviceError(nullptr) == RTC_ERROR_OUT_OF_MEMORY)
            throw Error(ErrorKind::limit, "not enough memory to start the ray tracing");
        throw Error(ErrorKind::internal,
                    "Embree can't be started" + (isa.empty() ? "" : " with isa=" + isa));
    }
    if (!rtcGetDeviceProperty(device_, RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED)) {
        rtcReleaseDevice(device_);
        throw Error(ErrorKind::internal,
                    "this Embree was built without ray masks, which are needed");
    }
    if (isa_.empty()) isa_ = chosen_isa(device_);
    rtcSetDeviceErrorFunction(device_, &EmbreeDevice::on_error, this);
    rtcSetDeviceMemoryMonitorFunction(device_, &EmbreeDevice::on_memory, this);
}

EmbreeDevice::~EmbreeDevice() {
    rtcSetDeviceErrorFunction(device_, nullptr, nullptr);
    rtcReleaseDevice(device_);
}

SceneHandle EmbreeDevice::new_scene() const {
    SceneHandle scene(rtcNewScene(device_));
    check();
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
    return scene;
}

void EmbreeDevice::commit(RTCScene scene) const {
    rtcCommitScene(scene);
    check();
}

void EmbreeDevice::check() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (code_ == RTC_ERROR_NONE) return;
    const bool memory = code_ == RTC_ERROR_OUT_OF_MEMORY;
    const std::string text = memory ? "out of memory while building the ray tracing hierarchy"
                                    : "Embree failed: " + message_;
    code_ = RTC_ERROR_NONE;
    throw Error(memory ? ErrorKind::limit : ErrorKind::internal, text);
}

void EmbreeDevice::on_error(void* self, RTCError code, const char* message) {
    auto& device = *static_cast<EmbreeDevice*>(self);
    const std::lock_guard<std::mutex> lock(device.mutex_);
    if (device.code_ != RTC_ERROR_NONE) return;
    device.code_ = code;
    device.message_ = message ? message : "";
}

bool EmbreeDevice::on_memory(void* self, ssize_t bytes, bool) {
    auto& device = *static_cast<EmbreeDevice*>(self);
    const int64_t now = device.bytes_ += bytes;
    int64_t most = device.most_bytes_;
    while (now > most && !device.most_bytes_.compare_exchange_weak(most, now)) {
    }
    return true;
}

}  // namespace covtrace
