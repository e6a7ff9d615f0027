#pragma once

#include "burnish/precompute/visibility_mask.h"
#include "byte_stream.h"

/// A visibility mask in few bytes: most of its rows equal the row above in most words. About a
/// tenth of the mask's own size, and as quick as copying it.
namespace burnish {

void encode_mask(const VisibilityMask& mask, ByteWriter& to);

/// `mask` has the resolution that was encoded.
void decode_mask(ByteReader& from, VisibilityMask& mask);

}  // namespace burnish
