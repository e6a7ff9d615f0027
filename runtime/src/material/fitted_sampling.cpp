#include "material/fitted_sampling.h"

#include "burnish/sphere/asg_sampling.h"

namespace burnish::internal {
namespace {

float total_integral(const FittedSpecular& fitted) {
  float sum = 0;
  for (const AnisotropicGaussian<float>& lobe : fitted.lobes) sum += integral(lobe);
  return sum;
}

}  // namespace

Vector3f sample_fitted_half(const FittedSpecular& fitted, float u, float v) {
  // A lobe by its share of u; what is left of u is uniform again.
  const float target = u * total_integral(fitted);
  float before = 0;
  const AnisotropicGaussian<float>* last = &fitted.lobes.front();
  for (const AnisotropicGaussian<float>& lobe : fitted.lobes) {
    const float share = integral(lobe);
    if (!(share > 0)) continue;
    if (target < before + share) return sample(lobe, (target - before) / share, v);
    before += share;
    last = &lobe;
  }
  return sample(*last, 1.0f, v);  // u was rounded up
}

float pdf_fitted_half(const FittedSpecular& fitted, const Vector3f& half) {
  const float total = total_integral(fitted);
  return total > 0 ? eval_distribution(fitted, half) / total : 0.0f;
}

}  // namespace burnish::internal
