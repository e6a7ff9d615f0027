#pragma once

#include <memory>
#include <string>

#include "burnish/light/environment_map.h"

/// Pictures and animations as render writes them; the extension of a name says what it is.
namespace burnish::tools {

/// Frames a second of a GIF or MP4: a hundredth of a second is all that GIF can tell apart.
inline constexpr int kFramesPerSecond = 25;

/// Whether the name is that of a GIF or MP4, all frames in one file.
bool is_animation(const std::string& path);

/// The name of a frame's file, "dir/dish.png" and 7 as "dir/dish-0007.png".
std::string numbered(const std::string& path, int frame);

/// Writes .exr, linear, or .png, as srgb_bytes. Throws Error(ErrorKind::output).
void write_picture(const Image& image, const std::string& path, float exposure_stops);

/// Frames whose files take their names in commit(), all of them; until then older files stay as
/// they are. Without commit() nothing is left behind.
class FrameOutput {
 public:
  FrameOutput() = default;
  virtual ~FrameOutput() = default;
  FrameOutput(const FrameOutput&) = delete;
  FrameOutput& operator=(const FrameOutput&) = delete;

  /// Appends a frame.
  virtual void add(const Image& image) = 0;
  /// Call it once, last.
  virtual void commit() = 0;
};

/// Numbered pictures for .exr and .png; one file of frames of that size for .gif and .mp4. All
/// errors, here and later, are Error about `path`; Cancelled after Ctrl-C.
std::unique_ptr<FrameOutput> open_frames(const std::string& path, int width, int height,
                                         float exposure_stops);

}  // namespace burnish::tools
