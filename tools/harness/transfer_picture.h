#pragma once

#include "burnish/light/environment_map.h"
#include "burnish/shading/transfer.h"

/// A transfer as a sheet of octahedral maps (+z in the middle, -z in the corners, drawn as they
/// are), kPictureColumns a row:
/// - the SSDFs of vertices spread evenly over the transfer, as compressed: blue visible, red
///   hidden, white at the boundary, saturated from a right angle on. Without bases: their horizons.
/// - of each of the first kPictureBases bases the mean SSDF and the leading eigen-SSDFs, each of
///   these scaled to its largest value; their sign means nothing but which texels rise together;
/// - of each ladder, at bandwidths 1, 2, 4, ..., 128 and for the mean of its vertices: what lobes
///   see, blue all, white half, red nothing; and in the next row how it changes along the leading
///   eigenvector, between one standard deviation of the vertices below the mean and one above.
namespace burnish {

inline constexpr int kPictureColumns = 8;
inline constexpr int kPictureBases = 8;
inline constexpr int kPictureGutter = 2;  ///< pixels around each map

/// Pixels along the edge of each map: the SSDFs' resolution, or 128 if it is less.
int picture_map_edge(const Transfer& transfer);

/// Colour of -1 (red) through 0 (white) to 1 (blue), linear, for write_png(); clamped, NaN is 0.
Rgb diverging_color(float value);

/// The sheet, linear RGB. An empty place has the gutters' grey.
Image draw_transfer(const Transfer& transfer);

}  // namespace burnish
