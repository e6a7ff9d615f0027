// The materials of the points of a block: one for all, or one each.

#if defined(BURNISH_SHADING_BLOCK_MATERIALS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_SHADING_BLOCK_MATERIALS_INL_H_
#undef BURNISH_SHADING_BLOCK_MATERIALS_INL_H_
#else
#define BURNISH_SHADING_BLOCK_MATERIALS_INL_H_
#endif

#include <algorithm>
#include <span>

#include <hwy/highway.h>

#include "material/brdf_numbers.h"
#include "material/slice_block.h"
#include "material/specular_slice-inl.h"
#include "shading/visibility-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {

/// One material of all points.
struct SharedMaterial {
  const PreparedMaterial& material;

  SpecularForm form() const { return material.form; }
  bool is_diffuse(size_t) const { return (material.material.diffuse > 0).any(); }
  bool is_specular(size_t) const { return material.count > 0; }
  template <class T>
  void load_albedo(size_t, BlockRgb<T>& albedo) const {
    for (size_t c = 0; c < 3; ++c)
      std::fill_n(albedo[c].data(), kBlock, T(material.material.diffuse[static_cast<int>(c)]));
  }
  /// Writes teeth from `first` on, at most slices.size(); returns how many teeth there are in all.
  template <class D, class T = hn::TFromD<D>>
  int slice(D d, int first, const ShadingBlock<T>& block, std::span<SliceBlock<T>> slices) const {
    const int last = std::min(first + static_cast<int>(slices.size()), material.count);
    for (int k = first; k < last; ++k)
      slice_tooth(d, material, k, block.count, block.outgoing,
                  slices[static_cast<size_t>(k - first)]);
    return material.count;
  }
};

/// One material for each point: their lobes are found one point at a time, all else as if they
/// shared one.
struct OwnMaterials {
  std::span<const Material> materials;  ///< of the block's points
  SpecularOptions options;

  SpecularForm form() const { return options.form; }
  bool is_diffuse(size_t count) const {
    return std::any_of(materials.begin(), materials.begin() + static_cast<std::ptrdiff_t>(count),
                       [](const Material& m) { return (m.diffuse > 0).any(); });
  }
  bool is_specular(size_t count) const {
    return std::any_of(materials.begin(), materials.begin() + static_cast<std::ptrdiff_t>(count),
                       [](const Material& m) { return m.has_specular(); });
  }
  template <class T>
  void load_albedo(size_t count, BlockRgb<T>& albedo) const {
    for (size_t c = 0; c < 3; ++c)
      for (size_t i = 0; i < kBlock; ++i)
        albedo[c][i] = materials[i < count ? i : 0].diffuse[static_cast<int>(c)];
  }
  template <class D, class T = hn::TFromD<D>>
  int slice(D d, int first, const ShadingBlock<T>& block, std::span<SliceBlock<T>> slices) const {
    int most = 0;
    SliceBlock<T> alone;
    BlockVector3<T> outgoing;
    for (size_t i = 0; i < block.count; ++i) {
      const PreparedMaterial prepared = prepare_material(materials[i], options);
      const internal::BrdfNumbers numbers = internal::brdf_numbers(prepared.material);
      std::fill_n(outgoing.x.data(), hn::Lanes(d), block.outgoing.x[i]);
      std::fill_n(outgoing.y.data(), hn::Lanes(d), block.outgoing.y[i]);
      std::fill_n(outgoing.z.data(), hn::Lanes(d), block.outgoing.z[i]);
      for (size_t k = 0; k < slices.size(); ++k) {
        const int tooth = first + static_cast<int>(k);
        const bool is_one = tooth < prepared.count;
        if (is_one) slice_tooth(d, prepared, numbers, tooth, 1, outgoing, alone);
        set_lane(is_one ? &alone : nullptr, i, slices[k]);
      }
      most = std::max(most, prepared.count);
    }
    for (SliceBlock<T>& slice : slices)
      for (size_t i = block.count; i < kBlock; ++i) set_lane<T>(nullptr, i, slice);
    return most;
  }

 private:
  /// The first lane of a slice, or some lobe that weighs nothing, as lane i of another.
  template <class T>
  static void set_lane(const SliceBlock<T>* slice, size_t i, SliceBlock<T>& result) {
    const auto set = [&](const auto& from, auto& to, T otherwise) {
      to[i] = slice ? from[0] : otherwise;
    };
    const BlockLobes<T>& from = slice ? slice->lobes : result.lobes;
    BlockLobes<T>& to = result.lobes;
    set(from.x.x, to.x.x, 1);
    set(from.x.y, to.x.y, 0);
    set(from.x.z, to.x.z, 0);
    set(from.z.x, to.z.x, 0);
    set(from.z.y, to.z.y, 0);
    set(from.z.z, to.z.z, 1);
    set(from.bandwidth_x, to.bandwidth_x, 1);
    set(from.bandwidth_y, to.bandwidth_y, 1);
    set(slice ? slice->integral : result.integral, result.integral, 1);
    for (size_t c = 0; c < 3; ++c)
      set(slice ? slice->weight[c] : result.weight[c], result.weight[c], 0);
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
