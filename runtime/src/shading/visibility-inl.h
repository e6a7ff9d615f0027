// What the points of a block see in a direction each, and of a lobe each: one point a lane.

#if defined(BURNISH_SHADING_VISIBILITY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_SHADING_VISIBILITY_INL_H_
#undef BURNISH_SHADING_VISIBILITY_INL_H_
#else
#define BURNISH_SHADING_VISIBILITY_INL_H_
#endif

#include <type_traits>

#include <hwy/cache_control.h>
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "burnish/sphere/half_space.h"
#include "burnish/sphere/octahedral_map.h"
#include "shading/block.h"
#include "shading/multiply_rows-inl.h"
#include "sphere/half_space-inl.h"
#include "sphere/lobes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {

template <class D, class T>
HWY_INLINE Vector3<hn::VFromD<D>> load(D d, const BlockVector3<T>& vectors, size_t i) {
  return {hn::Load(d, vectors.x.data() + i), hn::Load(d, vectors.y.data() + i),
          hn::Load(d, vectors.z.data() + i)};
}

template <class D, class V, class T>
HWY_INLINE void store(D d, const Vector3<V>& v, BlockVector3<T>& vectors, size_t i) {
  hn::Store(v.x, d, vectors.x.data() + i);
  hn::Store(v.y, d, vectors.y.data() + i);
  hn::Store(v.z, d, vectors.z.data() + i);
}

/// The nearest boundary in a direction of each point, as half a space: the sine of its distance,
/// and its gradient, unit, or zero where there is none.
template <class T>
struct BlockBoundaries {
  BlockArray<T> sine;
  BlockVector3<T> gradient;
};

/// Where a lookup between the points of a grid falls.
template <class T>
struct BlockFootprints {
  alignas(64) std::int32_t x[kBlock], y[kBlock];  ///< of the first point
  BlockArray<T> fraction_x, fraction_y;
};

template <class D, class V, class T = hn::TFromD<D>>
HWY_INLINE void store_footprints(D d, V x, V y, size_t i, BlockFootprints<T>& footprints) {
  const auto floor_x = hn::Floor(x), floor_y = hn::Floor(y);
  hn::Store(hn::Sub(x, floor_x), d, footprints.fraction_x.data() + i);
  hn::Store(hn::Sub(y, floor_y), d, footprints.fraction_y.data() + i);
  const hn::Rebind<std::int32_t, D> di;
  if constexpr (std::is_same_v<T, float>) {
    hn::Store(hn::ConvertTo(di, floor_x), di, footprints.x + i);
    hn::Store(hn::ConvertTo(di, floor_y), di, footprints.y + i);
  } else {
    hn::StoreU(hn::DemoteTo(di, floor_x), di, footprints.x + i);
    hn::StoreU(hn::DemoteTo(di, floor_y), di, footprints.y + i);
  }
}

/// Of a bilinear lookup of an octahedral map: texels -1..resolution - 1.
template <class D, class T = hn::TFromD<D>>
HWY_INLINE void find_footprints(D d, size_t count, const BlockVector3<T>& directions,
                                int resolution, BlockFootprints<T>& footprints) {
  const auto n = hn::Set(d, static_cast<T>(resolution)), half = hn::Set(d, T(0.5));
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto uv = direction_to_octahedral(d, load(d, directions, i));
    store_footprints(d, hn::MulSub(uv.x, n, half), hn::MulSub(uv.y, n, half), i, footprints);
  }
}

/// The texels of a footprint: (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1).
HWY_INLINE void footprint_texels(int x, int y, int resolution, size_t (&texel)[4]) {
  if (x >= 0 && y >= 0 && x + 1 < resolution && y + 1 < resolution) {
    texel[0] = static_cast<size_t>(y * resolution + x);
    texel[1] = texel[0] + 1;
    texel[2] = texel[0] + static_cast<size_t>(resolution);
    texel[3] = texel[2] + 1;
    return;
  }
  for (int j = 0; j < 4; ++j)
    texel[j] = static_cast<size_t>(octahedral_wrap(x + j % 2, y + j / 2, resolution));
}

