#include "burnish/material/fresnel.h"

#include <algorithm>

namespace burnish {

Rgb eval_fresnel(const Fresnel& fresnel, float cos_difference) {
  const float m = std::clamp(1 - cos_difference, 0.0f, 1.0f);
  const float m5 = m * m * m * m * m;
  return fresnel.normal_reflectance + (1 - fresnel.normal_reflectance) * m5;
}

}  // namespace burnish
