#include <cstdio>

#include "burnish/shading/shade.h"

int main() {
  burnish::LightRig rig;
  rig.lobes.resize(1);  // along z
  rig.lobes[0].color = burnish::Rgb::Constant(1.0f);
  rig.lobes[0].lobe.bandwidth_x = rig.lobes[0].lobe.bandwidth_y = 100.0f;
  burnish::Transfer transfer;  // without a basis: nothing occludes but the horizon
  transfer.positions = {burnish::Vector3f(0, 0, 0)};
  transfer.normals = {burnish::Vector3f(0, 0, 1)};
  transfer.tangents = {burnish::Vector3f(1, 0, 0)};
  const burnish::Vector3f eye(0, 0, 5);
  const burnish::ShadingOptions options;
  const burnish::PreparedMaterial diffuse = burnish::prepare_material({}, options.specular);
  const burnish::PreparedTransfer prepared = burnish::prepare_transfer(transfer);
  const burnish::PreparedLights lights = burnish::prepare_lights(rig, prepared, options);
  burnish::Rgb radiance;
  burnish::shade_vertices(prepared, {&lights, nullptr}, {&diffuse, 1}, {}, eye, options, 0,
                          {&radiance, 1});
  std::printf("%.7f\n", radiance.x());
}