/// The sums of the lanes of four vectors.
#if HWY_TARGET == HWY_SCALAR
template <class D, class V, class T = hn::TFromD<D>>
HWY_INLINE void sum_lanes(D, const V (&v)[4], T (&sums)[4]) {
  for (int j = 0; j < 4; ++j) sums[j] = hn::GetLane(v[j]);
}
#else
template <class D, class V, class T = hn::TFromD<D>>
HWY_INLINE void sum_lanes(D d, const V (&v)[4], T (&sums)[4]) {
  constexpr size_t kLanes = hn::MaxLanes(D());
  if constexpr (kLanes > 4) {
    const hn::Half<D> half;
    const auto fold = [half](V whole) HWY_ATTR {
      return hn::Add(hn::LowerHalf(half, whole), hn::UpperHalf(half, whole));
    };
    const hn::VFromD<hn::Half<D>> folded[4] = {fold(v[0]), fold(v[1]), fold(v[2]), fold(v[3])};
    sum_lanes(half, folded, sums);
  } else if constexpr (kLanes == 4 && sizeof(T) == 4) {
    const V ab = hn::Add(hn::InterleaveLower(d, v[0], v[1]), hn::InterleaveUpper(d, v[0], v[1]));
    const V ce = hn::Add(hn::InterleaveLower(d, v[2], v[3]), hn::InterleaveUpper(d, v[2], v[3]));
    hn::StoreU(hn::Add(hn::ConcatLowerLower(d, ce, ab), hn::ConcatUpperUpper(d, ce, ab)), d, sums);
  } else {
    for (int j = 0; j < 4; ++j) sums[j] = hn::GetLane(hn::SumOfLanes(d, v[j]));
  }
}
#endif

