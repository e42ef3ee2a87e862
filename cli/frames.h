/// The frames of an animation: which are rendered, when each is exposed, and what its files are
/// called.
#pragma once

#include <string>

#include "cli/render_options.h"

namespace covtrace::cli {

/// Reads the frames of --frames: "12", "0-47", or "0-47x4" for every fourth. Throws Error(usage)
/// for any other text.
FrameRange parse_frames(const std::string& option, const std::string& text);

/// A file's name for one frame: the last run of '#' in it becomes the frame's number, with at least
/// as many digits; without '#', ".0012" comes before the ending. "" and names of streams, as
/// /dev/stdout, stay as they are.
std::string frame_file(const std::string& file, int frame);

/// The arguments of one frame. Its shutter is that of `a`, or half a frame from 0 on, later by the
/// frame's time; its seed is that of `a` plus the frame's number, so that noise does not stand
/// still; its files are called by frame_file. Throws Error(usage) where the frame is too late for
/// the length of its exposure.
RenderArguments at_frame(const RenderArguments& a, int frame);

}  // namespace covtrace::cli
