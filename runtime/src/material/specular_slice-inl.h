// One tooth of a material's lobe, as lobes over incoming directions, for a block of views: one view
// a lane. Based on: xu2013asg, section 5.2. Where we differ: a lobe is cut into teeth, and their
// moments are matched instead of their second derivatives (docs/maths.md, "Specular slice").

#if defined(BURNISH_MATERIAL_SPECULAR_SLICE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_MATERIAL_SPECULAR_SLICE_INL_H_
#undef BURNISH_MATERIAL_SPECULAR_SLICE_INL_H_
#else
#define BURNISH_MATERIAL_SPECULAR_SLICE_INL_H_
#endif

#include <hwy/highway.h>

#include "material/brdf-inl.h"
#include "material/slice_block.h"
#include "material/slice_nodes-inl.h"
#include "sphere/lobes-inl.h"
#include "sphere/vector_math-inl.h"
#include "sphere/warp-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {

/// The sum of the lobes that stand for D(h), over h.z.
template <class D, class V>
HWY_INLINE V lobes_over_cosine(D d, const HalfVectorLobes& lobes, V xx, V yy) {
  V sum = hn::Zero(d);
  for (int k = 0; k < lobes.count; ++k) {
    const burnish::AnisotropicGaussian<float>& lobe = lobes.lobe[static_cast<size_t>(k)];
    const V exponent =
        hn::MulAdd(xx, hn::Set(d, lobe.bandwidth_x), yy * hn::Set(d, lobe.bandwidth_y));
    sum = hn::MulAdd(hn::Set(d, lobe.amplitude), exp(d, hn::Neg(exponent)), sum);
  }
  return hn::Max(sum, hn::Set(d, 1e-20f));
}

/// D(h) over the lobes that stand for it.
template <BrdfKind kKind, class D, class V>
HWY_INLINE Quotient<V> distribution_over_lobes(D d, const PreparedMaterial& prepared,
                                               const BrdfNumbers& numbers, const Vector3<V>& half) {
  const ScaledExp<V> exact = distribution<kKind>(d, numbers, half);
  const V xx = half.x * half.x, yy = half.y * half.y;
  const V cosine = hn::Max(half.z, hn::Set(d, 1e-6f));
  V over, under = exact.factor.under * cosine;
  if constexpr (kKind == BrdfKind::ggx) {
    over = exact.factor.over;
    under = under * lobes_over_cosine(d, prepared.lobes, xx, yy);
  } else {
    // The one lobe's exponent is taken off D's.
    const burnish::AnisotropicGaussian<float>& lobe = prepared.lobes.lobe[0];
    const V back = hn::MulAdd(xx, hn::Set(d, lobe.bandwidth_x), yy * hn::Set(d, lobe.bandwidth_y));
    const V exponent = hn::Min(exact.exponent + back, hn::Set(d, 30.0f));
    over = exact.factor.over * exp(d, exponent);
    under = under * hn::Set(d, lobe.amplitude);
  }
  // Where the lobes have vanished and D has not.
  return {hn::Min(over, hn::Set(d, 10.0f) * under), under};
}

/// Multiplies the nodes' shares with the cosine and f over the lobes' sum.
template <BrdfKind kKind, class D, class V>
HWY_NOINLINE void weigh_nodes(D d, const PreparedMaterial& prepared, const BrdfNumbers& numbers,
                              const Vector3<V>& outgoing, bool corrects, SliceNodes<V>& nodes) {
  const BrdfView<V> view = view_brdf<kKind>(d, numbers, outgoing);
  const V zero = hn::Zero(d);
  for (int j = 0; j < nodes.count; ++j) {
    const Vector3<V> incoming = nodes.incoming[j];
    Quotient<V> f = smooth_factor<kKind>(d, numbers, view, incoming, nodes.cos_difference[j]);
    if constexpr (kKind != BrdfKind::fitted) {  // whose lobes are exact
      if (corrects) {
        const Quotient<V> more =
            distribution_over_lobes<kKind>(d, prepared, numbers, nodes.half[j]);
        f = {f.over * more.over, f.under * more.under};
      }
    }
    const V share = nodes.share[j] * hn::Max(incoming.z, zero);
    nodes.share[j] = hn::IfThenElseZero(hn::Gt(share, zero), share * f.over / f.under);
  }
}

