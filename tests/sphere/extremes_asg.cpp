// Anisotropic spherical Gaussians and their warp at extreme inputs.

#include "burnish/sphere/asg_convolution.h"
#include "burnish/sphere/asg_product.h"
#include "burnish/sphere/asg_sampling.h"
#include "burnish/sphere/lobe_moments.h"
#include "burnish/sphere/spherical_warp.h"
#include "sphere/extremes.h"

namespace burnish::test {
namespace {

struct AsgEval : ToAmplitude {
  static constexpr Claims kClaims = {"ASG: eval", kRatio | kAngle | kAmplitude, kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {eval(asg(x), x.direction)};
  }
};

constexpr const char* name_of(AsgIntegral level) {
  return level == AsgIntegral::fast     ? "ASG: integral, fast"
         : level == AsgIntegral::series ? "ASG: integral, series"
                                        : "ASG: integral, exact";
}

template <AsgIntegral level>
struct AsgIntegralAt : Relative {
  // The series subtracts its correction, which is up to .58 of the leading term.
  static constexpr Claims kClaims = {name_of(level), kRatio | kAmplitude, 2 * kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {integral(asg(x), level)};
  }
};

template <SmoothTerms smooth>
struct AsgProductAmplitude : ToAmplitude {
  static constexpr Claims kClaims = {smooth == SmoothTerms::constant
                                         ? "ASG: product, amplitude"
                                         : "ASG: product (expanded), amplitude",
                                     kRatio | kOther | kAngle, kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {product(asg(x), other_asg(x), smooth).amplitude};
  }
};

struct AsgProductBandwidths {
  static double scale(const Extreme<double>& x) { return x.narrow + x.other_narrow; }
  static constexpr Claims kClaims = {"ASG: product, bandwidths", kRatio | kOther | kAngle,
                                     kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    const auto c = product(asg(x), other_asg(x));
    return {c.bandwidth_x, c.bandwidth_y};
  }
};

/// Widths that add up to more than a float can be are held at its end, and nothing is claimed.
bool beyond_float(const Extreme<double>& x) {
  return x.narrow + x.other_narrow > std::numeric_limits<float>::max();
}
struct RelativeWithinFloat {
  static double scale(const Extreme<double>& x) { return beyond_float(x) ? kInfinity : 0; }
};

template <bool closed_form>
struct AsgInnerProduct {
  // Of two lobes about one axis.
  static double scale(const Extreme<double>& x) {
    if (beyond_float(x)) return kInfinity;
    return std::abs(x.amplitude) *
           asg_integral_exact(x.narrow + x.other_narrow, x.wide + x.other_wide);
  }
  static constexpr Claims kClaims = {
      closed_form ? "ASG: inner product, closed form" : "ASG: inner product",
      kRatio | kOther | kAngle, 2 * kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {closed_form ? inner_product_closed_form(asg(x), other_asg(x))
                        : inner_product(asg(x), other_asg(x))};
  }
};

struct AsgSgConvolution : RelativeWithinFloat {
  static constexpr Claims kClaims = {"ASG: convolution with an SG", kRatio | kOther,
                                     2 * kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    const auto c = convolve(asg(x), other_sg(x));
    return {c.bandwidth_x, c.bandwidth_y, c.amplitude};
  }
};

struct AsgAsgConvolution : RelativeWithinFloat {
  static constexpr Claims kClaims = {"ASG: convolution with an ASG", kRatio | kOther | kAngle,
                                     2 * kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    const auto c = convolve(asg(x), other_asg(x));
    return {c.bandwidth_x, c.bandwidth_y, c.amplitude};
  }
};

struct AsgPdf {
  static double scale(const Extreme<double>& x) { return 1 / asg_integral_exact(x.narrow, x.wide); }
  static constexpr Claims kClaims = {"ASG: pdf", kRatio | kAngle, 2 * kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {pdf(asg(x), x.direction)};
  }
};

struct AsgSample : ToOne {
  static constexpr Claims kClaims = {"ASG: sample", kRatio, 2 * kFewRoundings, false};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    std::vector<T> all;
    for (const T u : {T(0), T(0.25), T(0.75), T(1)}) {
      const Vector3<T> v = sample(asg(x), u, T(0.15));
      all.insert(all.end(), {v.x(), v.y(), v.z()});
    }
    return all;
  }
};

/// Lengths of the axes, and what z differs by from x cross y. The axes themselves hang on the
/// rounding where bandwidths are equal.
template <class T>
std::vector<T> frame_lengths(const Frame<T>& frame) {
  return {frame.x.norm(), frame.y.norm(), frame.z.norm(), frame.x.cross(frame.y).dot(frame.z)};
}

struct ResultFrames : ToOne {
  static constexpr Claims kClaims = {"frames of products, convolutions, warps",
                                     kRatio | kOther | kAngle, kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    std::vector<T> all;
    for (const Frame<T>& frame :
         {product(asg(x), other_asg(x)).frame, convolve(asg(x), other_asg(x)).frame,
          warp_to_incoming(asg(x), x.direction).lobe.frame}) {
      const std::vector<T> lengths = frame_lengths(frame);
      all.insert(all.end(), lengths.begin(), lengths.end());
    }
    return all;
  }
};

struct AsgConversions : Relative {
  static constexpr Claims kClaims = {"ASG: effective sharpness, to and from SG", kRatio,
                                     kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    const SphericalGaussian<T> round = sg_from_asg(asg(x));
    return {effective_sharpness(asg(x)), round.sharpness, eval(round, round.axis),
            asg_from_sg(sg(x)).bandwidth_x};
  }
};

struct AsgSupportAngles : Relative {
  static constexpr Claims kClaims = {"ASG: support", kRatio, 2 * kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    const auto tenth = support(asg(x), T(0.1)), far = support(asg(x), T(1e-6));
    return {tenth.angle_x, tenth.angle_y, far.angle_x, far.angle_y};
  }
};

struct AsgClampedCosine : ToOne {
  static constexpr Claims kClaims = {"ASG: clamped cosine", kRatio | kAngle, 2 * kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {mean_clamped_cosine(asg_moments(x.narrow, x.wide), x.frame.to_local(x.direction))};
  }
};

struct WarpBandwidths {
  // Behind the horizon the amplitude is 0, and the axes hang on the rounding of the view.
  static double scale(const Extreme<double>& x) { return x.angle > 1.6 ? kInfinity : 0; }
  // The view's float components, squared and divided by a cosine that is held above .01.
  static constexpr Claims kClaims = {"warp: bandwidths", kRatio | kAngle, 4 * kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    const auto warped = warp_to_incoming(asg(x), x.direction);
    return {warped.lobe.bandwidth_x, warped.lobe.bandwidth_y, warped.jacobian};
  }
};

struct WarpAmplitude : Relative {
  static constexpr Claims kClaims = {"warp: amplitude", kRatio | kAngle | kAmplitude,
                                     kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {warp_to_incoming(asg(x), x.direction).lobe.amplitude};
  }
};

struct WarpMean {
  // Far behind the horizon, where the amplitude vanishes, widths hang on a difference of tails.
  static double scale(const Extreme<double>& x) { return x.angle > 3 ? kInfinity : x.narrow; }
  static constexpr Claims kClaims = {"warp, mean form: bandwidths", kRatio | kAngle,
                                     4 * kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    const auto warped =
        warp_mean_to_incoming(asg(x), make_lobe_shape(x.narrow, x.wide), x.direction);
    return {warped.lobe.bandwidth_x, warped.lobe.bandwidth_y};
  }
};

/// Mass of half vectors per mass of the lobe, and the frame.
struct WarpMeanMass {
  static double scale(const Extreme<double>&) { return 4; }
  static constexpr Claims kClaims = {"warp, mean form: jacobian and frame", kRatio | kAngle,
                                     2 * kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    const auto warped =
        warp_mean_to_incoming(asg(x), make_lobe_shape(x.narrow, x.wide), x.direction);
    std::vector<T> all = frame_lengths(warped.lobe.frame);
    all.push_back(warped.jacobian);
    return all;
  }
};

struct WarpMeanIntegral {
  static double scale(const Extreme<double>& x) { return 4 * asg_integral_exact(x.narrow, x.wide); }
  static constexpr Claims kClaims = {"warp, mean form: integral", kRatio | kAngle,
                                     2 * kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {integral(
        warp_mean_to_incoming(asg(x), make_lobe_shape(x.narrow, x.wide), x.direction).lobe)};
  }
};

}  // namespace

std::vector<Row> asg_rows() {
  return examine_all<AsgEval, AsgIntegralAt<AsgIntegral::fast>, AsgIntegralAt<AsgIntegral::series>,
                     AsgIntegralAt<AsgIntegral::exact>, AsgProductAmplitude<SmoothTerms::constant>,
                     AsgProductAmplitude<SmoothTerms::expanded>, AsgProductBandwidths,
                     AsgInnerProduct<false>, AsgInnerProduct<true>, AsgSgConvolution,
                     AsgAsgConvolution, ResultFrames, AsgPdf, AsgSample, AsgConversions,
                     AsgSupportAngles, AsgClampedCosine, WarpBandwidths, WarpAmplitude, WarpMean,
                     WarpMeanMass, WarpMeanIntegral>();
}

}  // namespace burnish::test
