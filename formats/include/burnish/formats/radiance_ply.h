#pragma once

#include <span>
#include <string>

#include "burnish/light/rgb.h"
#include "burnish/shading/transfer.h"

namespace burnish {

/// Writes vertices with their shaded colour as binary little-endian PLY, for Blender, MeshLab and
/// the like: float x y z, nx ny nz, radiance_r radiance_g radiance_b (linear, as given), and uchar
/// red green blue (radiance times 2^exposure_stops, clamped to 0..1, through the sRGB transfer
/// function); faces as lists of three ints.
///
/// - `positions`, `normals`, `radiance`: #V, equal sizes. `triangles` index them; may be empty.
///
/// Throws Error(ErrorKind::output) when the file cannot be written whole, std::invalid_argument for
/// sizes that differ or an index out of range.
void write_radiance_ply(const std::string& path, std::span<const Vector3f> positions,
                        std::span<const Vector3f> normals, std::span<const Rgb> radiance,
                        std::span<const Triangle> triangles, float exposure_stops = 0);

}  // namespace burnish
