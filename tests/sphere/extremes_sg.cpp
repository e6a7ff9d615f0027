// Spherical Gaussians, the normalised ASG and circular Gaussians at extreme inputs.

#include "burnish/sphere/circular_gaussian.h"
#include "burnish/sphere/normalised_asg.h"
#include "burnish/sphere/sg_clamped_cosine.h"
#include "sphere/extremes.h"

namespace burnish::test {
namespace {

struct SgEval : ToAmplitude {
  static constexpr Claims kClaims = {"SG: eval", kAngle | kAmplitude, kFewRoundings, true,
                                     Trend::falls};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {eval(sg(x), x.direction)};
  }
};

struct SgIntegral : Relative {
  static constexpr Claims kClaims = {"SG: integral", kAmplitude, kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {integral(sg(x))};
  }
};

struct SgProductAmplitude : ToAmplitude {
  static constexpr Claims kClaims = {"SG: product, amplitude", kOther | kAngle | kAmplitude,
                                     kFewRoundings, true, Trend::falls};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {product(sg(x), other_sg(x)).amplitude};
  }
};

struct SgProductSharpness {
  // Opposite axes leave the difference of the two.
  static double scale(const Extreme<double>& x) { return x.narrow + x.other_narrow; }
  static constexpr Claims kClaims = {"SG: product, sharpness", kOther | kAngle, kFewRoundings, true,
                                     Trend::falls};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {product(sg(x), other_sg(x)).sharpness};
  }
};

struct SgInnerProduct {
  // The exponent's rounding counts against what the lobes would share about one axis. Where the
  // product's sharpness leaves float's range it is held at the end, and nothing is claimed.
  static double scale(const Extreme<double>& x) {
    const double sharpness = x.narrow + x.other_narrow;
    if (sharpness > std::numeric_limits<float>::max()) return kInfinity;
    return integral(SphericalGaussian<double>{Vector3d::UnitZ(), sharpness, std::abs(x.amplitude)});
  }
  static constexpr Claims kClaims = {"SG: inner product", kOther | kAngle | kAmplitude,
                                     kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {inner_product(sg(x), other_sg(x))};
  }
};

struct SgConvolution : Relative {
  static constexpr Claims kClaims = {"SG: convolution", kOther, 4 * kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    const auto c = convolve(sg(x), other_sg(x)), fast = convolve_fast(sg(x), other_sg(x));
    return {c.sharpness, c.amplitude, fast.sharpness, fast.amplitude};
  }
};

struct SgMeanCosine : Relative {
  static constexpr Claims kClaims = {"SG: mean cosine and 1 - it", 0, kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {mean_cosine(x.narrow), mean_cosine_complement(x.narrow)};
  }
};

struct SgFromMean : Relative {
  // Sharpness from 1 - r and back.
  static constexpr Claims kClaims = {"SG: sharpness of a mean direction", 0, 4 * kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    const auto mean = mean_resultant(x.narrow);
    return {sharpness_from_mean(mean), sharpness_approximate(mean), sharpness_toksvig(mean)};
  }
};

struct SgClampedCosine {
  static double scale(const Extreme<double>& x) {
    return clamped_cosine_integral(
        SphericalGaussian<double>{Vector3d::UnitZ(), x.narrow, std::abs(x.amplitude)},
        Vector3d(Vector3d::UnitZ()));
  }
  static constexpr Claims kClaims = {"SG: clamped cosine", kAngle | kAmplitude, kFewRoundings, true,
                                     Trend::falls};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {clamped_cosine_integral(sg(x), x.direction)};
  }
};

struct SgPdf {
  static double scale(const Extreme<double>& x) {
    return pdf(SphericalGaussian<double>{Vector3d::UnitZ(), x.narrow, 1},
               Vector3d(Vector3d::UnitZ()));
  }
  static constexpr Claims kClaims = {"SG: pdf", kAngle, kFewRoundings, true, Trend::falls};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {pdf(sg(x), x.direction)};
  }
};

struct SgSample : ToOne {
  static constexpr Claims kClaims = {"SG: sample", 0, kFewRoundings, false};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    std::vector<T> all;
    for (const T u : {T(0), T(0.25), T(0.75), T(1)}) {
      const Vector3<T> v = sample(sg(x), u, T(0.125));
      all.insert(all.end(), {v.x(), v.y(), v.z()});
    }
    return all;
  }
};

template <class T>
NormalisedAsg<T> nasg(const Extreme<T>& x) {
  return {x.frame, x.narrow, x.ratio - 1, x.amplitude};
}

// An anisotropy of 1e6 makes 1e3 roundings of an azimuth's cosine, which enters squared.
constexpr double kAzimuthRounding = 1e3 * kRounding;

// Opposite to its axis, an anisotropic lobe has no limit.
bool is_opposite(const Extreme<double>& x) { return x.ratio > 1 && x.angle > 3.14; }

struct NasgEval {
  static double scale(const Extreme<double>& x) {
    return is_opposite(x) ? kInfinity : std::abs(x.amplitude);
  }
  static constexpr Claims kClaims = {"NASG: eval", kRatio | kAngle | kAmplitude, kAzimuthRounding};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {eval(nasg(x), x.direction)};
  }
};

struct NasgIntegral : Relative {
  static constexpr Claims kClaims = {"NASG: integral", kRatio | kAmplitude, kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {integral(nasg(x))};
  }
};

