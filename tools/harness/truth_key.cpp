#include "harness/content_hash.h"
#include "harness/vertex_truth.h"

namespace burnish {
namespace {

void add(ContentHash& hash, const FittedSpecular& fitted) {
  hash.add(fitted.lobes.size());
  for (const AnisotropicGaussian<float>& lobe : fitted.lobes) {
    for (const Vector3f& axis : {lobe.frame.x, lobe.frame.y, lobe.frame.z}) hash.add(axis);
    for (const float value : {lobe.bandwidth_x, lobe.bandwidth_y, lobe.amplitude}) hash.add(value);
  }
  hash.add(fitted.color_by_difference);
  hash.add(fitted.masking);
}

void add(ContentHash& hash, const Material& material) {
  hash.add(material.diffuse);
  hash.add(material.specular);
  hash.add(material.model);
  hash.add(material.alpha_x);
  hash.add(material.alpha_y);
  hash.add(material.fresnel.model);
  hash.add(material.fresnel.normal_reflectance);
  hash.add(material.fresnel.eta);
  hash.add(material.fresnel.k);
  hash.add(material.distribution);
  hash.add(material.shadowing);
  hash.add(material.fitted != nullptr);
  if (material.fitted) add(hash, *material.fitted);
}

void add(ContentHash& hash, const Image& image) {
  hash.add(image.width);
  hash.add(image.height);
  hash.add(image.pixels);
}

void add(ContentHash& hash, const std::optional<Texture>& texture) {
  hash.add(texture.has_value());
  if (!texture) return;
  hash.add(texture->wrap);
  hash.add(texture->levels.size());
  for (const Image& level : texture->levels) add(hash, level);
}

void add(ContentHash& hash, const VaryingSubject& varying) {
  for (const auto* texture :
       {&varying.maps.diffuse, &varying.maps.specular, &varying.maps.slope, &varying.maps.moments})
    add(hash, *texture);
  const MaterialArrays& arrays = varying.vertices;
  for (const auto* colors : {&arrays.diffuse, &arrays.specular}) hash.add(*colors);
  for (const auto* values : {&arrays.alpha_x, &arrays.alpha_y, &arrays.tangent_rotation_rad})
    hash.add(*values);
  hash.add(arrays.normal);
}

void add(ContentHash& hash, const Subject& subject) {
  const Transfer& transfer = *subject.transfer;
  for (const auto* vectors :
       {&transfer.positions, &transfer.normals, &transfer.tangents, &transfer.occluder_positions})
    hash.add(*vectors);
  for (const auto* triangles : {&transfer.triangles, &transfer.occluder_triangles})
    hash.add(*triangles);
  hash.add(subject.materials.size());
  for (const Material& material : subject.materials) add(hash, material);
  hash.add(subject.material_id);
  hash.add(subject.varying != nullptr);
  if (!subject.varying) return;
  hash.add(transfer.texcoords);
  add(hash, *subject.varying);
}

void add(ContentHash& hash, const ReferenceLights& lights) {
  hash.add(lights.environment.map != nullptr);
  if (lights.environment.map) add(hash, *lights.environment.map);
  for (int column = 0; column < 3; ++column)
    hash.add(Vector3f(lights.environment.world_from_environment.col(column)));
  hash.add(lights.spheres.size());
  for (const SphereLight& light : lights.spheres) {
    hash.add(light.center);
    hash.add(light.radius);
    hash.add(light.radiance);
  }
  hash.add(lights.directionals.size());
  for (const DirectionalLight& light : lights.directionals) {
    hash.add(light.toward);
    hash.add(light.angular_radius_rad);
    hash.add(light.irradiance);
  }
  hash.add(lights.rectangles.size());
  for (const RectangleLight& light : lights.rectangles) {
    for (const Vector3f& vector : {light.center, light.edge_x, light.edge_y}) hash.add(vector);
    hash.add(light.radiance);
    hash.add(light.two_sided);
  }
}

void add(ContentHash& hash, const TruthGoal& goal) {
  hash.add(goal.noise);
  hash.add(goal.first_samples);
  hash.add(goal.most_samples);
  hash.add(goal.seed);
}

/// Of all that vertices and pictures have in common.
ContentHash begin_hash(const Subject& subject, const ReferenceLights& lights,
                       const TruthGoal& goal) {
  ContentHash hash;
  hash.add(kReferenceVersion);
  add(hash, subject);
  add(hash, lights);
  add(hash, goal);
  return hash;
}

}  // namespace

std::string vertex_truth_key(const Subject& subject, std::span<const TruthPoint> points,
                             const ReferenceLights& lights, const TruthGoal& goal) {
  ContentHash hash = begin_hash(subject, lights, goal);
  hash.add(points.size());
  for (const TruthPoint& point : points) {
    hash.add(point.vertex);
    hash.add(point.outgoing);
  }
  return "vertices-" + hash.hex();
}

std::string picture_truth_key(const Subject& subject, const View& view,
                              const ReferenceLights& lights, const TruthGoal& goal) {
  ContentHash hash = begin_hash(subject, lights, goal);
  for (const Vector3f& vector : {view.camera.origin, view.camera.target, view.camera.up})
    hash.add(vector);
  hash.add(view.camera.vertical_fov_deg);
  for (const int size : {view.width, view.height, view.samples_per_axis}) hash.add(size);
  return "picture-" + hash.hex();
}

}  // namespace burnish
