#include "harness/rivals/runtime_rival.h"

namespace burnish {
namespace {

struct State {
  RivalScene scene;
  RuntimeSettings settings;
  LightRig rig;
  std::vector<PreparedMaterial> materials;
  PreparedLights lights;
};

template <class T>
size_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

}  // namespace

size_t shared_bytes(const PreparedTransfer& transfer) {
  size_t bytes = 0;
  for (const PreparedTransfer::Basis& basis : transfer.bases)
    bytes += bytes_of(basis.mean) + bytes_of(basis.eigen16) + bytes_of(basis.eigen32);
  for (const PreparedTransfer::Ladder& ladder : transfer.ladders)
    bytes += bytes_of(ladder.images) + bytes_of(ladder.harmonics.mean) +
             bytes_of(ladder.harmonics.eigen);
  return bytes;
}

size_t shared_bytes(const PrefilteredEnvironment& environment) {
  size_t bytes = bytes_of(environment.map.pixels);
  for (const PrefilteredEnvironment::Level& level : environment.levels)
    bytes += bytes_of(level.coefficients);
  return bytes;
}

ShadingOptions paper_shading_options(VisibilityModel model, int lookups) {
  ShadingOptions options;
  options.visibility = model;
  options.cosine = CosineModel::constant;
  options.specular = {SpecularForm::peak, 1, 1};
  options.environment_taps = lookups;
  options.highlight_lobe = HighlightLobe::whole;
  options.ladder = false;
  return options;
}

Rival runtime_rival(const RivalScene& scene, const std::string& name,
                    const RuntimeSettings& settings, LightRig rig,
                    std::vector<PreparedMaterial> materials) {
  require_complete(scene);
  const auto state = std::make_shared<State>(
      State{scene, settings, std::move(rig), std::move(materials), PreparedLights{}});
  Rival rival;
  rival.name = name;
  rival.bake_s = scene.transfer_bake_s;
  rival.bytes_per_vertex = scene.subject.prepared->bytes_per_vertex();
  rival.bytes_shared = shared_bytes(*scene.subject.prepared) +
                       (settings.from_map ? shared_bytes(*scene.filtered) : 0);
  rival.prepare_lights = [state](const Eigen::Matrix3f& world_from_environment) {
    LightRig turned = state->rig;
    rotate(turned, world_from_environment);
    prepare_lights(turned, *state->scene.subject.prepared, state->settings.options, state->lights);
    state->scene.filtered->environment_from_world = world_from_environment.transpose();
  };
  rival.shade = [state](const Vector3f& eye, size_t first, std::span<Rgb> radiance) {
    const Lighting lighting = {&state->lights,
                               state->settings.from_map ? state->scene.filtered.get() : nullptr};
    shade_vertices(*state->scene.subject.prepared, lighting, state->materials,
                   state->scene.subject.material_id, eye, state->settings.options, first, radiance);
  };
  return rival;
}

Rival runtime_rival(const RivalScene& scene, const std::string& name,
                    const RuntimeSettings& settings) {
  return runtime_rival(scene, name, settings, scene.rig,
                       prepare_materials(scene.subject.materials, settings.options));
}

}  // namespace burnish
