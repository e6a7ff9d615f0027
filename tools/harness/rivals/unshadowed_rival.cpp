#include "harness/rivals/unshadowed_rival.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "burnish/shading/shade.h"
#include "harness/rivals/runtime_rival.h"
#include "harness/rivals/view_table.h"

namespace burnish {
namespace {

constexpr size_t kBlock = 64;  // vertices that are looked up together

/// A material as an engine has it.
struct EngineMaterial {
  Material material;
  ViewTable albedo;      // empty: diffuse
  float bandwidth = 0;   // of the lobe that filters the map
  float bend = 0;        // share of the bent normal
  bool along_x = false;  // the longer roughness is along the tangent
};

EngineMaterial engine_material(const Material& material, const UnshadowedOptions& options) {
  EngineMaterial result;
  result.material = material;
  if (!material.has_specular()) return result;
  result.albedo = albedo_table(material);
  const float x = material.alpha_x, y = material.alpha_y;
  // D(h) falls as exp(-|h|^2 / alpha^2), and the reflection turns by twice as much as h where the
  // view is along the normal, which the prefiltered maps of engines assume.
  result.bandwidth = 1 / (4 * x * y);
  result.along_x = x > y;
  if (!options.bent) return result;
  // alpha_x, alpha_y = alpha (1 +- anisotropy), alpha the square of the perceptual roughness.
  const float anisotropy = std::abs(x - y) / (x + y), alpha = (x + y) / 2;
  result.bend = anisotropy * std::min(5 * std::sqrt(alpha), 1.0f);
  return result;
}

/// The direction that a highlight looks in. All in the frame of the vertex.
Vector3f reflected(const EngineMaterial& material, const Vector3f& outgoing) {
  Vector3f normal = Vector3f::UnitZ();
  if (material.bend > 0) {
    // The normal of a groove's walls that is nearest to the view: the groove runs across the
    // longer roughness.
    const Vector3f groove = material.along_x ? Vector3f::UnitY() : Vector3f::UnitX();
    const Vector3f wall = outgoing - outgoing.dot(groove) * groove;
    normal = (normal + material.bend * (wall.normalized() - normal)).normalized();
  }
  return (2 * outgoing.dot(normal) * normal - outgoing).normalized();
}

/// Lobes about directions of the world, all round, and what they see.
struct Lookups {
  std::array<float, kBlock> x[3], z[3], bandwidth, seen[3];
  size_t count = 0;

  void add(const Vector3f& axis, float width) {
    const Frame<float> frame = frame_from_axis(axis);
    for (int k = 0; k < 3; ++k) {
      x[k][count] = frame.x[k];
      z[k][count] = frame.z[k];
    }
    bandwidth[count++] = width;
  }
  void look(const PrefilteredEnvironment& environment) {
    const auto part = [this](std::array<float, kBlock>& all) {
      return std::span(all).first(count);
    };
    const std::span<const float> widths = part(bandwidth);
    batch::eval_prefiltered(environment,
                            {{part(x[0]), part(x[1]), part(x[2])},
                             {part(z[0]), part(z[1]), part(z[2])},
                             widths,
                             widths,
                             widths},
                            1, {part(seen[0]), part(seen[1]), part(seen[2])});
  }
  Rgb at(size_t i) const { return {seen[0][i], seen[1][i], seen[2][i]}; }
};

struct State {
  RivalScene scene;
  std::vector<EngineMaterial> materials;
  PreparedTransfer open;  // nothing occludes
  ShadingOptions options;
  std::vector<PreparedMaterial> prepared;
  PreparedLights lights;  // but the environment
  bool has_lights = false;

  void shade_block(const Vector3f& eye, size_t first, std::span<Rgb> radiance) const;
  void shade(const Vector3f& eye, size_t first, std::span<Rgb> radiance) const {
    for (size_t done = 0; done < radiance.size(); done += kBlock)
      shade_block(eye, first + done,
                  radiance.subspan(done, std::min(kBlock, radiance.size() - done)));
  }
};

void State::shade_block(const Vector3f& eye, size_t first, std::span<Rgb> radiance) const {
  if (has_lights)
    shade_vertices(open, {&lights, nullptr}, prepared, scene.subject.material_id, eye, options,
                   first, radiance);
  else
    std::fill(radiance.begin(), radiance.end(), Rgb::Zero());
  Lookups diffuse, specular;
  std::array<Rgb, kBlock> albedo;
  std::array<size_t, kBlock> place;  // of the vertices that are specular
  for (size_t i = 0; i < radiance.size(); ++i) {
    const VertexView view = view_vertex(*scene.subject.transfer, first + i, eye);
    diffuse.add(view.frame.z, 0);  // a lobe of no bandwidth is the cosine
    const EngineMaterial& material = materials[scene.subject.material_of(first + i)];
    if (material.albedo.empty()) continue;
    place[specular.count] = i;
    material.albedo.eval(view.outgoing, {albedo[specular.count].data(), 3});
    specular.add(view.frame.to_world(reflected(material, view.outgoing)), material.bandwidth);
  }
  diffuse.look(*scene.filtered);
  for (size_t i = 0; i < radiance.size(); ++i)
    radiance[i] += materials[scene.subject.material_of(first + i)].material.diffuse * diffuse.at(i);
  if (specular.count == 0) return;
  specular.look(*scene.filtered);
  for (size_t i = 0; i < specular.count; ++i) radiance[place[i]] += albedo[i] * specular.at(i);
}

}  // namespace

Rival unshadowed_rival(const RivalScene& scene, const UnshadowedOptions& options) {
  require_complete(scene);
  const auto start = std::chrono::steady_clock::now();
  const auto state = std::make_shared<State>();
  state->scene = scene;
  for (const Material& material : scene.subject.materials)
    state->materials.push_back(engine_material(material, options));
  state->open.positions = scene.subject.transfer->positions;
  state->open.normals = scene.subject.transfer->normals;
  state->open.tangents = scene.subject.transfer->tangents;
  state->prepared = prepare_materials(scene.subject.materials, state->options);
  Rival rival;
  rival.name = options.bent ? "unshadowed, bent" : "unshadowed";
  rival.bake_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  rival.bytes_per_vertex = kPlaceBytes;
  rival.bytes_shared = shared_bytes(*scene.filtered);
  for (const EngineMaterial& material : state->materials)
    rival.bytes_shared += material.albedo.bytes();
  rival.prepare_lights = [state](const Eigen::Matrix3f& world_from_environment) {
    LightRig rig = state->scene.rig;
    rig.lobes.clear();
    rotate(rig, world_from_environment);
    state->has_lights =
        !rig.directionals.empty() || !rig.spheres.empty() || !rig.rectangles.empty();
    prepare_lights(rig, state->open, state->options, state->lights);
    state->scene.filtered->environment_from_world = world_from_environment.transpose();
  };
  rival.shade = [state](const Vector3f& eye, size_t first, std::span<Rgb> radiance) {
    state->shade(eye, first, radiance);
  };
  return rival;
}

}  // namespace burnish
