#include "frame_output.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "burnish/formats/image_file.h"
#include "common/options.h"
#include "video_file.h"

namespace burnish::tools {
namespace {

namespace fs = std::filesystem;

/// Frames are written into a hidden folder beside their target.
class PictureSequence : public FrameOutput {
 public:
  PictureSequence(const std::string& target, float exposure_stops)
      : target_(target), exposure_stops_(exposure_stops) {
    std::string name = (target_.parent_path() / ".burnish-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw Error(ErrorKind::output, target,
                  fmt::format("cannot create a folder beside it: {}", std::strerror(errno)));
    folder_ = name;
  }
  ~PictureSequence() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  void add(const Image& image) override {
    write_picture(image, numbered(hidden(), count_), exposure_stops_);
    ++count_;
  }

  void commit() override {
    for (int frame = 0; frame < count_; ++frame) {
      const std::string name = numbered(target_.string(), frame);
      std::error_code error;
      fs::rename(numbered(hidden(), frame), name, error);
      if (error) throw Error(ErrorKind::output, name, "cannot take its name: " + error.message());
    }
  }

 private:
  std::string hidden() const { return (folder_ / target_.filename()).string(); }

  fs::path target_, folder_;
  float exposure_stops_;
  int count_ = 0;
};

}  // namespace

bool is_animation(const std::string& path) {
  const std::string extension = lower_extension(path);
  return extension == ".gif" || extension == ".mp4";
}

std::string numbered(const std::string& path, int frame) {
  const fs::path file(path);
  const std::string name =
      fmt::format("{}-{:04}{}", file.stem().string(), frame, file.extension().string());
  return (file.parent_path() / name).string();
}

void write_picture(const Image& image, const std::string& path, float exposure_stops) {
  if (lower_extension(path) == ".exr")
    write_exr(image, path);
  else
    write_png(image, path, exposure_stops);
}

std::unique_ptr<FrameOutput> open_frames(const std::string& path, int width, int height,
                                         float exposure_stops) {
  if (is_animation(path)) return std::make_unique<VideoFile>(path, width, height, exposure_stops);
  return std::make_unique<PictureSequence>(path, exposure_stops);
}

}  // namespace burnish::tools
