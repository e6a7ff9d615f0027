// Distance from the origin to a triangle at x = 0.125.
#include <cstdio>

#include "burnish/precompute/ray_scene.h"

int main() {
  const burnish::Vector3f corners[] = {{0.125f, -1, -1}, {0.125f, 1, -1}, {0.125f, 0, 1}};
  const burnish::Triangle triangle[] = {{0, 1, 2}};
  burnish::RayScene scene;
  scene.add_mesh(corners, triangle);
  scene.commit();
  burnish::RayHit hit{};
  scene.intersect(burnish::Vector3f(0, 0, 0), burnish::Vector3f(1, 0, 0), hit);
  std::printf("%.7f\n", hit.distance);
}
