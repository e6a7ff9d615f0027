#include "burnish/precompute/subdivision.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "subdivision_edges.h"

namespace burnish {

SubdivisionReport subdivide_long_edges(TriangleMesh& mesh, double max_edge,
                                       std::uint64_t max_vertices) {
  const std::string subject = mesh.name.empty() ? "receiver" : mesh.name;
  if (!(max_edge > 0))
    throw Error(ErrorKind::input, subject,
                fmt::format("the longest edge is {}, expected more than 0", max_edge));
  check_subdivision_input(mesh);
  Subdivider subdivider(mesh);
  SubdivisionReport report;
  while (true) {
    const TriangleMesh& work = subdivider.mesh();
    const MeshEdges edges = find_edges(work);
    std::vector<char> marked(edges.segments, 0);
    std::uint64_t added = 0;
    double longest = 0;
    for (const MeshEdges::Edge& edge : edges.edges) {
      const double length = edge_length(work, edge);
      if (!(length > max_edge) || !can_halve(work, edge)) continue;
      marked[edge.segment] = 1;
      longest = std::max(longest, length);
      ++added;
    }
    if (added == 0) break;
    if (work.positions.size() + added > max_vertices)
      throw Error(ErrorKind::input, subject,
                  fmt::format("edges of at most {} take more than {} vertices: {} are reached with "
                              "edges of {}; expected longer edges or more vertices",
                              max_edge, max_vertices, work.positions.size(), longest));
    subdivider.halve(edges, marked);
    ++report.rounds;
  }
  if (report.rounds == 0) return report;
  report.added_vertices = subdivider.mesh().positions.size() - mesh.positions.size();
  report.added_triangles = subdivider.mesh().triangles.size() - mesh.triangles.size();
  mesh = std::move(subdivider).gather_parts();
  return report;
}

}  // namespace burnish