/// Products of a row of coefficients with rows of a basis at four texels.
template <class D, class Number, class T = hn::TFromD<D>>
HWY_INLINE void products_at(D d, const T* coefficients, const Number* basis, size_t stride,
                            size_t size, const size_t (&texel)[4], T (&products)[4]) {
  const Number* a = basis + texel[0] * stride;
  const Number* b = basis + texel[1] * stride;
  const Number* c = basis + texel[2] * stride;
  const Number* e = basis + texel[3] * stride;
  using V = hn::VFromD<D>;
  V sum[4] = {hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  for (size_t k = 0; k < size; k += hn::Lanes(d)) {
    const V weight = hn::Load(d, coefficients + k);
    sum[0] = hn::MulAdd(weight, load_floats(d, a + k), sum[0]);
    sum[1] = hn::MulAdd(weight, load_floats(d, b + k), sum[1]);
    sum[2] = hn::MulAdd(weight, load_floats(d, c + k), sum[2]);
    sum[3] = hn::MulAdd(weight, load_floats(d, e + k), sum[3]);
  }
  sum_lanes(d, sum, products);
}

/// The SSDF's value, and its derivatives by u and v in texels.
template <class T>
struct BlockSsdf {
  BlockArray<T> value, by_u, by_v;
};

HWY_INLINE const std::uint16_t* eigenvectors(const PreparedTransfer::Basis& basis, std::uint16_t) {
  return basis.eigen16.data();
}
HWY_INLINE const float* eigenvectors(const PreparedTransfer::Basis& basis, float) {
  return basis.eigen32.data();
}

/// Ranges of memory that read_ssdf has on their way while it reads a row: of two rows.
inline constexpr size_t kFetchedARow = 4;

/// What read_ssdf reads of the bases.
template <class Number, class T>
HWY_INLINE void fetch_ssdf(const PreparedTransfer& transfer, const ShadingBlock<T>& block,
                           size_t terms, const BlockFootprints<T>& footprints, size_t row,
                           Fetcher& fetcher) {
  const size_t stride = padded_terms(transfer.terms), point = block.row[row].point;
  size_t texel[4];
  footprint_texels(footprints.x[point], footprints.y[point], transfer.resolution, texel);
  const Number* eigen = eigenvectors(transfer.bases[block.row[row].basis], Number());
  if (texel[1] == texel[0] + 1 && texel[3] == texel[2] + 1) {
    fetcher.add(eigen + texel[0] * stride, (stride + terms) * sizeof(Number));
    fetcher.add(eigen + texel[2] * stride, (stride + terms) * sizeof(Number));
  } else {
    for (const size_t t : texel) fetcher.add(eigen + t * stride, terms * sizeof(Number));
  }
}

/// `Number`: that of the transfer's format.
template <class Number, class D, class T = hn::TFromD<D>>
HWY_INLINE void read_ssdf(D d, const PreparedTransfer& transfer, ShadingBlock<T>& block,
                          size_t terms, const BlockFootprints<T>& footprints, BlockSsdf<T>& ssdf) {
  const size_t stride = padded_terms(transfer.terms);
  for (size_t i = 0; i < block.count; ++i) ssdf.value[i] = ssdf.by_u[i] = ssdf.by_v[i] = 0;
  for (size_t r = 0; r < block.row_count; ++r) {
    const VisibilityRow<T>& row = block.row[r];
    const PreparedTransfer::Basis& basis = transfer.bases[row.basis];
    const size_t i = row.point;
    size_t texel[4];
    footprint_texels(footprints.x[i], footprints.y[i], transfer.resolution, texel);
    T v[4];
    block.fetcher.fetch(kFetchedARow);
    products_at(d, row.ssdf, eigenvectors(basis, Number()), stride, terms, texel, v);
    for (int j = 0; j < 4; ++j) v[j] += static_cast<T>(basis.mean[texel[j]]);
    const T fx = footprints.fraction_x[i], fy = footprints.fraction_y[i];
    const T upper = v[0] + fx * (v[1] - v[0]), lower = v[2] + fx * (v[3] - v[2]);
    ssdf.value[i] += row.weight * (upper + fy * (lower - upper));
    ssdf.by_u[i] += row.weight * ((1 - fy) * (v[1] - v[0]) + fy * (v[3] - v[2]));
    ssdf.by_v[i] += row.weight * (lower - upper);
  }
}

/// octahedral_gradient, up to a positive factor. With p = |2 u - 1| and q = |2 v - 1| folded to the
/// upper half, r = p + q is sqrt(1 - |z|), and the azimuth in a quadrant is q / r of it.
template <class D, class V>
HWY_INLINE Vector3<V> octahedral_gradient(D d, const Vector3<V>& direction, V by_u, V by_v) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f), tiny = hn::Set(d, 1e-6f);
  const V x = hn::Abs(direction.x), y = hn::Abs(direction.y), z = hn::Abs(direction.z);
  const V radius = root(d, hn::MulAdd(x, x, hn::Mul(y, y)));
  const auto off_axis = hn::Gt(radius, tiny);
  const V inverse = reciprocal(d, hn::Max(radius, tiny));
  const V cosine = hn::IfThenElse(off_axis, hn::Mul(x, inverse), one);
  const V sine = hn::IfThenElseZero(off_axis, hn::Mul(y, inverse));
  const V large = hn::Max(x, y), small = hn::Min(x, y);
  const V angle = quarter_arctangent(
      d, hn::IfThenElseZero(off_axis, hn::Mul(small, reciprocal(d, hn::Max(large, tiny)))));
  const V share = hn::IfThenElse(hn::Lt(x, y), hn::Sub(one, angle), angle);
  const auto below = hn::Lt(direction.z, zero);
  const V by_p0 = hn::CopySign(one, direction.x) * by_u,
          by_q0 = hn::CopySign(one, direction.y) * by_v;
  const V by_p = hn::IfThenElse(below, hn::Neg(by_q0), by_p0);
  const V by_q = hn::IfThenElse(below, hn::Neg(by_p0), by_q0);
  const V root_z = root(d, hn::Add(one, z));
  const V outward =
      hn::Mul(hn::Mul(hn::Set(d, 0.5f), root_z), hn::MulAdd(share, hn::Sub(by_q, by_p), by_p));
  const V around =
      hn::Mul(hn::Mul(hn::Set(d, 0.636619772f), hn::Sub(by_q, by_p)), reciprocal(d, root_z));
  const V along = hn::Mul(outward, z);
  return {hn::CopySign(one, direction.x) * hn::MulSub(along, cosine, hn::Mul(around, sine)),
          hn::CopySign(one, direction.y) * hn::MulAdd(along, sine, hn::Mul(around, cosine)),
          hn::CopySign(one, direction.z) * hn::Neg(hn::Mul(outward, radius))};
}

