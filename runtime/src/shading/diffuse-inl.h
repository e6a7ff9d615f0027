// The irradiance of the points of a block, with its shadows: one point a lane.

#if defined(BURNISH_SHADING_DIFFUSE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_SHADING_DIFFUSE_INL_H_
#undef BURNISH_SHADING_DIFFUSE_INL_H_
#else
#define BURNISH_SHADING_DIFFUSE_INL_H_
#endif

#include <hwy/highway.h>

#include "burnish/shading/prepared_lights.h"
#include "shading/multiply_rows-inl.h"
#include "shading/visibility-inl.h"
#include "sphere/warp-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {

template <class D>
HWY_INLINE Vector3<hn::VFromD<D>> set(D d, const Vector3f& v) {
  return {hn::Set(d, v.x()), hn::Set(d, v.y()), hn::Set(d, v.z())};
}

/// Of the least-squares SG of the clamped cosine (wang2009svbrdf).
inline constexpr float kCosineSharpness = 2.133f;

/// Where the product of a lobe and the clamped cosine peaks, and how wide it is there, in the
/// lobe's frame, for a normal in that frame. The cosine is exp(kCosineSharpness n.v) up to a
/// factor.
template <class D, class V>
HWY_INLINE AnisotropicGaussian<V> lobe_times_cosine(D d, V bandwidth_x, V bandwidth_y,
                                                    const Vector3<V>& normal) {
  const V one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f), half = hn::Set(d, 0.5f);
  const V scale = hn::Set(d, kCosineSharpness);
  const Vector3<V> n = {hn::Mul(scale, normal.x), hn::Mul(scale, normal.y),
                        hn::Mul(scale, normal.z)};
  const V two_x = hn::Mul(two, bandwidth_x), two_y = hn::Mul(two, bandwidth_y);
  // Maximum of log z - b_x x^2 - b_y y^2 + n.v on the unit sphere, by its Lagrange multiplier:
  // |v(m)| = 1, |v| falls with m. Two steps of Newton from that of a needle are within .01 of a
  // deviation for bandwidths from 1 on, .1 for .2; the result is normalised anyway.
  V multiplier = hn::Max(hn::Add(n.z, one), hn::Set(d, 0.4f));
  Vector3<V> v = {n.x, n.y, one};
  for (int i = 0; i < 2; ++i) {
    const V square = hn::MulAdd(hn::Set(d, 4.0f), multiplier, hn::Mul(n.z, n.z));
    const V below_root = reciprocal_root(d, square), below_m = reciprocal(d, multiplier);
    const V below_x = reciprocal(d, hn::Add(two_x, multiplier));
    const V below_y = reciprocal(d, hn::Add(two_y, multiplier));
    v = {hn::Mul(n.x, below_x), hn::Mul(n.y, below_y),
         hn::Mul(hn::Mul(half, hn::MulAdd(square, below_root, n.z)), below_m)};
    const V dz = hn::Mul(hn::Sub(below_root, v.z), below_m);
    const V slope = hn::MulSub(
        v.z, dz, hn::MulAdd(hn::Mul(v.x, v.x), below_x, hn::Mul(hn::Mul(v.y, v.y), below_y)));
    const V below = hn::Max(hn::Mul(hn::Set(d, -2.0f), slope), hn::Set(d, 1e-6f));
    const V step = hn::Mul(hn::Sub(dot(v, v), one), reciprocal(d, below));
    multiplier = hn::Min(hn::Max(hn::Add(multiplier, step), hn::Mul(hn::Set(d, 0.3f), multiplier)),
                         hn::Mul(hn::Set(d, 3.0f), multiplier));
  }
  const V inverse = reciprocal_root(d, dot(v, v));
  v = {hn::Mul(v.x, inverse), hn::Mul(v.y, inverse), hn::Mul(v.z, inverse)};

  // frame_from_axis.
  const V sign = hn::CopySign(one, v.z);
  const V a = hn::Neg(reciprocal(d, hn::Add(sign, v.z)));
  const V b = hn::Mul(hn::Mul(v.x, v.y), a);
  const V sx = hn::Mul(sign, v.x);
  const Vector3<V> tx = {hn::MulAdd(hn::Mul(sx, v.x), a, one), hn::Mul(sign, b), hn::Neg(sx)};
  const Vector3<V> ty = {b, hn::MulAdd(hn::Mul(v.y, v.y), a, sign), hn::Neg(v.y)};
  // Curvature of the exponent in the tangent plane; an ASG's smooth term accounts for 1 of it.
  const Vector3<V> diagonal = {two_x, two_y,
                               hn::Div(one, hn::Max(hn::Mul(v.z, v.z), hn::Set(d, 1e-4f)))};
  const Vector3<V> scaled = {hn::Mul(diagonal.x, tx.x), hn::Mul(diagonal.y, tx.y),
                             hn::Mul(diagonal.z, tx.z)};
  const V xx = hn::Add(dot(tx, scaled), multiplier), xy = dot(ty, scaled);
  const V yy = hn::Add(hn::MulAdd(hn::Mul(diagonal.x, ty.x), ty.x,
                                  hn::MulAdd(hn::Mul(diagonal.y, ty.y), ty.y,
                                             hn::Mul(hn::Mul(diagonal.z, ty.z), ty.z))),
                       multiplier);
  const V difference = hn::Mul(half, hn::Sub(xx, yy));
  const V radius = hn::Sqrt(hn::MulAdd(difference, difference, hn::Mul(xy, xy)));
  const MajorAxis<V> major = major_axis(d, difference, xy, radius);
  const V unit = reciprocal_root(d, hn::Max(major.length_squared, hn::Set(d, 1e-30f)));
  const V along_x = hn::Mul(unit, major.cosine), along_y = hn::Mul(unit, major.sine);
  AnisotropicGaussian<V> result;
  result.x = {hn::MulAdd(along_x, tx.x, hn::Mul(along_y, ty.x)),
              hn::MulAdd(along_x, tx.y, hn::Mul(along_y, ty.y)),
              hn::MulAdd(along_x, tx.z, hn::Mul(along_y, ty.z))};
  result.y = cross(v, result.x);
  result.z = v;
  const V middle = hn::MulSub(half, hn::Add(xx, yy), one), least = hn::Set(d, 0.05f);
  result.bandwidth_x = hn::Max(hn::Mul(half, hn::Add(middle, radius)), least);
  result.bandwidth_y = hn::Max(hn::Mul(half, hn::Sub(middle, radius)), least);
  return result;
}