/// color_nodes of a Fresnel factor normal + (1 - normal) rise: linear, so that two sums are enough.
template <class D, class V>
HWY_INLINE RgbVector<V> color_linear(D d, const Rgb& specular, const Rgb& normal,
                                     SliceNodes<V>& nodes) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const Rgb low = specular * normal, more = specular * (1 - normal);
  const V all_low = hn::Set(d, low.sum()), all_more = hn::Set(d, more.sum());
  V total = zero, rising = zero;
  for (int j = 0; j < nodes.count; ++j) {
    const V c = hn::Min(hn::Max(nodes.cos_difference[j], zero), one);
    const V share = nodes.share[j], rise = schlick_rise(d, c);
    total = total + share;
    rising = hn::MulAdd(share, rise, rising);
    nodes.share[j] = share * hn::MulAdd(all_more, rise, all_low);
  }
  const auto channel = [&](int k) HWY_ATTR {
    return hn::MulAdd(total, hn::Set(d, low[k]), rising * hn::Set(d, more[k]));
  };
  return {channel(0), channel(1), channel(2)};
}

/// The nodes' sum, by channel, without BrdfNumbers::scale; their shares become sums over channels.
template <class D, class V>
HWY_NOINLINE RgbVector<V> color_nodes(D d, const BrdfNumbers& n, SliceNodes<V>& nodes) {
  if (n.fresnel_kind == FresnelKind::schlick)
    return color_linear(d, n.specular, n.fresnel.normal_reflectance, nodes);
  if (n.fresnel_kind == FresnelKind::none) return color_linear(d, n.specular, Rgb::Ones(), nodes);
  const V zero = hn::Zero(d);
  RgbVector<V> sum = {zero, zero, zero};
  for (int j = 0; j < nodes.count; ++j) {
    const RgbVector<V> color = eval_color(d, n, nodes.cos_difference[j]);
    V total = zero;
    for (size_t channel = 0; channel < 3; ++channel) {
      const V scale = hn::Set(d, n.specular[static_cast<int>(channel)]);
      const V part = nodes.share[j] * (color[channel] * scale);
      sum[channel] = sum[channel] + part;
      total = total + part;
    }
    nodes.share[j] = total;
  }
  return sum;
}

template <class D, class V>
HWY_INLINE Frame<V> frame_from_axis(D d, const Vector3<V>& axis) {
  const V sign = hn::CopySign(hn::Set(d, 1.0f), axis.z);
  const V a = hn::Set(d, -1.0f) / (sign + axis.z);
  const V b = axis.x * axis.y * a;
  return {
      {hn::MulAdd(sign * axis.x, axis.x * a, hn::Set(d, 1.0f)), sign * b, hn::Neg(sign * axis.x)},
      {b, hn::MulAdd(axis.y, axis.y * a, sign), hn::Neg(axis.y)},
      axis};
}

/// A mean direction, as a frame's z, and the covariance about it in x and y.
template <class V>
struct Covariance {
  Frame<V> frame;
  V xx, xy, yy;
};

