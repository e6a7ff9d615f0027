// Shades a block of points of one material: one point a lane.

#if defined(BURNISH_SHADING_FRAME_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_SHADING_FRAME_INL_H_
#undef BURNISH_SHADING_FRAME_INL_H_
#else
#define BURNISH_SHADING_FRAME_INL_H_
#endif

#include <hwy/highway.h>

#include "burnish/shading/shade.h"
#include "shading/block_materials-inl.h"
#include "shading/diffuse-inl.h"
#include "shading/local_lights-inl.h"
#include "shading/specular-inl.h"

// Based on: xu2013asg, section 6 (Eq. 29, 30), over the SSDF visibility of wang2009svbrdf. Where we
// differ: the visible fraction takes the boundary's direction into account, the diffuse cosine
// belongs to the integral, and wide lobes are seen through the ladder (docs/maths.md, "Diffuse
// term", "Irradiance table").
HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {

/// sums[k] (+)= weight * a vertex's row, [row_size].
template <class D, class T = hn::TFromD<D>>
HWY_INLINE void add_coefficients(D, const PreparedTransfer& transfer, size_t first, size_t count,
                                 T weight, bool is_first, T* sums) {
  const hn::ScalableTag<float> df;
  const hn::Rebind<hwy::float16_t, decltype(df)> dh;
  const size_t lanes = hn::Lanes(df);
  const bool half = transfer.format == RowFormat::float16;
  HWY_ALIGN float buffer[hn::MaxLanes(decltype(df)())];
  HWY_ALIGN std::uint16_t rest[hn::MaxLanes(decltype(df)())] = {};
  for (size_t k = 0; k < count; k += lanes) {
    const size_t here = std::min(lanes, count - k);
    auto values = hn::Zero(df);
    if (half) {
      const std::uint16_t* source = transfer.rows16.data() + first + k;
      if (here < lanes) {
        std::copy_n(source, here, rest);
        source = rest;
      }
      values = hn::PromoteTo(df, hn::LoadU(dh, reinterpret_cast<const hwy::float16_t*>(source)));
    } else {
      const float* source = transfer.rows32.data() + first + k;
      if (here < lanes) {
        std::fill_n(buffer, lanes, 0.0f);
        std::copy_n(source, here, buffer);
        source = buffer;
      }
      values = hn::LoadU(df, source);
    }
    // What follows a row of whole vectors is its own padding.
    if constexpr (std::is_same_v<T, float>) {
      const auto old = is_first ? hn::Zero(df) : hn::LoadU(df, sums + k);
      hn::StoreU(hn::MulAdd(hn::Set(df, weight), values, old), df, sums + k);
    } else {
      hn::StoreU(values, df, buffer);
      for (size_t j = 0; j < lanes; ++j)
        sums[k + j] = (is_first ? T(0) : sums[k + j]) + weight * static_cast<T>(buffer[j]);
    }
  }
}

/// Reads the coefficients of the block's points, each once.
template <class D, class T = hn::TFromD<D>>
HWY_NOINLINE void load_rows(D d, const PreparedTransfer& transfer, size_t terms, bool ladder,
                            ShadingBlock<T>& block) {
  const size_t padded = padded_terms(transfer.terms), size = transfer.row_size();
  const size_t ladder_terms = static_cast<size_t>(transfer.ladder_terms);
  for (size_t r = 0; r < block.row_count; ++r) {
    VisibilityRow<T>& row = block.row[r];
    // A mean of vertices of one basis; its weight among other bases is the row's, which has no
    // finite inverse where it is denormal.
    for (size_t n = 0; n < static_cast<size_t>(row.vertex_count); ++n) {
      const size_t first = row.vertex[n] * size;
      const T weight = row.vertex_weight[n] / row.weight;
      add_coefficients(d, transfer, first, terms, weight, n == 0, row.ssdf);
      if (ladder)
        add_coefficients(d, transfer, first + static_cast<size_t>(transfer.terms), ladder_terms,
                         weight, n == 0, row.ladder);
    }
    std::fill(row.ssdf + terms, row.ssdf + padded, T(0));
    if (ladder)
      std::fill(row.ladder + ladder_terms, row.ladder + padded_terms(transfer.ladder_terms), T(0));
  }
}

/// Fills a block's last vector with copies of a point.
template <class T>
void pad_block(ShadingBlock<T>& block) {
  const auto pad = [&](BlockVector3<T>& v) {
    for (size_t i = block.count; i < kBlock; ++i) {
      v.x[i] = v.x[0];
      v.y[i] = v.y[0];
      v.z[i] = v.z[0];
    }
  };
  pad(block.tangent);
  pad(block.bitangent);
  pad(block.normal);
  pad(block.outgoing);
}

template <class T>
void clear(BlockRgb<T>& rgb) {
  for (BlockArray<T>& channel : rgb) std::fill_n(channel.data(), kBlock, T(0));
}

/// The specular part, and local lights of both parts: teeth are placed some at a time, so that a
/// light's lobes are found once for all of them.
template <class D, class Materials, class T = hn::TFromD<D>>
HWY_NOINLINE void reflect(D d, const PreparedTransfer& transfer, const Materials& materials,
                          const Lighting& lighting, const ShadingOptions& options, size_t terms,
                          bool diffuse, ShadingBlock<T>& block, BlockRgb<T>& irradiance,
                          BlockRgb<T>& reflected) {
  constexpr int kTogether = 9;
  SliceBlock<T> slices[kTogether];
  const PreparedLights& lights = *lighting.lights;
  const bool specular = materials.is_specular(block.count);
  int count = 0;
  for (int first = 0; first == 0 || first < count; first += kTogether) {
    if (specular) count = materials.slice(d, first, block, std::span<SliceBlock<T>>(slices));
    size_t placed = 0;
    for (int k = 0; k < std::min(count - first, kTogether); ++k) {
      if (!turn_slice(d, block, slices[k])) continue;
      reflect_environment(d, transfer, materials.form(), lighting, options, terms, block, slices[k],
                          reflected);
      if (placed < static_cast<size_t>(k)) slices[placed] = slices[k];
      ++placed;
    }
    const bool irradiates = diffuse && first == 0;
    if (!irradiates && placed == 0) continue;
    add_lights(d, lights.directionals, transfer, options, terms, block, irradiates, slices, placed,
               irradiance, reflected);
    add_lights(d, lights.spheres, transfer, options, terms, block, irradiates, slices, placed,
               irradiance, reflected);
    add_lights(d, lights.rectangles, transfer, options, terms, block, irradiates, slices, placed,
               irradiance, reflected);
  }
}

/// Radiance of the block's points, 0 where they are seen from below. The block is complete but for
/// its rows and its padding.
template <class D, class Materials, class T = hn::TFromD<D>>
HWY_INLINE void shade_block(D d, const PreparedTransfer& transfer, const Materials& materials,
                            const Lighting& lighting, const ShadingOptions& options,
                            ShadingBlock<T>& block, BlockRgb<T>& radiance) {
  const size_t terms = static_cast<size_t>(
      options.terms > 0 ? std::min(options.terms, transfer.terms) : transfer.terms);
  const bool diffuse = materials.is_diffuse(block.count) && !is_dark(*lighting.lights);
  const bool specular =
      materials.is_specular(block.count) && (lighting.environment || !is_dark(*lighting.lights));
  pad_block(block);
  if (diffuse || specular) load_rows(d, transfer, terms, diffuse, block);
  BlockRgb<T> irradiance, albedo;
  clear(irradiance);
  clear(radiance);
  materials.load_albedo(block.count, albedo);
  if (diffuse)
    add_environment_irradiance(d, transfer, *lighting.lights, options, terms, block, irradiance);
  if (diffuse || specular)
    reflect(d, transfer, materials, lighting, options, terms, diffuse, block, irradiance, radiance);
  block.fetcher.fetch(block.fetcher.waiting());
  for (size_t i = 0; i < block.count; i += hn::Lanes(d)) {
    const auto above = hn::Gt(hn::Load(d, block.outgoing.z.data() + i), hn::Zero(d));
    for (size_t c = 0; c < 3; ++c) {
      const auto scale = hn::Mul(hn::Set(d, 1 / kPi<float>), hn::Load(d, albedo[c].data() + i));
      const auto sum = hn::MulAdd(scale, hn::Load(d, irradiance[c].data() + i),
                                  hn::Load(d, radiance[c].data() + i));
      hn::Store(hn::IfThenElseZero(above, sum), d, radiance[c].data() + i);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