/// A value of the SSDF, compressed at this amplitude (0: not), as the sine of the distance.
template <class D, class V>
HWY_INLINE V sine_of_ssdf(D d, V value, float amplitude_rad) {
  if (!(amplitude_rad > 0)) return sine(d, held_distance(d, value));
  const V one = hn::Set(d, 1.0f), size = hn::Min(hn::Abs(value), hn::Set(d, 0.9999999f));
  const V distance =
      hn::Mul(hn::Set(d, amplitude_rad / 2),
              hn::Log(d, hn::Mul(hn::Add(one, size), reciprocal(d, hn::Sub(one, size)))));
  return sine(d, held_distance(d, hn::CopySign(distance, value)));
}

/// A gradient as a unit vector; below this slope (a signed distance has 1, in radians) its
/// direction is rounding noise, and it is 0.
template <class D, class V>
HWY_INLINE Vector3<V> unit_gradient(D d, const Vector3<V>& gradient, float least) {
  const V square = dot(gradient, gradient), bound = hn::Set(d, least * least);
  const V scale =
      hn::IfThenElseZero(hn::Gt(square, bound), reciprocal_root(d, hn::Max(square, bound)));
  return {hn::Mul(gradient.x, scale), hn::Mul(gradient.y, scale), hn::Mul(gradient.z, scale)};
}

/// Where the SSDFs are looked up in a direction of each point, of which all memory is on its way.
template <class D, class T = hn::TFromD<D>>
HWY_INLINE void start_lookups(D d, const PreparedTransfer& transfer, ShadingBlock<T>& block,
                              size_t terms, const BlockVector3<T>& directions,
                              BlockFootprints<T>& footprints) {
  find_footprints(d, block.count, directions, transfer.resolution, footprints);
  for (size_t r = 0; r < block.row_count; ++r)
    if (transfer.format == RowFormat::float16)
      fetch_ssdf<std::uint16_t>(transfer, block, terms, footprints, r, block.fetcher);
    else
      fetch_ssdf<float>(transfer, block, terms, footprints, r, block.fetcher);
}

/// The boundary in a direction of each point, at the footprints of start_lookups.
template <class D, class T = hn::TFromD<D>>
HWY_INLINE void find_boundaries(D d, const PreparedTransfer& transfer, ShadingBlock<T>& block,
                                size_t terms, const BlockVector3<T>& directions,
                                const BlockFootprints<T>& footprints,
                                BlockBoundaries<T>& boundaries) {
  BlockSsdf<T> ssdf;
  if (transfer.format == RowFormat::float16)
    read_ssdf<std::uint16_t>(d, transfer, block, terms, footprints, ssdf);
  else
    read_ssdf<float>(d, transfer, block, terms, footprints, ssdf);
  // Of a slope of 1e-4, below which its direction is rounding noise; half a texel's is what the
  // gradient is in.
  const float least = 2e-4f / static_cast<float>(transfer.resolution);
  for (size_t i = 0; i < block.count; i += hn::Lanes(d)) {
    hn::Store(sine_of_ssdf(d, hn::Load(d, ssdf.value.data() + i), transfer.amplitude_rad), d,
              boundaries.sine.data() + i);
    const auto gradient =
        octahedral_gradient(d, load(d, directions, i), hn::Load(d, ssdf.by_u.data() + i),
                            hn::Load(d, ssdf.by_v.data() + i));
    store(d, unit_gradient(d, gradient, least), boundaries.gradient, i);
  }
}

/// A boundary of one lobe a lane.
template <class V>
struct Boundary {
  V sine;
  Vector3<V> gradient;
};

/// The horizon of a normal.
template <class D, class V>
HWY_INLINE Boundary<V> horizon(D d, const Vector3<V>& normal, const Vector3<V>& direction) {
  const V one = hn::Set(d, 1.0f);
  const V sine = hn::Max(hn::Min(dot(normal, direction), one), hn::Neg(one));
  const Vector3<V> gradient = {hn::NegMulAdd(sine, direction.x, normal.x),
                               hn::NegMulAdd(sine, direction.y, normal.y),
                               hn::NegMulAdd(sine, direction.z, normal.z)};
  return {sine, unit_gradient(d, gradient, 1e-6f)};
}

/// What directional_bandwidth needs of a lobe, of bandwidths from 1e-3 to 1e12.
template <class V>
struct DirectionalShape {
  V small, large, ratio, mean;
  V wide_x, wide_y, narrow_x, narrow_y;  ///< select the components along the axes: 0 or 1
};