/// Where normals are between corners of the irradiance table: in the triangles into which an
/// octahedron's faces are cut.
template <class T>
struct BlockTriangles {
  alignas(64) std::int32_t corner[3][kBlock];
  BlockArray<T> weight[3];
};

template <class D, class T = hn::TFromD<D>>
HWY_INLINE void find_triangles(D d, size_t count, const BlockVector3<T>& normals,
                               BlockTriangles<T>& triangles) {
  using V = hn::VFromD<D>;
  const V one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  const V half = hn::Set(d, 0.5f * IrradianceTable::kCells);
  const V last = hn::Set(d, IrradianceTable::kCells - 1e-5f);
  const hn::Rebind<std::int32_t, D> di;
  const auto store_corner = [&](V column, V row, size_t i, std::int32_t* corner) HWY_ATTR {
    const V index = hn::MulAdd(row, hn::Set(d, T(IrradianceTable::kCorners)), column);
    if constexpr (std::is_same_v<T, float>)
      hn::Store(hn::ConvertTo(di, index), di, corner + i);
    else
      hn::StoreU(hn::DemoteTo(di, index), di, corner + i);
  };
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    // The octahedron is unfolded to a square.
    const Vector3<V> n = load(d, normals, i);
    const V length = hn::Add(hn::Add(hn::Abs(n.x), hn::Abs(n.y)), hn::Abs(n.z));
    const V scale = hn::Div(one, hn::Max(length, hn::Set(d, 1e-30f)));
    const V x = hn::Mul(hn::Abs(n.x), scale), y = hn::Mul(hn::Abs(n.y), scale);
    const auto below = hn::Lt(n.z, zero);
    const auto to_cells = [&](V upper, V lower, V sign) HWY_ATTR {
      const V place = hn::CopySign(hn::IfThenElse(below, hn::Sub(one, lower), upper), sign);
      return hn::Min(hn::Max(hn::MulAdd(half, place, half), zero), last);
    };
    const V u = to_cells(x, y, n.x), v = to_cells(y, x, n.y);
    const V column = hn::Floor(u), row = hn::Floor(v);
    // Cells are cut along the octahedron's edges, in two of the quadrants the other way.
    const auto mirrored = hn::Xor(hn::Lt(column, half), hn::Lt(row, half));
    const V from_left = hn::Sub(u, column), fy = hn::Sub(v, row);
    const V fx = hn::IfThenElse(mirrored, hn::Sub(one, from_left), from_left);
    const V near = hn::Add(column, hn::IfThenElseZero(mirrored, one));
    const V far = hn::Add(column, hn::IfThenZeroElse(mirrored, one)), next = hn::Add(row, one);
    const auto outer = hn::Gt(hn::Add(fx, fy), one);
    store_corner(hn::IfThenElse(outer, far, near), hn::IfThenElse(outer, next, row), i,
                 triangles.corner[0]);
    store_corner(far, row, i, triangles.corner[1]);
    store_corner(near, next, i, triangles.corner[2]);
    hn::Store(hn::Abs(hn::Sub(hn::Sub(one, fx), fy)), d, triangles.weight[0].data() + i);
    hn::Store(hn::IfThenElse(outer, hn::Sub(one, fy), fx), d, triangles.weight[1].data() + i);
    hn::Store(hn::IfThenElse(outer, hn::Sub(one, fx), fy), d, triangles.weight[2].data() + i);
  }
}