/// Of the nodes' offsets, in the tooth's frame. `o` is the view there.
template <class D, class V>
HWY_INLINE Covariance<V> covariance_of(D d, const Vector3<V>& o, const SliceNodes<V>& nodes) {
  const V one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  Vector3<V> mean = {zero, zero, zero};
  V total = zero;
  for (int j = 0; j < nodes.count; ++j) {
    const V share = nodes.share[j];
    total = total + share;
    mean = {hn::MulAdd(share, nodes.offset[j].x, mean.x),
            hn::MulAdd(share, nodes.offset[j].y, mean.y),
            hn::MulAdd(share, nodes.offset[j].z, mean.z)};
  }
  const V over_total = hn::IfThenElseZero(hn::Gt(total, zero), one / total);
  mean = {mean.x * over_total, mean.y * over_total, mean.z * over_total};
  const Vector3<V> axis = {mean.x - o.x, mean.y - o.y, mean.z + o.z};
  const V length = one / hn::Sqrt(dot(axis, axis));
  Covariance<V> result;
  result.frame = frame_from_axis(d, Vector3<V>{axis.x * length, axis.y * length, axis.z * length});
  const Frame<V>& tangent = result.frame;
  const V mean_x = dot(mean, tangent.x), mean_y = dot(mean, tangent.y);
  // A share that all nodes have alike: a width, where all but one of them weigh nothing.
  constexpr float kEven = 0.02f;
  const V even = hn::Set(d, kEven), uneven = hn::Set(d, 1 - kEven) * over_total;
  result.xx = result.xy = result.yy = zero;
  for (int j = 0; j < nodes.count; ++j) {
    const V x = dot(nodes.offset[j], tangent.x) - mean_x;
    const V y = dot(nodes.offset[j], tangent.y) - mean_y;
    const V w = hn::MulAdd(uneven, nodes.share[j], even * nodes.part[j]);
    const V wx = w * x;
    result.xx = hn::MulAdd(wx, x, result.xx);
    result.xy = hn::MulAdd(wx, y, result.xy);
    result.yy = hn::MulAdd(w * y, y, result.yy);
  }
  return result;
}

/// A lobe of unit amplitude of this mean and covariance, in the frame they are in.
template <class D, class V>
HWY_INLINE WarpedLobe<V> lobe_from_covariance(D d, const Covariance<V>& c) {
  const V one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
  const V half_difference = half * (c.xx - c.yy);
  const V radius = hn::Sqrt(hn::MulAdd(half_difference, half_difference, c.xy * c.xy));
  const V wide = hn::Max(hn::MulAdd(half, c.xx + c.yy, radius), hn::Set(d, 1e-30f));
  const V over_wide = one / wide;
  // Ratio of variances that a few nodes can tell.
  const V thinnest = hn::Set(d, 1e-4f) * wide;
  const V narrow = hn::Max(hn::NegMulAdd(c.xy, c.xy, c.xx * c.yy) * over_wide, thinnest);
  const MajorAxis<V> axis =
      major_axis(d, half_difference * over_wide, c.xy * over_wide, radius * over_wide);
  const V scale = one / hn::Sqrt(axis.length_squared);
  const V cosine = axis.cosine * scale, sine = axis.sine * scale;
  const Frame<V>& frame = c.frame;
  WarpedLobe<V> lobe;
  // The major axis times z.
  lobe.x = {hn::MulSub(sine, frame.x.x, cosine * frame.y.x),
            hn::MulSub(sine, frame.x.y, cosine * frame.y.y),
            hn::MulSub(sine, frame.x.z, cosine * frame.y.z)};
  lobe.z = frame.z;
  // Of a narrow lobe the variance is 1 / (2 bandwidth + 1), to first order.
  const V widest = hn::Set(d, 0.05f);
  lobe.bandwidth_x = hn::Max(hn::MulSub(half, one / narrow, half), widest);
  lobe.bandwidth_y = hn::Max(hn::MulSub(half, over_wide, half), widest);
  lobe.amplitude = lobe.jacobian = one;
  return lobe;
}

template <class D>
HWY_INLINE Frame<hn::VFromD<D>> set_all(D d, const burnish::Frame<float>& frame) {
  const auto all = [d](const Vector3f& v) HWY_ATTR {
    return Vector3<hn::VFromD<D>>{hn::Set(d, v.x()), hn::Set(d, v.y()), hn::Set(d, v.z())};
  };
  return {all(frame.x), all(frame.y), all(frame.z)};
}

template <class D>
constexpr size_t kVectors = kBlock / hn::MaxLanes(D());

/// A tooth of a material, and how a block's points see it.
template <class D>
struct ToothBlock {
  using V = hn::VFromD<D>;
  const PreparedMaterial& prepared;
  const BrdfNumbers& numbers;
  const SpecularTooth& tooth;
  Frame<V> frame;
  size_t vectors;
  SeenTooth<V> seen[kVectors<D>];
  SliceNodes<V> nodes[kVectors<D>];