template <class D, class V>
HWY_INLINE DirectionalShape<V> directional_shape(D d, const AnisotropicGaussian<V>& lobe) {
  const V one = hn::Set(d, 1.0f), least = hn::Set(d, 1e-3f), most = hn::Set(d, 1e12f);
  const V large = hn::Min(hn::Max(hn::Max(lobe.bandwidth_x, lobe.bandwidth_y), least), most);
  const V low = hn::Min(hn::Max(hn::Min(lobe.bandwidth_x, lobe.bandwidth_y), least), most);
  const V shift =
      hn::Mul(hn::Sub(large, low), reciprocal(d, hn::Mul(hn::Add(one, low), hn::Add(one, large))));
  const V small = hn::MulAdd(hn::Set(d, 2.0f / 3), shift, low);
  const auto x_is_wide = hn::Lt(lobe.bandwidth_x, lobe.bandwidth_y);
  const V wide_x = hn::IfThenElseZero(x_is_wide, one);
  const V wide_y = hn::IfThenZeroElse(x_is_wide, one);
  return {small,
          large,
          hn::Mul(small, reciprocal(d, large)),
          root(d, hn::Mul(small, large)),
          wide_x,
          wide_y,
          wide_y,
          wide_x};
}

/// directional_bandwidth for a unit gradient, or none, by its components in the lobe's frame.
template <class D, class V>
HWY_INLINE V directional_bandwidth(D d, const DirectionalShape<V>& shape, V x, V y) {
  const V tiny = hn::Set(d, 1e-12f);
  const V w = hn::MulAdd(x, shape.wide_x, hn::Mul(y, shape.wide_y));
  const V n = hn::MulAdd(x, shape.narrow_x, hn::Mul(y, shape.narrow_y));
  const V wide = hn::Mul(w, w), narrow = hn::Mul(n, n), square = hn::Add(wide, narrow);
  const auto is_flat = hn::Lt(square, tiny);
  const V numerator = hn::Mul(shape.small, square);
  const V across =
      hn::Mul(numerator, reciprocal(d, hn::Max(hn::MulAdd(narrow, shape.ratio, wide), tiny)));
  const V along =
      hn::Mul(numerator, reciprocal(d, hn::Max(hn::MulAdd(wide, shape.ratio, narrow), tiny)));
  const V held = hn::IfThenElse(is_flat, shape.mean, hn::Min(across, shape.large));
  const V held_along = hn::IfThenElse(is_flat, shape.mean, hn::Min(along, shape.large));
  const V bend = reciprocal(d, hn::MulAdd(hn::Set(d, 2.0f), held_along, hn::Set(d, 2.5f)));
  return hn::NegMulAdd(held, bend, held);
}

/// visible_fraction_directional to 4e-7, from the sine of the distance.
template <class D, class V>
HWY_INLINE V fraction_past(D d, V bandwidth, V sine) {
  const V half = hn::Set(d, 0.5f), far = root(d, bandwidth);
  const V seen = hn::Mul(half, hn::CopySign(erf_of_positive(d, hn::Mul(far, hn::Abs(sine))), sine));
  const auto is_narrow = hn::Gt(far, hn::Set(d, 4.0f));
  if (hn::AllTrue(d, is_narrow)) return hn::Add(seen, half);
  // By lane, so that what a point sees is the same to the bit whoever its neighbours are.
  const V scale =
      hn::IfThenElse(is_narrow, hn::Set(d, 1.0f), reciprocal(d, erf_of_positive(d, far)));
  return hn::Max(hn::MulAdd(seen, scale, half), hn::Zero(d));
}

