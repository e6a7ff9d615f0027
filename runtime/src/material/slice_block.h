#pragma once

#include "sphere/block.h"

namespace burnish {

/// SliceLobe of each point of a block. Where the weight is 0, the lobe is some valid one.
template <class T>
struct SliceBlock {
  BlockLobes<T> lobes;
  BlockArray<T> integral;
  BlockRgb<T> weight;
};

}  // namespace burnish
