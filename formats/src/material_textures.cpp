#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "burnish/formats/material_file.h"
#include "burnish/formats/texture_file.h"
#include "burnish/material/roughness.h"
#include "file_bytes.h"
#include "png_reader.h"

namespace burnish {
namespace {

/// Reads the textures of one file.
class PictureReader {
 public:
  explicit PictureReader(const std::string& path)
      : folder_(std::filesystem::path(path).parent_path()) {}

  std::optional<Image> read(const std::optional<TextureFile>& texture,
                            TextureContent content) const {
    if (!texture) return {};
    Image image = read_texture(path_of(*texture), content);
    if (texture->scale == 1 && texture->offset == 0) return image;
    for (Rgb& pixel : image.pixels) {
      pixel = texture->offset + texture->scale * pixel;
      if (!pixel.allFinite())
        throw Error(ErrorKind::input, path_of(*texture),
                    fmt::format("a value is beyond the range of a float with a scale of {}",
                                texture->scale));
    }
    return image;
  }

  /// A PNG's 0..1 stand for -1..1.
  std::optional<Image> read_normal(const std::optional<TextureFile>& texture) const {
    std::optional<Image> image = read(texture, TextureContent::data);
    if (image && read_file_start(path_of(*texture), kPngSignature.size()) == kPngSignature)
      for (Rgb& pixel : image->pixels) pixel = 2 * pixel - 1;
    return image;
  }

 private:
  std::string path_of(const TextureFile& texture) const {
    return (folder_ / texture.file).string();
  }

  std::filesystem::path folder_;
};

}  // namespace

MaterialPictures read_material_pictures(const MaterialFile& material, const std::string& path) {
  const PictureReader reader(path);
  const MaterialTextures& textures = material.textures;
  MaterialPictures pictures;
  pictures.diffuse = reader.read(textures.diffuse, TextureContent::color);
  pictures.specular = reader.read(textures.specular, TextureContent::color);
  pictures.alpha_x = reader.read(textures.alpha_x, TextureContent::data);
  pictures.alpha_y = reader.read(textures.alpha_y, TextureContent::data);
  pictures.tangent_rotation_rad = reader.read(textures.tangent_rotation_rad, TextureContent::data);
  pictures.normal = reader.read_normal(textures.normal);
  if (textures.roughness) {
    pictures.alpha_x = reader.read(textures.roughness, TextureContent::data);
    for (Rgb& pixel : pictures.alpha_x->pixels)
      pixel = Rgb::Constant(alpha_from_roughness(std::clamp(pixel[0], 0.0f, kMaxRoughness)));
    pictures.alpha_y = pictures.alpha_x;
  }
  return pictures;
}

}  // namespace burnish