  /// The arrays are left as they are.
  HWY_INLINE ToothBlock(D d, const PreparedMaterial& material, const BrdfNumbers& its_numbers,
                        int number, size_t count)
      : prepared(material),
        numbers(its_numbers),
        tooth(material.tooth[static_cast<size_t>(number)]),
        frame(set_all(d, tooth.lobe.frame)),
        vectors((count + hn::Lanes(d) - 1) / hn::Lanes(d)) {}
};

/// A view from below is replaced by one that is like any other.
template <class D, class T>
HWY_INLINE void see_tooth(D d, const BlockVector3<T>& outgoing, ToothBlock<D>& block) {
  using V = hn::VFromD<D>;
  for (size_t v = 0; v < block.vectors; ++v) {
    const size_t i = v * hn::Lanes(d);
    const V z = hn::Load(d, outgoing.z.data() + i);
    const auto is_above = hn::Gt(z, hn::Zero(d));
    SeenTooth<V>& seen = block.seen[v];
    seen.outgoing = {hn::IfThenElseZero(is_above, hn::Load(d, outgoing.x.data() + i)),
                     hn::IfThenElseZero(is_above, hn::Load(d, outgoing.y.data() + i)),
                     hn::IfThenElse(is_above, z, hn::Set(d, 1.0f))};
    seen.local = to_local(block.frame, seen.outgoing);
  }
}

template <class D, class V, class T>
HWY_INLINE void store_lobe(D d, const WarpedLobe<V>& lobe, V integral, size_t i,
                           SliceBlock<T>& result) {
  hn::Store(lobe.x.x, d, result.lobes.x.x.data() + i);
  hn::Store(lobe.x.y, d, result.lobes.x.y.data() + i);
  hn::Store(lobe.x.z, d, result.lobes.x.z.data() + i);
  hn::Store(lobe.z.x, d, result.lobes.z.x.data() + i);
  hn::Store(lobe.z.y, d, result.lobes.z.y.data() + i);
  hn::Store(lobe.z.z, d, result.lobes.z.z.data() + i);
  hn::Store(lobe.bandwidth_x, d, result.lobes.bandwidth_x.data() + i);
  hn::Store(lobe.bandwidth_y, d, result.lobes.bandwidth_y.data() + i);
  hn::Store(integral, d, result.integral.data() + i);
}

/// Sums of the nodes times a scale, 0 for views from below.
template <class D, class V, class T>
HWY_INLINE void store_weight(D d, const RgbVector<V>& sum, V scale, const BlockVector3<T>& outgoing,
                             size_t i, SliceBlock<T>& result) {
  const auto is_above = hn::Gt(hn::Load(d, outgoing.z.data() + i), hn::Zero(d));
  for (size_t channel = 0; channel < 3; ++channel)
    hn::Store(hn::IfThenElseZero(is_above, sum[channel] * scale), d,
              result.weight[channel].data() + i);
}

/// f over the lobes' sum at all nodes.
template <class D>
HWY_INLINE void weigh_block(D d, bool corrects, ToothBlock<D>& block) {
  with_kind(block.numbers.kind, [&](auto kind) HWY_ATTR {
    for (size_t v = 0; v < block.vectors; ++v)
      weigh_nodes<decltype(kind)::value>(d, block.prepared, block.numbers, block.seen[v].outgoing,
                                         corrects, block.nodes[v]);
  });
}

