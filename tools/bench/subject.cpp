#include "subject.h"

#include <algorithm>

#include "burnish/precompute/fit_light.h"
#include "common/interrupt.h"
#include "common/options.h"
#include "common/pipeline_options.h"
#include "harness/parallel_prefilter.h"
#include "harness/reference_integrator.h"
#include "harness/studio_environment.h"

namespace burnish::tools {

void add_subject_options(CLI::App& app, SubjectOptions& options) {
  std::string names;
  for (const std::string& name : scene_names()) names += (names.empty() ? "" : ", ") + name;
  add_file(app, "SCENE", "SCENE|MESH", options.name,
           fmt::format("a built-in scene ({}) or a mesh file (default {})", names, options.name));
  add_bake_options(app, options.bake);
  add_number(app, "--reference", "SPP", options.reference_samples, {0, 1 << 20, "samples a vertex"},
             "of the truth that the error is against; 0 for none");
  add_number(app, "--seed", "N", options.seed, "of the truth's random numbers");
}

StudioLight make_studio_light(const PreparedTransfer& transfer, const ShadingOptions& options,
                              Work& work) {
  StudioLight studio;
  studio.map = studio_environment();
  studio.lights = prepare_lights(fit_light(studio.map, {}, work.progress()).rig, transfer, options);
  studio.filtered = prefilter_in_parallel(studio.map);
  throw_if_interrupted();
  return studio;
}

RelativeL2 vertex_error(const Subject& subject, const StudioLight& studio, const Vector3f& eye,
                        const ShadingOptions& shading, const SubjectOptions& options, Work& work) {
  const SceneRays rays(*subject.transfer);
  const VertexReference truth = shade_reference_vertices(
      subject, rays, eye, {{&studio.map}, {}},
      {.samples = options.reference_samples, .seed = options.seed}, work.progress());
  const std::vector<Rgb> shaded = shade_all_vertices(subject, studio.lighting(), eye, shading);
  return relative_l2(shaded, truth.radiance, truth.variance);
}

}  // namespace burnish::tools
