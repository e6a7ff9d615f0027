// Bakes the four corners of a floor beside a wall, stores the result, reads it back, and prints the
// angle from the zenith to the nearest boundary of what a corner sees, which is the wall's top.
#include <cstdio>
#include <fstream>

#include "burnish/formats/mesh_file.h"
#include "burnish/formats/transfer_file.h"
#include "burnish/precompute/bake.h"
#include "burnish/visibility/ssdf.h"

int main() {
  std::ofstream("floor.off") << "OFF\n4 2 0\n-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n3 0 1 2\n3 0 2 3\n";
  const burnish::TriangleMesh floor = burnish::read_mesh("floor.off");
  std::ofstream("wall.off") << "OFF\n4 1 0\n2 -900 0\n2 900 0\n2 900 2\n2 -900 2\n4 0 1 2 3\n";
  const burnish::TriangleMesh wall = burnish::read_mesh("wall.off");
  burnish::write_transfer(burnish::bake(floor, {&wall, 1}, {}), "floor.h5");
  const burnish::Transfer transfer = burnish::read_transfer("floor.h5");
  const burnish::SsdfSample zenith =
      burnish::lookup_ssdf(transfer.bases[0], transfer.vertex_coefficients(0), transfer.terms(),
                           burnish::Vector3f(0, 0, 1));
  std::printf("%.5f\n", zenith.distance);
}
