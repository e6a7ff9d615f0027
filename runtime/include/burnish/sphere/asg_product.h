#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "burnish/sphere/anisotropic_gaussian.h"

/// Products of two ASGs. Based on: xu2013asg, section 4.2. Where we differ: the eigenvectors are
/// found in the tangent plane of the narrower lobe instead of by iteration on 3 x 3 matrices, and
/// the smooth terms can be expanded to second order (docs/maths.md, "Product and convolution").
namespace burnish {

/// What becomes of max(v . z1, 0) max(v . z2, 0) in a product.
enum class SmoothTerms {
  constant,  ///< their value at the result's axis, Eq. 13: the paper's form
  expanded,  ///< to second order about it: the error below falls by 2 to 30
};

namespace internal {

/// Eigenvalues, >= 0, of sum_i weight_i u_i u_i^T, and the unit eigenvector of the larger one. The
/// smaller one comes from the determinant as a sum of squares (Cauchy-Binet), so that it keeps all
/// digits however long the ellipse.
struct PlanarEigen {
  double large, small;
  Vector2<double> axis;
};

template <int N>
PlanarEigen planar_eigen(const double (&weight)[N], const Vector2<double> (&u)[N]) {
  double xx = 0, xy = 0, yy = 0, determinant = 0;
  for (int i = 0; i < N; ++i) {
    xx += weight[i] * u[i].x() * u[i].x();
    xy += weight[i] * u[i].x() * u[i].y();
    yy += weight[i] * u[i].y() * u[i].y();
    for (int j = 0; j < i; ++j) {
      const double cross = u[i].x() * u[j].y() - u[i].y() * u[j].x();
      determinant += weight[i] * weight[j] * cross * cross;
    }
  }
  const double half_difference = (xx - yy) / 2;
  const double radius = std::sqrt(half_difference * half_difference + xy * xy);
  const double large = (xx + yy) / 2 + radius;
  if (!(radius > 0)) return {large, large, Vector2<double>::UnitX()};
  // Half angles; of sine and cosine, the smaller one from the double sine.
  const double cos_double = half_difference / radius, sin_double = xy / radius;
  const double dominant = std::sqrt((1 + std::abs(cos_double)) / 2);
  const double other = sin_double / (2 * dominant);
  const Vector2<double> axis =
      cos_double >= 0 ? Vector2<double>(dominant, other)
                      : Vector2<double>(std::abs(other), std::copysign(dominant, sin_double));
  return {large, std::min(determinant / large, large), axis};
}

/// The exponents of two lobes as one form, sum_i weight_i (row_i . v)^2, in the frame of the lobe
/// that has the largest of the bandwidths, over that bandwidth (if larger than 1), in double.
struct JointExponent {
  Frame<double> reference;
  Vector3d row[4];
  double weight[4];
  double scale;
  Vector3d other_axis;  ///< of the other lobe; the reference's is z

