// The caller's own threads: what they may share, and that they change nothing. Meant for
// ThreadSanitizer, too: cmake --preset tsan.

#include <algorithm>
#include <random>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "burnish/material/presets.h"
#include "burnish/shading/shade.h"
#include "shading/random_transfer.h"

namespace burnish::test {
namespace {

constexpr unsigned kSeed = 76;
constexpr size_t kVertices = 1500, kThreads = 4;

struct Scene {
  std::mt19937 random{kSeed};
  PreparedTransfer transfer = prepare_transfer(random_transfer(
      {.vertices = kVertices, .terms = 9, .bases = 5, .ladder_terms = 7, .ladders = 5}, random));
  LightRig rig = random_rig(random);
  std::vector<PreparedMaterial> materials =
      prepare_materials(std::vector<Material>{{.diffuse = Rgb::Constant(0.5f)},
                                              find_material_preset("brushed aluminium")->material},
                        {});
  std::vector<std::uint8_t> ids;
  PrefilteredEnvironment environment;
  Vector3f eye = {0.3f, 2, -1.5f};

  Scene() {
    for (size_t i = 0; i < kVertices; ++i) ids.push_back(static_cast<std::uint8_t>(random() % 2));
    Image map(16, 8);
    for (Rgb& pixel : map.pixels) pixel = Rgb::Constant(static_cast<float>(random() % 100) / 100);
    environment = prefilter_environment(map);
  }

  void shade(const PreparedLights& lights, size_t first, std::span<Rgb> radiance) const {
    shade_vertices(transfer, {&lights, &environment}, materials, ids, eye, {}, first, radiance);
  }
};

/// Calls work(i) for i below `count`, each in a thread of its own.
template <class Work>
void in_threads(size_t count, const Work& work) {
  std::vector<std::thread> threads;
  for (size_t i = 0; i < count; ++i) threads.emplace_back([&work, i] { work(i); });
  for (std::thread& thread : threads) thread.join();
}

// The first frame: what the library makes at its first use, all threads make at once.
TEST(Threads, FinishLightsAndShadeRangesAsOneThreadDoes) {
  SCOPED_TRACE(kSeed);
  const Scene scene;
  PreparedLights shared;
  begin_lights(scene.rig, scene.transfer, {}, shared);
  in_threads(scene.transfer.bases.size(),
             [&](size_t basis) { finish_lights(scene.transfer, {}, basis, shared); });
  std::vector<Rgb> radiance(kVertices);
  constexpr size_t kRange = kVertices / kThreads;
  in_threads(kThreads, [&](size_t i) {
    scene.shade(shared, i * kRange, std::span(radiance).subspan(i * kRange, kRange));
  });

  std::vector<Rgb> alone(kVertices);
  scene.shade(prepare_lights(scene.rig, scene.transfer, {}), 0, alone);
  for (size_t i = 0; i < kVertices; ++i)
    ASSERT_TRUE((radiance[i] == alone[i]).all())
        << i << ": " << radiance[i].transpose() << " / " << alone[i].transpose();
}

TEST(Threads, PrepareTheNextFrameWhileOthersShadeThisOne) {
  SCOPED_TRACE(kSeed);
  const Scene scene;
  const PreparedLights now = prepare_lights(scene.rig, scene.transfer, {});
  PreparedLights next;
  std::vector<std::vector<Rgb>> frames(kThreads, std::vector<Rgb>(kVertices));
  in_threads(kThreads + 1, [&](size_t i) {
    if (i == kThreads)
      prepare_lights(scene.rig, scene.transfer, {}, next);
    else
      scene.shade(now, 0, frames[i]);
  });
  std::vector<Rgb> after(kVertices);
  scene.shade(next, 0, after);
  for (const std::vector<Rgb>& frame : frames)
    for (size_t i = 0; i < kVertices; ++i) ASSERT_TRUE((frame[i] == after[i]).all()) << i;
}

}  // namespace
}  // namespace burnish::test