/// The same of a lobe so narrow that one step reaches its peak, and that the cosine does not turn
/// its axes: within .1 of a deviation for bandwidths from kNarrow on. The axes are tangent to the
/// sphere to first order.
inline constexpr float kNarrow = 8;

template <class D, class V>
HWY_INLINE AnisotropicGaussian<V> narrow_lobe_times_cosine(D d, V bandwidth_x, V bandwidth_y,
                                                           const Vector3<V>& normal) {
  const V one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f), half = hn::Set(d, 0.5f);
  const V scale = hn::Set(d, kCosineSharpness);
  const V multiplier = hn::Max(hn::MulAdd(scale, normal.z, one), hn::Set(d, 0.4f));
  const V x =
      hn::Mul(hn::Mul(scale, normal.x), reciprocal(d, hn::MulAdd(two, bandwidth_x, multiplier)));
  const V y =
      hn::Mul(hn::Mul(scale, normal.y), reciprocal(d, hn::MulAdd(two, bandwidth_y, multiplier)));
  const V inverse = reciprocal_root(d, hn::MulAdd(x, x, hn::MulAdd(y, y, one)));
  const Vector3<V> v = {hn::Mul(x, inverse), hn::Mul(y, inverse), inverse};
  // The multiplier is the cosine's curvature and 1, which the ASG's smooth term accounts for.
  const V more = hn::Mul(half, hn::Sub(multiplier, one));
  return {{one, hn::Zero(d), hn::Neg(x)},
          {hn::Zero(d), one, hn::Neg(y)},
          v,
          hn::Add(bandwidth_x, more),
          hn::Add(bandwidth_y, more)};
}

