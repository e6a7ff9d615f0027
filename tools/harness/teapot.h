#pragma once

#include "burnish/formats/triangle_mesh.h"

namespace burnish {

/// Cells of a teapot's patches.
struct TeapotCells {
  int around = 30;  ///< across a patch: a quarter of the pot, half of the handle or the spout
  int along = 30;   ///< of each patch, by its length: of the longest
};

/// Newell's teapot (newell1975): the 32 bicubic patches of the pot, its lid, bottom, handle and
/// spout, with +y up, the spout along +x, and its bottom at y = 0. The published units times
/// `scale`: 3.15 high, 6.4 long.
///
/// Three bodies that are closed each: the pot, whose lid is joined to its rim by a ring, so that
/// the gap between them is a groove; the handle and the spout, whose ends are capped, and which
/// reach into the pot. Tangents run along the profile of the pot, and along the handle and the
/// spout: across the grooves of a brushed one.
void append_teapot(TriangleMesh& mesh, double scale, const TeapotCells& cells);

}  // namespace burnish
