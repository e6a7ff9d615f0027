#pragma once

#include <array>
#include <cstddef>

/// Shading goes through points in blocks: structures of arrays on the stack, which the kernels read
/// and write a vector at a time. T is the lanes' type: float, and double where the error of float
/// is measured.
namespace burnish {

/// Points of a block: a multiple of every vector's lanes, and small enough for a block's arrays to
/// stay in the nearest caches.
inline constexpr size_t kBlock = 32;

/// One number per point. Of fewer points than kBlock, the rest up to a whole vector are valid
/// numbers, too (copies of a point's), so that kernels need no remainder.
template <class T>
struct alignas(64) BlockArray {
  T value[kBlock];
  T* data() { return value; }
  const T* data() const { return value; }
  T& operator[](size_t i) { return value[i]; }
  T operator[](size_t i) const { return value[i]; }
};

template <class T>
struct BlockVector3 {
  BlockArray<T> x, y, z;
};

/// Colours, by channel.
template <class T>
using BlockRgb = std::array<BlockArray<T>, 3>;

/// Lobes of a block, one a point. A frame's y is z x x; the amplitude is 1.
template <class T>
struct BlockLobes {
  BlockVector3<T> x, z;
  BlockArray<T> bandwidth_x, bandwidth_y;
};

/// What sets lobes that stand for a part of others apart from Gaussians.
template <class T>
struct BlockCuts {
  BlockArray<T> third;     ///< central moment along the longer axis, x if both are as long, rad^3
  BlockVector3<T> normal;  ///< of the horizon below which there is nothing of them
};

}  // namespace burnish
