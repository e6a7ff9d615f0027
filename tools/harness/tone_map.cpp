#include "harness/tone_map.h"

#include "burnish/formats/image_file.h"

namespace burnish {

float exposure_of(const Picture& picture) {
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i < picture.hit.size(); ++i) {
    if (!picture.hit[i]) continue;
    sum += double(luminance(picture.radiance.pixels[i]));
    ++count;
  }
  return sum > 0 ? static_cast<float>(double(kMiddleGrey) * double(count) / sum) : 1;
}

Image tone_map(const Image& radiance, float exposure) {
  Image result(radiance.width, radiance.height);
  for (size_t i = 0; i < result.pixels.size(); ++i)
    result.pixels[i] = (exposure * radiance.pixels[i]).unaryExpr(&srgb_from_linear);
  return result;
}

}  // namespace burnish
