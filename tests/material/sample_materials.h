#pragma once

#include <cmath>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "burnish/material/material.h"
#include "material/published_distributions.h"

/// A material of every model, distribution and shadowing, without a diffuse part, for tests that
/// hold for all.
namespace burnish::test {

struct NamedMaterial {
  std::string name;
  Material material;
};

inline void PrintTo(const NamedMaterial& sample, std::ostream* out) { *out << sample.name; }

/// With a reflectance of one at normal incidence: no light is lost but by shadowing.
inline Material white(SpecularModel model, float alpha_x, float alpha_y) {
  Material material;
  material.diffuse = Rgb::Zero();
  material.model = model;
  material.alpha_x = alpha_x;
  material.alpha_y = alpha_y;
  material.fresnel.normal_reflectance = Rgb::Ones();
  return material;
}

inline Material white_microfacets(Distribution distribution, Shadowing shadowing, float alpha_x,
                                  float alpha_y) {
  Material material = white(SpecularModel::cook_torrance, alpha_x, alpha_y);
  material.distribution = distribution;
  material.shadowing = shadowing;
  return material;
}

/// Two lobes, one of them off the normal.
inline Material two_fitted_lobes() {
  FittedSpecular fitted;
  AnisotropicGaussian<float> lobe;
  lobe.bandwidth_x = 60;
  lobe.bandwidth_y = 5;
  lobe.amplitude = 2;
  fitted.lobes.push_back(lobe);
  lobe.frame = frame_from_axis<float>(Vector3f(0.6f, 0, 0.8f));
  lobe.bandwidth_x = 8;
  fitted.lobes.push_back(lobe);
  fitted.color_by_difference = {Rgb(0.2f, 0.3f, 0.4f), Rgb(0.3f, 0.3f, 0.3f), Rgb::Ones()};
  fitted.masking = {1, 0.9f, 1.5f};
  Material material = white(SpecularModel::fitted, 0.3f, 0.3f);
  material.fitted = std::make_shared<const FittedSpecular>(fitted);
  return material;
}

inline std::vector<NamedMaterial> all_materials() {
  std::vector<NamedMaterial> list;
  const auto add = [&](const std::string& name, const Material& material) {
    list.push_back({name, material});
  };
  for (const auto& [name, model] : {std::pair{"Ward", SpecularModel::ward},
                                    {"WardBalanced", SpecularModel::ward_balanced},
                                    {"Ashikhmin", SpecularModel::ashikhmin_shirley}}) {
    add(std::string(name) + "Narrow", white(model, 0.3f, 0.03f));
    add(std::string(name) + "Turned", white(model, 0.1f, 0.4f));
    add(std::string(name) + "Wide", white(model, 1, 1));
  }
  for (const auto& [distribution_name, distribution] :
       {std::pair{"Beckmann", Distribution::beckmann},
        {"Ggx", Distribution::ggx},
        {"BlinnPhong", Distribution::blinn_phong}})
    for (const auto& [shadowing_name, shadowing] : {std::pair{"Smith", Shadowing::smith},
                                                    {"SmithSeparable", Shadowing::smith_separable},
                                                    {"VCavity", Shadowing::v_cavity}}) {
      const std::string name = std::string(distribution_name) + shadowing_name;
      add(name, white_microfacets(distribution, shadowing, 0.4f, 0.1f));
      add(name + "Wide", white_microfacets(distribution, shadowing, 1, 1));
    }
  add("Fitted", two_fitted_lobes());
  return list;
}

/// Those that a predicate of a Material takes.
template <class Predicate>
std::vector<NamedMaterial> materials_that(const Predicate& predicate) {
  std::vector<NamedMaterial> list = all_materials();
  std::erase_if(list, [&](const NamedMaterial& sample) { return !predicate(sample.material); });
  return list;
}

/// Whose D has alphas.
inline bool has_alphas(const Material& material) { return material.model != SpecularModel::fitted; }

inline Vector3f from_angles(double theta_deg, double phi_deg) {
  const double t = theta_deg * kPi<double> / 180, p = phi_deg * kPi<double> / 180;
  return Vector3d(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)).cast<float>();
}

/// Integral of f(incoming) over incoming directions above the horizon, by nodes over half vectors
/// that follow D: d omega_i = 4 h.o d omega_h.
template <class F>
double integrate_over_half_vectors(const Material& material, const Vector3f& outgoing, const F& f,
                                   int azimuths = 64) {
  const Vector3d o = outgoing.cast<double>();
  double sum = 0;
  for (const Node& node : hemisphere_nodes(material.alpha_x, material.alpha_y, azimuths)) {
    const double cos_d = o.dot(node.direction);
    if (cos_d <= 0) continue;
    const Vector3d i = 2 * cos_d * node.direction - o;
    if (i.z() <= 0) continue;
    sum += node.weight * 4 * cos_d * f(Vector3f(i.cast<float>().normalized()));
  }
  return sum;
}

/// What the specular part's first channel reflects of light from everywhere.
inline double specular_albedo(const Material& material, const Vector3f& outgoing) {
  return integrate_over_half_vectors(material, outgoing, [&](const Vector3f& i) {
    return double(eval_specular_brdf(material, outgoing, i).x()) * double(i.z());
  });
}

}  // namespace burnish::test