/// visible_fraction of a lobe past a boundary, by the models of the papers.
template <class D, class V>
HWY_INLINE V round_fraction(D d, VisibilityModel model, const AnisotropicGaussian<V>& lobe,
                            V sine) {
  const V sharpness =
      hn::Mul(hn::Set(d, 2.0f), hn::Mul(hn::Sqrt(lobe.bandwidth_x), hn::Sqrt(lobe.bandwidth_y)));
  if (model == VisibilityModel::hemisphere) {
    const V one = hn::Set(d, 1.0f);
    const V cosine = root(d, hn::Max(hn::NegMulAdd(sine, sine, one), hn::Zero(d)));
    const V half_sine =
        hn::Mul(sine, reciprocal_root(d, hn::Mul(hn::Set(d, 2.0f), hn::Add(one, cosine))));
    return hemisphere_fraction(d, prepare_hemisphere(d, sharpness), half_sine);
  }
  using T = hn::TFromD<D>;
  HWY_ALIGN T fractions[hn::MaxLanes(D())], sines[hn::MaxLanes(D())];
  hn::Store(sharpness, d, fractions);
  hn::Store(sine, d, sines);
  for (size_t j = 0; j < hn::Lanes(d); ++j)
    fractions[j] = visible_fraction_cap(fractions[j], std::asin(std::clamp(sines[j], T(-1), T(1))));
  return hn::Load(d, fractions);
}

/// visible_fraction of a lobe past a boundary.
template <class D, class V>
HWY_INLINE V visible_fraction(D d, VisibilityModel model, const AnisotropicGaussian<V>& lobe,
                              const Boundary<V>& boundary) {
  if (model != VisibilityModel::directional) return round_fraction(d, model, lobe, boundary.sine);
  const V bandwidth =
      directional_bandwidth(d, directional_shape(d, lobe), dot(boundary.gradient, lobe.x),
                            dot(boundary.gradient, lobe.y));
  return fraction_past(d, bandwidth, boundary.sine);
}

/// How far two boundaries cut the same off a lobe: the square of the correlation of the distances
/// from them, where that is positive. 1: both lie across the same direction; 0: neither tells of
/// the other.
template <class D, class V>
HWY_INLINE V overlap(D d, const AnisotropicGaussian<V>& lobe, const Vector3<V>& a,
                     const Vector3<V>& b) {
  const V one = hn::Set(d, 1.0f), tiny = hn::Set(d, 1e-20f);
  const V xx = lobe.bandwidth_y, yy = lobe.bandwidth_x;  // variances, but for a factor
  const V ax = dot(a, lobe.x), ay = dot(a, lobe.y), bx = dot(b, lobe.x), by = dot(b, lobe.y);
  const auto product = [&](V x, V y) HWY_ATTR { return hn::MulAdd(x, xx, hn::Mul(y, yy)); };
  const V aa = product(hn::Mul(ax, ax), hn::Mul(ay, ay));
  const V bb = product(hn::Mul(bx, bx), hn::Mul(by, by));
  const V ab = hn::Max(product(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Zero(d));
  return hn::Min(hn::Mul(hn::Mul(ab, ab), reciprocal(d, hn::Max(hn::Mul(aa, bb), tiny))), one);
}

/// Of what of a lobe is above a normal's horizon, the part that is visible. Both vanish together
/// where the lobe is far below the horizon; there what it lights does, too.
template <class D, class V>
HWY_INLINE V visible_share(D d, VisibilityModel model, const AnisotropicGaussian<V>& lobe,
                           const Boundary<V>& boundary, const Vector3<V>& normal) {
  const V one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  V seen, above;
  if (model == VisibilityModel::directional) {
    const DirectionalShape<V> shape = directional_shape(d, lobe);
    const V horizon_sine = dot(normal, lobe.z);
    // The horizon's gradient is the normal, but for its part along the axis, which no axis of the
    // lobe sees.
    seen = fraction_past(d,
                         directional_bandwidth(d, shape, dot(boundary.gradient, lobe.x),
                                               dot(boundary.gradient, lobe.y)),
                         boundary.sine);
    above = fraction_past(
        d, directional_bandwidth(d, shape, dot(normal, lobe.x), dot(normal, lobe.y)), horizon_sine);
  } else {
    seen = round_fraction(d, model, lobe, boundary.sine);
    above = round_fraction(d, model, lobe, dot(normal, lobe.z));
  }
  // Where next to nothing is above the horizon both are rounding, and the share passes to 1.
  const V little = hn::Set(d, 1e-10f), held = hn::Max(above, zero);
  seen = hn::Max(seen, zero);
  const V share = hn::Min(
      hn::Mul(hn::MulAdd(seen, held, little), reciprocal(d, hn::MulAdd(held, held, little))), one);
  // What another boundary hides of all of the lobe, it hides of what is above the horizon.
  return hn::MulAdd(overlap(d, lobe, boundary.gradient, normal), hn::Sub(share, seen), seen);
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