struct NasgSample : ToOne {
  static constexpr Claims kClaims = {"NASG: sample", kRatio, kFewRoundings, false};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    std::vector<T> all;
    for (const T u : {T(0), T(0.25), T(0.75), T(1)}) {
      const Vector3<T> v = sample(nasg(x), u, T(0.125));
      all.insert(all.end(), {v.x(), v.y(), v.z()});
    }
    return all;
  }
};

struct NasgPdf {
  static double scale(const Extreme<double>& x) {
    if (is_opposite(x)) return kInfinity;
    return pdf(NormalisedAsg<double>{{}, x.narrow, x.ratio - 1, 1}, Vector3d(Vector3d::UnitZ()));
  }
  static constexpr Claims kClaims = {"NASG: pdf", kRatio | kAngle, kAzimuthRounding};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {pdf(nasg(x), x.direction)};
  }
};

struct NasgConversions {
  // The sharpness is twice the bandwidth, and held at the end of float's range.
  static double scale(const Extreme<double>& x) {
    return 2 * x.wide > std::numeric_limits<float>::max() ? kInfinity : 0;
  }
  static constexpr Claims kClaims = {"NASG: from an ASG and back", kRatio, kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    const auto there = nasg_from_asg(asg(x));
    const auto back = asg_from_nasg(there);
    return {there.sharpness, there.anisotropy, back.bandwidth_x, back.bandwidth_y};
  }
};

struct CircularInnerProduct {
  static double scale(const Extreme<double>& x) {
    if (x.narrow + x.other_narrow > std::numeric_limits<float>::max()) return kInfinity;
    return std::abs(
        integral(CircularGaussian<double>{0, std::max(x.narrow, x.other_narrow), x.amplitude}));
  }
  static constexpr Claims kClaims = {"circular: inner product", kOther | kAngle | kAmplitude,
                                     kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {inner_product(CircularGaussian<T>{0, x.narrow, x.amplitude},
                          CircularGaussian<T>{x.angle, x.other_narrow, 1})};
  }
};

struct LongitudinalProduct : ToAmplitude {
  static constexpr Claims kClaims = {"longitudinal: product, amplitude",
                                     kOther | kAngle | kAmplitude, kFewRoundings, true,
                                     Trend::falls};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {product(LongitudinalGaussian<T>{0, x.narrow, x.amplitude},
                    LongitudinalGaussian<T>{x.angle, x.other_narrow, 1})
                .amplitude};
  }
};

struct LongitudinalCosine {
  static double scale(const Extreme<double>& x) {
    return std::abs(integral(LongitudinalGaussian<double>{0, x.narrow, x.amplitude},
                             -kPi<double> / 2, kPi<double> / 2));
  }
  static constexpr Claims kClaims = {"longitudinal: integral with the cosine", kAngle | kAmplitude,
                                     2 * kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    const T center = std::clamp(x.distance, -kPi<T> / 2, kPi<T> / 2);
    return {integral_times_cosine(LongitudinalGaussian<T>{center, x.narrow, x.amplitude},
                                  -kPi<T> / 2, kPi<T> / 2)};
  }
};

struct CircularEval : ToAmplitude {
  static constexpr Claims kClaims = {"circular: eval", kAngle | kAmplitude, kFewRoundings, true,
                                     Trend::falls};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {eval(CircularGaussian<T>{0, x.narrow, x.amplitude}, x.angle)};
  }
};

struct CircularIntegral : Relative {
  static constexpr Claims kClaims = {"circular: integral", kAmplitude, kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {integral(CircularGaussian<T>{0, x.narrow, x.amplitude})};
  }
};

struct CircularProduct : ToAmplitude {
  static constexpr Claims kClaims = {"circular: product, amplitude", kOther | kAngle | kAmplitude,
                                     kFewRoundings, true, Trend::falls};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {product(CircularGaussian<T>{0, x.narrow, x.amplitude},
                    CircularGaussian<T>{x.angle, x.other_narrow, 1})
                .amplitude};
  }
};

struct CircularArc {
  static double scale(const Extreme<double>& x) {
    return std::abs(integral(CircularGaussian<double>{0, x.narrow, x.amplitude}));
  }
  static constexpr Claims kClaims = {"circular: integral over an arc", kAngle | kAmplitude,
                                     kFewRoundings, true, Trend::rises};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {integral_over_arc(CircularGaussian<T>{0, x.narrow, x.amplitude}, T(0), x.angle)};
  }
};

struct LongitudinalIntegral {
  static double scale(const Extreme<double>& x) {
    return std::abs(
        integral(LongitudinalGaussian<double>{0, x.narrow, x.amplitude}, 0.0, kPi<double>));
  }
  static constexpr Claims kClaims = {"longitudinal: integral", kAngle | kAmplitude, kFewRoundings,
                                     true, Trend::rises};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {integral(LongitudinalGaussian<T>{0, x.narrow, x.amplitude}, T(0), x.angle)};
  }
};

}  // namespace

std::vector<Row> sg_rows() {
  return examine_all<SgEval, SgIntegral, SgProductAmplitude, SgProductSharpness, SgInnerProduct,
                     SgConvolution, SgMeanCosine, SgFromMean, SgClampedCosine, SgPdf, SgSample,
                     NasgEval, NasgIntegral, NasgSample, NasgPdf, NasgConversions,
                     CircularInnerProduct, LongitudinalProduct, LongitudinalCosine, CircularEval,
                     CircularIntegral, CircularProduct, CircularArc, LongitudinalIntegral>();
}

}  // namespace burnish::test
