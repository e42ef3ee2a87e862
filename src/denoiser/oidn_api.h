/// The part of Open Image Denoise's C interface that is used, as its version 2 has it
/// (github.com/RenderKit/oidn, include/OpenImageDenoise/oidn.h): the library is looked for when the
/// program runs, and no header of it is needed to build.
#pragma once

#include <cstddef>

namespace covtrace::oidn {

using Device = struct OIDNDeviceImpl*;
using Filter = struct OIDNFilterImpl*;

enum DeviceType : int { kCpu = 1 };
enum Format : int { kFloat3 = 3 };
enum Quality : int { kFast = 4, kBalanced = 5, kHigh = 6 };

/// Functions of the library; every pointer is set.
struct Api {
    Device (*new_device)(DeviceType);
    void (*release_device)(Device);
    void (*set_device_bool)(Device, const char* name, bool);
    void (*set_device_int)(Device, const char* name, int);
    int (*get_device_int)(Device, const char* name);
    void (*commit_device)(Device);
    /// The first error since the last call, 0 if there was none, and its message.
    int (*get_device_error)(Device, const char** message);
    Filter (*new_filter)(Device, const char* type);
    void (*release_filter)(Filter);
    void (*set_image)(Filter, const char* name, void* data, Format, size_t width, size_t height,
                      size_t offset, size_t pixel_stride, size_t row_stride);
    void (*set_filter_bool)(Filter, const char* name, bool);
    void (*set_filter_int)(Filter, const char* name, int);
    void (*commit_filter)(Filter);
    void (*execute_filter)(Filter);
};

}  // namespace covtrace::oidn
