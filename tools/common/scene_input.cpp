#include "common/scene_input.h"

#include <algorithm>

#include "burnish/formats/mesh_file.h"

namespace burnish::tools {

ProceduralScene load_subject(const std::string& name) {
  const std::vector<std::string> names = scene_names();
  if (std::find(names.begin(), names.end(), name) != names.end()) return make_scene(name);
  ProceduralScene scene;
  scene.mesh = read_mesh(name);
  scene.name = scene.mesh.name;
  scene.materials = {Material{}};
  Eigen::AlignedBox3f box;
  for (const Vector3f& position : scene.mesh.positions) box.extend(position);
  scene.camera = frame_bounds(box.min(), box.max(), 1.5f);
  return scene;
}

}  // namespace burnish::tools
