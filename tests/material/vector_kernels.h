#pragma once

#include <string>

#include "burnish/material/specular_slice.h"
#include "material/slice_block.h"

/// The library's private vector forms of materials, by the instruction set in use.
namespace burnish::test {

/// Of kBlock pairs of directions above the horizon.
void vector_smooth_factor(const Material& material, const BlockVector3<float>& outgoing,
                          const BlockVector3<float>& incoming, BlockRgb<float>& result);
/// Of kBlock half vectors above the horizon; not of `fitted`.
void vector_distribution(const Material& material, const BlockVector3<float>& half,
                         BlockArray<float>& result);

/// slice_tooth of kBlock views.
void slice_in_float(const PreparedMaterial& prepared, int tooth,
                    const BlockVector3<float>& outgoing, SliceBlock<float>& result);
void slice_in_double(const PreparedMaterial& prepared, int tooth,
                     const BlockVector3<double>& outgoing, SliceBlock<double>& result);

}  // namespace burnish::test