  double at(const Vector3d& v) const {
    double sum = 0;
    for (int i = 0; i < 4; ++i) sum += weight[i] * (row[i].dot(v) * row[i].dot(v));
    return sum;
  }
};

template <class T>
JointExponent joint_exponent(const AnisotropicGaussian<T>& a, const AnisotropicGaussian<T>& b) {
  const double widest_a = std::max(a.bandwidth_x, a.bandwidth_y);
  const double widest_b = std::max(b.bandwidth_x, b.bandwidth_y);
  const AnisotropicGaussian<T>& first = widest_a >= widest_b ? a : b;
  const AnisotropicGaussian<T>& second = widest_a >= widest_b ? b : a;
  JointExponent joint;
  joint.reference = first.frame.template cast<double>();
  const Frame<double> other = second.frame.template cast<double>();
  joint.scale = std::max({widest_a, widest_b, 1.0});
  joint.other_axis = joint.reference.to_local(other.z);
  // x and y of the other lobe are orthogonal to its z: what rounding says of x . z is taken off, so
  // that two lobes about one axis have a product about that axis, whatever their bandwidths.
  const Vector3d between = joint.reference.z - other.z;
  const auto row = [&](const Vector3d& v) {
    return Vector3d(v.dot(joint.reference.x), v.dot(joint.reference.y), v.dot(between));
  };
  joint.row[0] = Vector3d::UnitX();
  joint.row[1] = Vector3d::UnitY();
  joint.row[2] = row(other.x);
  joint.row[3] = row(other.y);
  joint.weight[0] = double(first.bandwidth_x) / joint.scale;
  joint.weight[1] = double(first.bandwidth_y) / joint.scale;
  joint.weight[2] = double(second.bandwidth_x) / joint.scale;
  joint.weight[3] = double(second.bandwidth_y) / joint.scale;
  return joint;
}

/// Unit v, up to its sign, of the smallest sum_i weight_i (row_i . v)^2, the first two rows being
/// x and y: the smallest eigenvector. The upper left 2 x 2 block is diagonalised, which leaves one
/// equation for the eigenvalue e,
///   c - e = g_1^2 / (d_1 - e) + g_2^2 / (d_2 - e);
/// its pole next to the root is kept, the far one is linearised, and the quadratic solved.
inline Vector3d smallest_axis(const double (&weight)[4], const Vector3d (&row)[4]) {
  Vector2<double> planar[4];
  Vector2<double> coupling = Vector2<double>::Zero();
  double corner = 0;
  for (int i = 0; i < 4; ++i) {
    planar[i] = row[i].head<2>();
    coupling += weight[i] * row[i].z() * planar[i];
    corner += weight[i] * row[i].z() * row[i].z();
  }
  const PlanarEigen block = planar_eigen(weight, planar);
  const Vector2<double> across(-block.axis.y(), block.axis.x());
  const double far = block.axis.dot(coupling), near = across.dot(coupling);
  double e = 0;
  for (int step = 0; step < 20; ++step) {  // 2 or 3 but for axes that are nearly orthogonal
    const double gap = block.large - e;
    const double pull = gap > 0 ? far / gap : 0.0;
    const double constant = corner - pull * far + pull * pull * e, slope = 1 + pull * pull;
    const double difference = constant - slope * block.small;
    const double root = std::sqrt(difference * difference + 4 * slope * near * near);
    const double sum = constant + slope * block.small + root;
    if (!(sum > 0)) break;
    const double last = e;
    e = std::clamp(2 * (constant * block.small - near * near) / sum, 0.0, block.small);
    if (std::abs(e - last) <= 1e-15 * block.small) break;
  }
  const double gap_far = block.large - e, gap_near = block.small - e;
  const Vector2<double> xy = -(far * gap_near) * block.axis - (near * gap_far) * across;
  const Vector3d v(xy.x(), xy.y(), gap_far * gap_near);
  const double length = v.norm();
  if (length > 0) return v / length;
  // No coupling: the axes of the block and z itself.
  return block.small < corner ? Vector3d(across.x(), across.y(), 0) : Vector3d::UnitZ();
}

}  // namespace internal

/// Product of two lobes as one lobe. bandwidth_x is the larger one. Relative L2 error over the
/// sphere, mean over random lobes of anisotropy to 10 and axes to 2.5 deviations apart:
///   geometric mean of the bandwidths   .1-1   1-10   3-30   10-100   30-300
///   SmoothTerms::constant              .46    .20    .064   .013     .0041
///   SmoothTerms::expanded              .22    .12    .028   .0017    .0002
/// It is 0 where the result's axis is below a lobe's horizon, though the lobes may overlap.
/// An amplitude beyond the range of T is infinite, a bandwidth the largest finite number.
template <class T>
AnisotropicGaussian<T> product(const AnisotropicGaussian<T>& a, const AnisotropicGaussian<T>& b,
                               SmoothTerms smooth = SmoothTerms::constant) {
  internal::JointExponent joint = internal::joint_exponent(a, b);
  const bool expanded = smooth == SmoothTerms::expanded;
  // cos(t) is exp(-sin^2(t) / 2) to second order: that is where the product peaks.
  const double shift = expanded ? 0.5 / joint.scale : 0.0;
  double weight[4];
  for (int i = 0; i < 4; ++i) weight[i] = joint.weight[i] + shift;
  Vector3d z = internal::smallest_axis(weight, joint.row);
  if (z.z() + z.dot(joint.other_axis) < 0) z = -z;

  const double exponent = joint.at(z);
  const double cos_reference = z.z(), cos_other = z.dot(joint.other_axis);
  const Frame<double> tangent = frame_from_axis(z);
  double weights[6] = {joint.weight[0], joint.weight[1], joint.weight[2], joint.weight[3], 0, 0};
  // Without the smooth terms the last two have no weight, but 0 times garbage may be NaN.
  Vector2<double> rows[6];
  rows[4].setZero();
  rows[5].setZero();
  for (int i = 0; i < 4; ++i) rows[i] = {tangent.x.dot(joint.row[i]), tangent.y.dot(joint.row[i])};
  if (expanded) {
    // -log(v . z1) curves by u^2 / 2 + (u . z1)^2 / (2 cos^2); near the horizon, where it diverges,
    // the lobe has no second order to speak of.
    const double floor = 0.1;
    weights[4] = weights[5] = shift;
    rows[4] = Vector2<double>(tangent.x.z(), tangent.y.z()) / std::max(cos_reference, floor);
    rows[5] = Vector2<double>(tangent.x.dot(joint.other_axis), tangent.y.dot(joint.other_axis)) /
              std::max(cos_other, floor);
  }
  const internal::PlanarEigen eigen = internal::planar_eigen(weights, rows);

  AnisotropicGaussian<T> result;
  const Vector3d x = eigen.axis.x() * tangent.x + eigen.axis.y() * tangent.y;
  result.frame = Frame<double>{joint.reference.to_world(x), joint.reference.to_world(z.cross(x)),
                               joint.reference.to_world(z)}
                     .template cast<T>();
  const auto bandwidth = [&](double eigenvalue) {
    const double value = std::max(eigenvalue + shift - exponent, 0.0) * joint.scale;
    return T(std::min(value, double(std::numeric_limits<T>::max())));
  };
  result.bandwidth_x = bandwidth(eigen.large);
  result.bandwidth_y = bandwidth(eigen.small);
  result.amplitude = T(double(a.amplitude) * double(b.amplitude) * std::max(cos_reference, 0.0) *
                       std::max(cos_other, 0.0) * std::exp(-exponent * joint.scale));
  return result;
}

/// Integral of the product of two lobes: their product with the smooth terms expanded, integrated
/// exactly. Relative L2 error over the lobes of `product`'s table: .17, .043, .0066, .0004,
/// 4e-5 (Eq. 13 integrated exactly: .41, .13, .038, .010, .003).
template <class T>
T inner_product(const AnisotropicGaussian<T>& a, const AnisotropicGaussian<T>& b) {
  return integral(product(a, b, SmoothTerms::expanded));
}

/// The same in closed form, without an eigenvector: relative L2 error .16, .048, .019,
/// .0055, .0019.
/// b is turned to a's axis by the smallest rotation; there both are plane Gaussians of matrices A
/// and B about two points that are d apart, and
///   S I(A + B + 1/2) exp(-d^T (A^-1 + B^-1)^-1 d),
/// I the exact integral, the 1/2 for the second smooth term, S the smooth terms where the product
/// of two round lobes peaks.
template <class T>
T inner_product_closed_form(const AnisotropicGaussian<T>& a, const AnisotropicGaussian<T>& b) {
  const Frame<double> fa = a.frame.template cast<double>(), fb = b.frame.template cast<double>();
  // In double and over the largest bandwidth: determinants would overflow.
  const double scale = std::max({1.0, double(a.bandwidth_x), double(a.bandwidth_y),
                                 double(b.bandwidth_x), double(b.bandwidth_y)});
  const double ax = a.bandwidth_x / scale, ay = a.bandwidth_y / scale;
  const double bx = b.bandwidth_x / scale, by = b.bandwidth_y / scale;
  const double cosine = fa.z.dot(fb.z);
  const Vector3d between = fb.z - fa.z;  // orthogonal lobes' x and y to their own z, exactly
  const double dax = between.dot(fa.x), day = between.dot(fa.y);
  const double dbx = -between.dot(fb.x), dby = -between.dot(fb.y);
  // The turned axes of b in a's tangent plane. Opposite axes have S = 0 and any rotation.
  const double turn = 1 / std::max(1 + cosine, 1e-9);
  const double xx = fb.x.dot(fa.x) - dbx * dax * turn, xy = fb.x.dot(fa.y) - dbx * day * turn;
  const double yx = fb.y.dot(fa.x) - dby * dax * turn, yy = fb.y.dot(fa.y) - dby * day * turn;
  const double b_xx = bx * xx * xx + by * yx * yx, b_yy = bx * xy * xy + by * yy * yy;
  const double det_a = ax * ay, det_b = bx * by;
  const double det = det_a + det_b + ay * b_xx + ax * b_yy;
  const double along_a = ax * dax * dax + ay * day * day;  // d^T A d and d^T B d
  const double along_b = bx * dbx * dbx + by * dby * dby;
  // (A^-1 + B^-1)^-1 = (det B A + det A B) / det(A + B): no difference that could cancel.
  const double exponent = det > 0 ? (det_b * along_a + det_a * along_b) / det : 0.0;
  const double along = along_a + along_b;
  const double q = along > 0 ? (along_b - along_a) / along : 0.0;
  const double smooth = std::max((1 + cosine - (1 - cosine) * q * q) / 2, 0.0);
  const double half = 0.5 / scale;
  const double mean = (ax + ay + bx + by) / 2;
  const double large = mean + std::sqrt(std::max(mean * mean - det, 0.0)), small = det / large;
  const double width_x = (large > 0 ? large + half : half) * scale;
  const double width_y = (large > 0 ? small + half : half) * scale;
  const double largest = std::numeric_limits<T>::max();
  const double whole =
      asg_integral_exact(T(std::min(width_x, largest)), T(std::min(width_y, largest)));
  return T(double(a.amplitude) * double(b.amplitude) * smooth * whole *
           std::exp(-exponent * scale));
}

}  // namespace burnish
