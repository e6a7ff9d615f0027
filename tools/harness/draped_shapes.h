#pragma once

#include "burnish/formats/triangle_mesh.h"

/// Bodies by formula that are more than a profile: what is knotted, bent or draped.
namespace burnish {

/// A tube along the (2, 3) torus knot about the y axis, thick and thin by turns, with scales and a
/// ridge of spikes: much that occludes itself. About 2.9 wide. Closed; tangents run along it.
void append_scaly_knot(TriangleMesh& mesh, int steps, int segments);

/// Cushion of half-size `half_size` between four corners and of height `height` over its seam, half
/// of it below. Closed, its seam a sharp edge; tangents run along x. The middle is the origin.
void append_pillow(TriangleMesh& mesh, double half_size, double height, int cells);

/// Card of width x length that leans on the brim of append_dish, a little bent. Closed, with sharp
/// edges; tangents run along its width.
void append_card(TriangleMesh& mesh, double width, double length, double thickness, int cells_width,
                 int cells_length);

/// Square cloth of half-size 1 over an unseen round table, its middle over the origin, its hem in
/// folds. A sheet, closed; tangents run along x where it lies flat.
void append_draped_cloth(TriangleMesh& mesh, double thickness, int cells);

}  // namespace burnish
