#include "bench/reproduce/stage.h"

#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "burnish/precompute/fit_light.h"
#include "common/interrupt.h"
#include "harness/parallel_prefilter.h"
#include "harness/studio_environment.h"

namespace burnish::tools {
namespace {

LightRig lights_for(const Image& map, const StageOptions& options, Work& work) {
  LightRig rig = fit_light(map, {.lobes = options.light_lobes}, work.progress()).rig;
  if (options.local_lights)
    rig.spheres = {{Vector3f(1.5f, 1.7f, 0.9f), 0.12f, Rgb(60, 48, 34)},
                   {Vector3f(-1.7f, 1.4f, -0.7f), 0.12f, Rgb(26, 36, 50)}};
  return rig;
}

/// Samples of one material, shaded together.
struct Batch {
  std::vector<ShadingPoint> points;
  std::vector<Vector3f> outgoing;
  std::vector<size_t> pixels;
};

void add_batch(const Batch& batch, const MovingFrame& frame, const PreparedMaterial& material,
               float weight, std::vector<Rgb>& pixels) {
  std::vector<Rgb> radiance(batch.points.size());
  shade_points(*frame.transfer, batch.points, batch.outgoing, material,
               {&frame.lights, frame.environment}, frame.options, radiance);
  for (size_t i = 0; i < radiance.size(); ++i) pixels[batch.pixels[i]] += weight * radiance[i];
}

}  // namespace

Stage::Stage(ProceduralScene scene, const StageOptions& options, Work& work)
    : source(std::move(scene)),
      transfer(bake(source.mesh, {}, options.bake, {.progress = work.progress()})),
      prepared(prepare_transfer(transfer)),
      rays(transfer),
      map(studio_environment()),
      rig(lights_for(map, options, work)),
      filtered(prefilter_in_parallel(map)) {
  throw_if_interrupted();
}

Subject Stage::subject(const std::vector<Material>& materials) const {
  return {&transfer, materials, source.material_id, nullptr, &prepared};
}

MovingFrame frame_of(Stage& stage, const std::string& name, const ShadingOptions& options,
                     const PreparedTransfer* transfer) {
  MovingFrame frame;
  frame.name = name;
  frame.transfer = transfer ? transfer : &stage.prepared;
  frame.rig = stage.rig;
  frame.materials = stage.source.materials;
  frame.material_id = stage.source.material_id;
  frame.environment = &stage.filtered;
  frame.options = options;
  frame.camera = stage.source.camera;
  return frame;
}

PrimaryHits hits_of(const Stage& stage, const PictureSize& size) {
  return trace_primary_rays(stage.rays, {stage.source.camera, size.width, size.height, 2});
}

PictureTruth truth_of(const Stage& stage, const std::vector<Material>& materials,
                      const PrimaryHits& hits, const FigureContext& context) {
  return picture_truth(stage.subject(materials), stage.rays, hits, stage.lights(),
                       {.noise = 0.01, .first_samples = 64, .most_samples = 2048}, context.cache,
                       context.work.progress());
}

Picture draw_by_pixel(const Stage& stage, MovingFrame& frame, const PrimaryHits& hits) {
  draw_frame(frame, 0);  // prepares the lights and the materials
  const View& view = hits.view;
  const Vector3f& eye = view.camera.origin;
  const PrimaryRays camera = primary_rays(view.camera, view.width, view.height);
  const size_t samples = hits.samples_per_pixel();
  const float weight = 1 / static_cast<float>(samples);
  Picture picture;
  picture.radiance = Image(view.width, view.height);
  std::vector<Rgb>& pixels = picture.radiance.pixels;
  picture.hit.assign(pixels.size(), 0);
  tbb::parallel_for(tbb::blocked_range<size_t>(0, pixels.size(), 256), [&](const auto& range) {
    std::vector<Batch> batches(frame.prepared_materials.size());
    for (size_t pixel = range.begin(); pixel < range.end(); ++pixel) {
      size_t met = 0;
      for (size_t i = 0; i < samples; ++i) {
        const PrimaryHit& hit = hits.pixel_hits(pixel)[i];
        if (hit.triangle == PrimaryHit::kMiss) {
          pixels[pixel] +=
              weight * eval_environment_light({&stage.map}, hits.direction(camera, pixel, i));
          continue;
        }
        ++met;
        const SurfacePoint point = surface_point(stage.transfer, hit, eye);
        if (!point.front) continue;
        Batch& batch = batches[stage.source.material_id[point.vertices[0]]];
        batch.points.push_back({point.position, point.frame, point.vertices, point.weight});
        batch.outgoing.push_back(outgoing_toward(eye, point.position, point.frame.z));
        batch.pixels.push_back(pixel);
      }
      picture.hit[pixel] = met == samples;
    }
    for (size_t id = 0; id < batches.size(); ++id)
      add_batch(batches[id], frame, frame.prepared_materials[id], weight, pixels);
  });
  return picture;
}

Picture bodies_of(const Stage& stage, Picture picture, const PrimaryHits& hits) {
  const size_t floor = stage.source.materials.size() - 1;
  for (size_t pixel = 0; pixel < picture.hit.size(); ++pixel)
    for (const PrimaryHit& hit : hits.pixel_hits(pixel))
      if (hit.triangle == PrimaryHit::kMiss ||
          stage.source.material_id[stage.transfer.triangles[hit.triangle][0]] == floor)
        picture.hit[pixel] = 0;
  return picture;
}

void add_picture_errors(BenchRow& row, const Stage& stage, const Picture& picture,
                        const PictureTruth& truth, const PrimaryHits& hits) {
  const RelativeL2 error = relative_l2(bodies_of(stage, picture, hits), truth.picture);
  row["relative_l2"] = error.without_noise;
  row["squared_percent"] = 100 * error.without_noise * error.without_noise;
  row["display_mse_percent"] = 100 * std::pow(10.0, psnr_db(picture, truth.picture) / -10);
  row["truth_noise"] = error.truth_noise;
}

Image picture_grid(const std::vector<Image>& pictures, size_t columns) {
  constexpr int kGap = 4;
  const int width = pictures.front().width, height = pictures.front().height;
  const int across = static_cast<int>(columns);
  const int down = (static_cast<int>(pictures.size()) + across - 1) / across;
  Image grid((width + kGap) * across - kGap, (height + kGap) * down - kGap, Rgb::Ones());
  for (size_t i = 0; i < pictures.size(); ++i) {
    const int left = static_cast<int>(i % columns) * (width + kGap);
    const int top = static_cast<int>(i / columns) * (height + kGap);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) grid.at(left + x, top + y) = pictures[i].at(x, y);
  }
  return grid;
}

}  // namespace burnish::tools