/// All wide lobes at once, through the ladder.
template <class D, class T = hn::TFromD<D>>
HWY_NOINLINE void add_table_irradiance(D d, const PreparedTransfer& transfer,
                                       const PreparedLights& lights, const ShadingBlock<T>& block,
                                       BlockRgb<T>& irradiance) {
  using V = hn::VFromD<D>;
  BlockTriangles<T> triangles;
  find_triangles(d, block.count, block.normal, triangles);
  const size_t terms = padded_terms(transfer.ladder_terms), entry_size = 3 * terms;
  alignas(64) T sum[kBlock][IrradianceTable::kMeans] = {};
  const auto table_of = [&](size_t r) -> const IrradianceTable& {
    return lights.tables[static_cast<size_t>(transfer.ladder_of(block.row[r].basis))];
  };
  // Tables are larger than the nearest cache: what the next rows read is fetched meanwhile.
  constexpr size_t kAhead = 2;
  for (size_t r = 0; r < block.row_count; ++r) {
    const VisibilityRow<T>& row = block.row[r];
    const IrradianceTable& table = table_of(r);
    if (r + kAhead < block.row_count) {
      const float* entries = table_of(r + kAhead).entries.data();
      const size_t point = block.row[r + kAhead].point;
      for (const auto& corner : triangles.corner)
        for (size_t k = 0; k < entry_size; k += 16)
          hwy::Prefetch(entries + static_cast<size_t>(corner[point]) * entry_size + k);
    }
    V total[4] = {hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    T(&sums)[IrradianceTable::kMeans] = sum[row.point];
    for (int j = 0; j < 3; ++j) {
      const auto corner = static_cast<size_t>(triangles.corner[j][row.point]);
      const float* means = table.means.data() + corner * IrradianceTable::kMeans;
      const T share = row.weight * triangles.weight[j][row.point];
      const hn::CappedTag<T, IrradianceTable::kMeans> dm;
      for (size_t c = 0; c < IrradianceTable::kMeans; c += hn::Lanes(dm))
        hn::StoreU(
            hn::MulAdd(hn::Set(dm, share), load_floats(dm, means + c), hn::LoadU(dm, sums + c)), dm,
            sums + c);
      const V w = hn::Set(d, share);
      const float* red = table.entries.data() + corner * entry_size;
      for (size_t k = 0; k < terms; k += hn::Lanes(d)) {
        const V coefficient = hn::Mul(w, hn::Load(d, row.ladder + k));
        total[0] = hn::MulAdd(coefficient, load_floats(d, red + k), total[0]);
        total[1] = hn::MulAdd(coefficient, load_floats(d, red + terms + k), total[1]);
        total[2] = hn::MulAdd(coefficient, load_floats(d, red + 2 * terms + k), total[2]);
      }
    }
    T products[4];
    sum_lanes(d, total, products);
    for (int c = 0; c < 3; ++c) sums[c] += products[c];
  }
  const bool is_positive = lights.tables[0].is_positive;
  for (size_t i = 0; i < block.count; ++i)
    for (size_t c = 0; c < 3; ++c) {
      const T full = sum[i][IrradianceTable::kUnshadowed + c];
      // Rings of the harmonics. Of lights of both signs a part may be more than all.
      irradiance[c][i] += is_positive ? std::min(std::max(sum[i][c], T(0)), full) : sum[i][c];
    }
}

inline constexpr size_t kLobesTogether = 16;

/// The narrow lobes' boundaries at their axes: value and gradient, [3 lobes][kBlock], from the
/// matrix product; a few lobes at a time. Four rows of a basis at once share what is read of it.
template <class D, class T = hn::TFromD<D>>
HWY_NOINLINE void find_lobe_boundaries(D d, const PreparedLights& lights,
                                       const ShadingBlock<T>& block, size_t terms, size_t first,
                                       size_t count, BlockArray<T>* boundaries) {
  const size_t width = boundary_columns(lights.narrow.size());
  for (size_t j = 0; j < 3 * count; ++j)
    for (size_t i = 0; i < block.count; ++i) boundaries[j][i] = 0;
  alignas(64) T sums[4][3 * kLobesTogether + 2 * hn::MaxLanes(D())];
  for (size_t r = 0; r < block.row_count;) {
    const std::uint8_t basis = block.row[r].basis;
    size_t together = 1;
    while (together < 4 && r + together < block.row_count && block.row[r + together].basis == basis)
      ++together;
    const auto row_of = [&](size_t n) { return block.row[r + std::min(n, together - 1)].ssdf; };
    const LobeBoundaries& lobes = lights.boundaries[basis];
    multiply_rows(d, {row_of(0), row_of(1), row_of(2), row_of(3)}, terms,
                  lobes.rows.data() + 3 * first, width, 3 * count,
                  {sums[0], sums[1], sums[2], sums[3]});
    for (size_t n = 0; n < together; ++n) {
      const VisibilityRow<T>& row = block.row[r + n];
      for (size_t j = 0; j < 3 * count; ++j)
        boundaries[j][row.point] +=
            row.weight * (sums[n][j] + static_cast<T>(lobes.mean[3 * first + j]));
    }
    r += together;
  }
}

/// A lobe's boundary at its axis, taken for a great circle, as it is seen from another direction
/// near; in the lobe's frame.
template <class D, class V>
HWY_INLINE Boundary<V> boundary_at(D d, V sine_at_axis, V along_x, V along_y,
                                   const Vector3<V>& direction) {
  const V one = hn::Set(d, 1.0f);
  const V cosine = root(d, hn::Max(hn::NegMulAdd(sine_at_axis, sine_at_axis, one), hn::Zero(d)));
  const Vector3<V> pole = {hn::Mul(cosine, along_x), hn::Mul(cosine, along_y), sine_at_axis};
  const auto has_gradient =
      hn::Gt(hn::MulAdd(along_x, along_x, hn::Mul(along_y, along_y)), hn::Zero(d));
  const V there = hn::Max(hn::Min(dot(pole, direction), one), hn::Neg(one));
  const V sine = hn::IfThenElse(has_gradient, there, sine_at_axis);
  const Vector3<V> gradient = {hn::NegMulAdd(sine, direction.x, pole.x),
                               hn::NegMulAdd(sine, direction.y, pole.y),
                               hn::NegMulAdd(sine, direction.z, pole.z)};
  Boundary<V> result = {sine, unit_gradient(d, gradient, 1e-6f)};
  result.gradient.x = hn::IfThenElseZero(has_gradient, result.gradient.x);
  result.gradient.y = hn::IfThenElseZero(has_gradient, result.gradient.y);
  result.gradient.z = hn::IfThenElseZero(has_gradient, result.gradient.z);
  return result;
}

template <class D>
HWY_INLINE LobeMoments<hn::VFromD<D>> set(D d, const burnish::LobeMoments<float>& m) {
  return {hn::Set(d, m.mean_z),     hn::Set(d, m.mean_xx),   hn::Set(d, m.mean_yy),
          hn::Set(d, m.variance_z), hn::Set(d, m.mean_xxz),  hn::Set(d, m.mean_yyz),
          hn::Set(d, m.mean_zzz),   hn::Set(d, m.mean_xxxx), hn::Set(d, m.mean_yyyy),
          hn::Set(d, m.mean_zzzz),  hn::Set(d, m.mean_xxyy), hn::Set(d, m.mean_xxzz),
          hn::Set(d, m.mean_yyzz)};
}

/// Adds what a lobe sends to the points, of irradiance `amount` without its colour.
template <class D, class V, class T>
HWY_INLINE void add_color(D d, const Rgb& color, V amount, size_t i, BlockRgb<T>& sum) {
  for (int c = 0; c < 3; ++c) {
    T* channel = sum[static_cast<size_t>(c)].data() + i;
    hn::Store(hn::MulAdd(hn::Set(d, color[c]), amount, hn::Load(d, channel)), d, channel);
  }
}

/// One lobe past its boundary, of which `boundary` has value and gradient; null: past the horizon.
template <class D, class T = hn::TFromD<D>>
HWY_NOINLINE void add_lobe_irradiance(D d, const PreparedLobe& light, float amplitude_rad,
                                      const BlockArray<T>* boundary, const ShadingOptions& options,
                                      const ShadingBlock<T>& block, BlockRgb<T>& irradiance) {
  using V = hn::VFromD<D>;
  const AnisotropicGaussian<V> lobe = {
      set(d, light.lobe.frame.x), set(d, light.lobe.frame.y), set(d, light.lobe.frame.z),
      hn::Set(d, light.lobe.bandwidth_x), hn::Set(d, light.lobe.bandwidth_y)};
  const LobeMoments<V> moments = set(d, light.moments);
  const V integral = hn::Set(d, light.integral * (1 - light.ladder_share));
  const bool is_narrow = std::min(light.lobe.bandwidth_x, light.lobe.bandwidth_y) >= kNarrow;
  for (size_t i = 0; i < block.count; i += hn::Lanes(d)) {
    const Vector3<V> world_normal = load(d, block.normal, i);
    const Vector3<V> normal = {dot(world_normal, lobe.x), dot(world_normal, lobe.y),
                               dot(world_normal, lobe.z)};
    Boundary<V> at_axis = horizon(d, normal, {hn::Zero(d), hn::Zero(d), hn::Set(d, 1.0f)});
    if (boundary) {
      at_axis.sine = sine_of_ssdf(d, hn::Load(d, boundary[0].data() + i), amplitude_rad);
      at_axis.gradient = unit_gradient(d,
                                       Vector3<V>{hn::Load(d, boundary[1].data() + i),
                                                  hn::Load(d, boundary[2].data() + i), hn::Zero(d)},
                                       1e-4f);
    }
    V amount;
    if (options.cosine == CosineModel::constant) {  // xu2013asg, Eq. 29
      const AnisotropicGaussian<V> local = {{hn::Set(d, 1.0f), hn::Zero(d), hn::Zero(d)},
                                            {hn::Zero(d), hn::Set(d, 1.0f), hn::Zero(d)},
                                            {hn::Zero(d), hn::Zero(d), hn::Set(d, 1.0f)},
                                            lobe.bandwidth_x,
                                            lobe.bandwidth_y};
      amount = hn::Mul(hn::Max(normal.z, hn::Zero(d)),
                       visible_fraction(d, options.visibility, local, at_axis));
    } else {
      amount = mean_clamped_cosine(d, moments, normal);
      if (hn::AllTrue(d, hn::Le(amount, hn::Zero(d)))) continue;
      if (boundary) {
        const AnisotropicGaussian<V> lit =
            is_narrow ? narrow_lobe_times_cosine(d, lobe.bandwidth_x, lobe.bandwidth_y, normal)
                      : lobe_times_cosine(d, lobe.bandwidth_x, lobe.bandwidth_y, normal);
        const Boundary<V> at_lit =
            boundary_at(d, at_axis.sine, at_axis.gradient.x, at_axis.gradient.y, lit.z);
        amount = hn::Mul(amount, visible_share(d, options.visibility, lit, at_lit, normal));
      }
    }
    add_color(d, light.color, hn::Mul(integral, amount), i, irradiance);
  }
}

/// The environment's lobes.
template <class D, class T = hn::TFromD<D>>
HWY_INLINE void add_environment_irradiance(D d, const PreparedTransfer& transfer,
                                           const PreparedLights& lights,
                                           const ShadingOptions& options, size_t terms,
                                           const ShadingBlock<T>& block, BlockRgb<T>& irradiance) {
  if (!lights.tables.empty()) add_table_irradiance(d, transfer, lights, block, irradiance);
  BlockArray<T> boundaries[3 * kLobesTogether];
  for (size_t first = 0; first < lights.narrow.size(); first += kLobesTogether) {
    const size_t count = std::min(kLobesTogether, lights.narrow.size() - first);
    if (!transfer.bases.empty())
      find_lobe_boundaries(d, lights, block, terms, first, count, boundaries);
    for (size_t j = 0; j < count; ++j)
      add_lobe_irradiance(
          d, lights.lobes[static_cast<size_t>(lights.narrow[first + j])], transfer.amplitude_rad,
          transfer.bases.empty() ? nullptr : boundaries + 3 * j, options, block, irradiance);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