/// SpecularForm::moments.
template <class D, class T>
HWY_INLINE void match_moments(D d, const BlockVector3<T>& outgoing, ToothBlock<D>& block,
                              SliceBlock<T>& result) {
  using V = hn::VFromD<D>;
  const burnish::Frame<float>& frame = block.tooth.lobe.frame;
  const Vector3f normal(frame.x.z(), frame.y.z(), frame.z.z());
  NodePlan<V> plan[kVectors<D>];
  for (size_t v = 0; v < block.vectors; ++v)
    plan[v] = plan_nodes(d, block.tooth, block.seen[v].local, normal);
  for (size_t v = 0; v < block.vectors; ++v)
    add_nodes(d, block.frame, block.seen[v], plan[v], block.nodes[v]);
  weigh_block(d, block.prepared.corrects_distribution, block);
  RgbVector<V> sum[kVectors<D>];
  for (size_t v = 0; v < block.vectors; ++v) sum[v] = color_nodes(d, block.numbers, block.nodes[v]);
  Covariance<V> covariance[kVectors<D>];
  for (size_t v = 0; v < block.vectors; ++v)
    covariance[v] = covariance_of(d, block.seen[v].local, block.nodes[v]);
  const V mass = hn::Set(d, block.tooth.integral * block.numbers.scale);
  for (size_t v = 0; v < block.vectors; ++v) {
    WarpedLobe<V> lobe = lobe_from_covariance(d, covariance[v]);
    lobe.x = to_world(block.frame, lobe.x);
    lobe.z = to_world(block.frame, lobe.z);
    const V integral = asg_integral_exact(d, lobe.bandwidth_x, lobe.bandwidth_y);
    const size_t i = v * hn::Lanes(d);
    store_lobe(d, lobe, integral, i, result);
    store_weight(d, sum[v], mass * plan[v].rule.probability / integral, outgoing, i, result);
  }
}

/// SpecularForm::peak: Eq. 23-30.
template <class D, class T>
HWY_INLINE void take_peak(D d, const BlockVector3<T>& outgoing, ToothBlock<D>& block,
                          SliceBlock<T>& result) {
  using V = hn::VFromD<D>;
  const V bandwidth_x = hn::Set(d, block.tooth.lobe.bandwidth_x);
  const V bandwidth_y = hn::Set(d, block.tooth.lobe.bandwidth_y), least = hn::Set(d, 1e-6f);
  for (size_t v = 0; v < block.vectors; ++v) {
    WarpedLobe<V> lobe =
        warp_to_incoming(d, block.frame, bandwidth_x, bandwidth_y, block.seen[v].outgoing);
    // D of the roughest materials is flat in the middle.
    lobe.bandwidth_x = hn::Max(lobe.bandwidth_x, least);
    lobe.bandwidth_y = hn::Max(lobe.bandwidth_y, least);
    SliceNodes<V>& nodes = block.nodes[v];
    nodes.count = 1;
    nodes.incoming[0] = lobe.z;
    nodes.cos_difference[0] = block.seen[v].local.z;
    nodes.share[0] = lobe.amplitude;
    store_lobe(d, lobe, asg_integral_exact(d, lobe.bandwidth_x, lobe.bandwidth_y), v * hn::Lanes(d),
               result);
  }
  weigh_block(d, false, block);
  const V scale = hn::Set(d, block.tooth.lobe.amplitude * block.numbers.scale);
  for (size_t v = 0; v < block.vectors; ++v) {
    const RgbVector<V> sum = color_nodes(d, block.numbers, block.nodes[v]);
    store_weight(d, sum, scale, outgoing, v * hn::Lanes(d), result);
  }
}

/// One tooth of a material that has_specular(), seen from `count` points, 1..kBlock: `outgoing`
/// unit, in the local frame. `numbers` are the material's. Lanes up to the next whole vector are
/// valid, and so they are in the result. Weight 0 where there is nothing. Bandwidths are above 0.
///
/// It goes through the block step by step: as one, most of the time the processor would wait for a
/// chain of divisions and roots.
template <class D, class T = hn::TFromD<D>>
void slice_tooth(D d, const PreparedMaterial& prepared, const BrdfNumbers& numbers, int tooth,
                 size_t count, const BlockVector3<T>& outgoing, SliceBlock<T>& result) {
  ToothBlock<D> block(d, prepared, numbers, tooth, count);
  see_tooth(d, outgoing, block);
  if (prepared.form == SpecularForm::moments)
    match_moments(d, outgoing, block, result);
  else
    take_peak(d, outgoing, block, result);
}

template <class D, class T = hn::TFromD<D>>
void slice_tooth(D d, const PreparedMaterial& prepared, int tooth, size_t count,
                 const BlockVector3<T>& outgoing, SliceBlock<T>& result) {
  slice_tooth(d, prepared, internal::brdf_numbers(prepared.material), tooth, count, outgoing,
              result);
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
