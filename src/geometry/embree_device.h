/// Embree's handles as owners, and its errors as covtrace::Error. Only for .cpp files of this
/// folder.
#pragma once

#include <embree3/rtcore.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <type_traits>

namespace covtrace {

template <auto release>
struct EmbreeRelease {
    template <class T>
    void operator()(T* handle) const {
        release(handle);
    }
};
using SceneHandle = std::unique_ptr<RTCSceneTy, EmbreeRelease<rtcReleaseScene>>;
using GeometryHandle = std::unique_ptr<RTCGeometryTy, EmbreeRelease<rtcReleaseGeometry>>;

class EmbreeDevice {
  public:
    /// `isa`: empty, or one of sse2, avx, avx2, avx512. Throws Error(limit) where memory runs out,
    /// Error(internal) where Embree can't start.
    explicit EmbreeDevice(const std::string& isa);
    /// The instruction set in use: sse2, avx, avx2 or avx512.
    const std::string& isa() const { return isa_; }
    ~EmbreeDevice();
    EmbreeDevice(const EmbreeDevice&) = delete;
    EmbreeDevice& operator=(const EmbreeDevice&) = delete;

    RTCDevice get() const { return device_; }
    /// Makes an empty scene for a static or moving hierarchy.
    SceneHandle new_scene() const;
    /// Builds the hierarchy of `scene`.
    void commit(RTCScene scene) const;
    /// Throws the error that Embree has reported since the last call, if any: Error(limit) where
    /// memory ran out.
    void check() const;
    /// Most bytes that Embree has held at a time, temporary ones of building included.
    size_t most_bytes() const { return static_cast<size_t>(most_bytes_.load()); }

  private:
    static void on_error(void* self, RTCError code, const char* message);
    static bool on_memory(void* self, ssize_t bytes, bool post);

    std::string isa_;
    RTCDevice device_ = nullptr;
    mutable std::mutex mutex_;
    mutable RTCError code_ = RTC_ERROR_NONE;
    mutable std::string message_;
    std::atomic<int64_t> bytes_{0}, most_bytes_{0};
};

}  // namespace covtrace
