#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include <fmt/format.h>

#include "bench.h"
#include "burnish/formats/error.h"
#include "burnish/sphere/asg_convolution.h"
#include "burnish/sphere/asg_product.h"
#include "burnish/sphere/asg_sampling.h"
#include "burnish/sphere/batch.h"
#include "burnish/sphere/lobe_comb.h"
#include "burnish/sphere/lobe_moments.h"
#include "burnish/sphere/normalised_asg.h"
#include "burnish/sphere/octahedral_map.h"
#include "burnish/sphere/sg_clamped_cosine.h"
#include "burnish/sphere/spherical_warp.h"
#include "burnish/sphere/visibility_taps.h"
#include "common/options.h"
#include "micro.h"
#include "sphere_truth.h"
#include "stations.h"

namespace burnish::tools {
namespace {

struct Options {
  BenchOptions bench;
  int repetitions = 9;
  int run_ms = 20;
  std::string instruction_set;
};

constexpr size_t kItems = 2048;  ///< lobes in a pass: all arrays stay in the first two caches
constexpr unsigned kSeed = 20131;

// What an ASG's value cannot do without, and the value itself.
constexpr const char* kExp = "exp";
constexpr const char* kDot = "dot product";
constexpr const char* kAsgEval = "ASG eval";

/// Random inputs, the same for every operator. Single lobes for the scalar forms, arrays of their
/// parts for the batch forms.
struct Inputs {
  std::vector<AnisotropicGaussian<float>> lobes, others;
  std::vector<SphericalGaussian<float>> round_lobes, round_others;
  std::vector<Vector3f> directions;
  std::vector<NormalisedAsg<float>> normalised;
  std::vector<LobeMoments<float>> moments;
  std::vector<LobeShape<float>> shapes;
  std::vector<Vector3f> gradients;  ///< unit, in the lobes' tangent planes, at `azimuth`
  std::vector<float> bandwidth_x, bandwidth_y, sharpness, u, v;
  std::vector<float> distance, azimuth, across;  ///< of a boundary from a lobe
  std::vector<float> sg_distance;                ///< of another one from the round lobe
  std::vector<float> x, y, z;                    ///< of the directions
  std::vector<float> exponents;                  ///< negative
  std::vector<float> frame_x[3], frame_z[3];     ///< components of the lobes' axes
  std::vector<float> gradient_x, gradient_y;     ///< of the gradients, in the lobes' frames
  std::vector<float> ones = std::vector<float>(kItems, 1.0f);
  std::vector<float> results = std::vector<float>(kItems), more_results = results;
  std::vector<std::vector<float>> warped{10, results};

  batch::WarpedLobes warped_soa() {
    auto& w = warped;
    return {{w[0], w[1], w[2]}, {w[3], w[4], w[5]}, w[6], w[7], w[8], w[9]};
  }
  batch::Directions soa() const { return {x, y, z}; }
  batch::AnisotropicGaussians lobes_soa() const {
    return {{frame_x[0], frame_x[1], frame_x[2]},
            {frame_z[0], frame_z[1], frame_z[2]},
            bandwidth_x,
            bandwidth_y,
            ones};
  }
  batch::SphericalGaussians round_soa() const {
    return {{frame_z[0], frame_z[1], frame_z[2]}, sharpness, ones};
  }
};

/// Lobes of a geometric mean bandwidth of 1..1000 and a ratio of bandwidths of 1..100, a second
/// lobe, a direction and a boundary within three deviations of each.
Inputs make_inputs() {
  Inputs in;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> unit(0, 1), around(-kPi<float>, kPi<float>);
  std::normal_distribution<float> normal;
  const auto near = [&](const Frame<float>& frame, float bx, float by) {
    const float px = 0.7f * normal(random) / std::sqrt(bx),
                py = 0.7f * normal(random) / std::sqrt(by);
    return frame.to_world(Vector3f(px, py, 1).normalized());
  };
  const auto turned = [](const Vector3f& axis, float angle) {
    const Frame<float> f = frame_from_axis(axis);
    const Vector3f x = std::cos(angle) * f.x + std::sin(angle) * f.y;
    return Frame<float>{x, axis.cross(x), axis};
  };
  for (size_t i = 0; i < kItems; ++i) {
    const float mean = std::pow(1000.0f, unit(random)), root = std::pow(10.0f, unit(random));
    const Vector3f axis = Vector3f(normal(random), normal(random), normal(random)).normalized();
    AnisotropicGaussian<float> lobe{turned(axis, around(random)), mean * root, mean / root, 1};
    const Vector3f v = near(lobe.frame, lobe.bandwidth_x, lobe.bandwidth_y);
    AnisotropicGaussian<float> other{turned(v, around(random)), lobe.bandwidth_y * 2,
                                     lobe.bandwidth_y, 1};
    in.lobes.push_back(lobe);
    in.others.push_back(other);
    in.round_lobes.push_back({axis, 2 * mean, 1});
    in.round_others.push_back({v, mean, 1});
    in.directions.push_back(v);
    for (int component = 0; component < 3; ++component) {
      in.frame_x[component].push_back(lobe.frame.x[component]);
      in.frame_z[component].push_back(lobe.frame.z[component]);
    }
    in.x.push_back(v.x());
    in.y.push_back(v.y());
    in.z.push_back(v.z());
    in.bandwidth_x.push_back(lobe.bandwidth_x);
    in.bandwidth_y.push_back(lobe.bandwidth_y);
    in.sharpness.push_back(2 * mean);
    const float azimuth = around(random);
    in.azimuth.push_back(azimuth);
    in.gradient_x.push_back(std::cos(azimuth));
    in.gradient_y.push_back(std::sin(azimuth));
    in.gradients.push_back(std::cos(azimuth) * lobe.frame.x + std::sin(azimuth) * lobe.frame.y);
    in.across.push_back(directional_bandwidth(lobe, in.gradients.back()));
    const auto near_boundary = [&](float bandwidth) {
      const float deviations = 6 * (unit(random) - 0.5f);
      return std::clamp(deviations / std::sqrt(2 * bandwidth), -kPi<float> / 2, kPi<float> / 2);
    };
    in.distance.push_back(near_boundary(in.across.back()));
    in.sg_distance.push_back(near_boundary(mean));
    in.normalised.push_back(nasg_from_asg(lobe));
    in.moments.push_back(asg_moments(lobe.bandwidth_x, lobe.bandwidth_y));
    in.shapes.push_back(make_lobe_shape(lobe.bandwidth_x, lobe.bandwidth_y));
    in.exponents.push_back(-10 * unit(random));
    in.u.push_back(unit(random));
    in.v.push_back(unit(random));
  }
  return in;
}

/// What an operator's results are compared with.
struct Truth {
  std::vector<double> values;
  bool relative;  ///< error relative to the value; of visible fractions, the difference
};

/// One operator in one form: `work` fills the results of all items.
struct Measured {
  std::string operator_name, level, form;
  std::function<void()> work;
  const Truth* truth = nullptr;  ///< null: its error is not asked for here
};

/// A scalar form: f(i) for every item.
template <class F>
Measured scalar(Inputs& in, std::string name, std::string level, F f,
                const Truth* truth = nullptr) {
  const auto work = [&in, f] {
    for (size_t i = 0; i < kItems; ++i) in.results[i] = f(i);
  };
  return {std::move(name), std::move(level), "scalar", work, truth};
}

template <class F>
Truth make_truth(bool relative, F f) {
  Truth truth{std::vector<double>(kItems), relative};
  for (size_t i = 0; i < kItems; ++i) truth.values[i] = f(i);
  return truth;
}

/// What items have as truth, by quadrature.
struct Truths {
  Truth asg_integral, sg_half_space, asg_half_space;
};

Truths make_truths(const Inputs& in) {
  return {make_truth(true,
                     [&](size_t i) {
                       return asg_integral_exact<double>(in.bandwidth_x[i], in.bandwidth_y[i]);
                     }),
          make_truth(
              false,
              [&](size_t i) { return sg_half_space_fraction(in.sharpness[i], in.sg_distance[i]); }),
          make_truth(false, [&](size_t i) {
            return asg_half_space_fraction(in.bandwidth_x[i], in.bandwidth_y[i], in.distance[i],
                                           in.azimuth[i]);
          })};
}

std::vector<Measured> sg_operators(Inputs& in, const Truths& truths) {
  const auto hemisphere = [&in](HemisphereLevel level) {
    return [&in, level](size_t i) {
      return visible_fraction_hemisphere(in.sharpness[i], in.sg_distance[i], level);
    };
  };
  return {
      scalar(in, "SG eval", "",
             [&in](size_t i) { return eval(in.round_lobes[i], in.directions[i]); }),
      scalar(in, "SG integral", "", [&in](size_t i) { return integral(in.round_lobes[i]); }),
      scalar(in, "SG product", "",
             [&in](size_t i) { return product(in.round_lobes[i], in.round_others[i]).amplitude; }),
      scalar(in, "SG inner product", "",
             [&in](size_t i) { return inner_product(in.round_lobes[i], in.round_others[i]); }),
      scalar(in, "SG convolution", "mean direction",
             [&in](size_t i) { return convolve(in.round_lobes[i], in.round_others[i]).amplitude; }),
      scalar(in, "SG convolution", "fast",
             [&in](size_t i) {
               return convolve_fast(in.round_lobes[i], in.round_others[i]).amplitude;
             }),
      scalar(
          in, "SG clamped cosine", "",
          [&in](size_t i) { return clamped_cosine_integral(in.round_lobes[i], in.directions[i]); }),
      scalar(in, "SG sample", "",
             [&in](size_t i) { return sample(in.round_lobes[i], in.u[i], in.v[i]).x(); }),
      scalar(in, "SG in a half-space", "fast", hemisphere(HemisphereLevel::fast),
             &truths.sg_half_space),
      scalar(in, "SG in a half-space", "exact", hemisphere(HemisphereLevel::exact),
             &truths.sg_half_space),
  };
}

std::vector<Measured> asg_operators(Inputs& in, const Truths& truths) {
  const auto integral_at = [&in](AsgIntegral level) {
    return [&in, level](size_t i) {
      return asg_integral(in.bandwidth_x[i], in.bandwidth_y[i], level);
    };
  };
  return {
      scalar(in, kAsgEval, "", [&in](size_t i) { return eval(in.lobes[i], in.directions[i]); }),
      scalar(in, "ASG integral", "fast", integral_at(AsgIntegral::fast), &truths.asg_integral),
      scalar(in, "ASG integral", "series", integral_at(AsgIntegral::series), &truths.asg_integral),
      scalar(
          in, "ASG integral", "4 midpoints",
          [&in](size_t i) {
            return asg_integral_midpoints<4>(in.bandwidth_x[i], in.bandwidth_y[i]);
          },
          &truths.asg_integral),
      scalar(in, "ASG integral", "exact", integral_at(AsgIntegral::exact), &truths.asg_integral),
      scalar(in, "ASG product", "Eq. 13",
             [&in](size_t i) { return product(in.lobes[i], in.others[i]).amplitude; }),
      scalar(in, "ASG product", "expanded",
             [&in](size_t i) {
               return product(in.lobes[i], in.others[i], SmoothTerms::expanded).amplitude;
             }),
      scalar(in, "ASG inner product", "closed form",
             [&in](size_t i) { return inner_product_closed_form(in.lobes[i], in.others[i]); }),
      scalar(in, "ASG inner product", "by product",
             [&in](size_t i) { return inner_product(in.lobes[i], in.others[i]); }),
      scalar(in, "ASG convolution with SG", "",
             [&in](size_t i) { return convolve(in.lobes[i], in.round_others[i]).amplitude; }),
      scalar(in, "ASG convolution with ASG", "",
             [&in](size_t i) { return convolve(in.lobes[i], in.others[i]).amplitude; }),
      scalar(in, "ASG sample", "",
             [&in](size_t i) { return sample(in.lobes[i], in.u[i], in.v[i]).x(); }),
      scalar(in, "ASG support", "",
             [&in](size_t i) { return support(in.lobes[i], 0.01f).angle_x; }),
      scalar(in, "ASG moments", "once a lobe",
             [&in](size_t i) { return asg_moments(in.bandwidth_x[i], in.bandwidth_y[i]).mean_z; }),
      scalar(in, "ASG clamped cosine", "from moments",
             [&in](size_t i) {
               return mean_clamped_cosine(in.moments[i],
                                          in.lobes[i].frame.to_local(in.directions[i]));
             }),
      scalar(in, "warp", "peak",
             [&in](size_t i) {
               return warp_to_incoming(in.lobes[i], in.directions[i]).lobe.bandwidth_x;
             }),
      scalar(in, "warp", "mean",
             [&in](size_t i) {
               return warp_mean_to_incoming(in.lobes[i], in.shapes[i], in.directions[i])
                   .lobe.bandwidth_x;
             }),
      scalar(in, "lobe comb", "5 teeth, once a shape",
             [&in](size_t i) {
               return make_lobe_comb(in.bandwidth_x[i], in.bandwidth_y[i], 5).amplitude[0];
             }),
      scalar(in, "NASG eval", "",
             [&in](size_t i) { return eval(in.normalised[i], in.directions[i]); }),
      scalar(in, "NASG integral", "", [&in](size_t i) { return integral(in.normalised[i]); }),
      scalar(in, "NASG sample", "",
             [&in](size_t i) { return sample(in.normalised[i], in.u[i], in.v[i]).x(); }),
      scalar(in, "octahedral map", "",
             [&in](size_t i) { return direction_to_octahedral(in.directions[i]).x(); }),
  };
}

/// A half-space whose boundary is a great circle: what each tap of a lobe reads.
struct GreatCircle {
  struct Sample {
    float distance;
    Vector3f gradient;
  };
  Vector3f normal;

  Sample operator()(const Vector3f& v) const {
    const float sine = std::clamp(v.dot(normal), -1.0f, 1.0f);
    return {std::asin(sine), normal - sine * v};
  }
};

std::vector<Measured> visibility_models(Inputs& in, const Truths& truths) {
  const auto model = [&in](VisibilityModel which) {
    return [&in, which](size_t i) {
      return visible_fraction(which, in.lobes[i], in.distance[i], in.gradients[i]);
    };
  };
  const auto taps = [&in](int count) {
    return [&in, table = make_quantile_taps<float>(count)](size_t i) {
      const AnisotropicGaussian<float>& lobe = in.lobes[i];
      const Vector3f normal =
          std::sin(in.distance[i]) * lobe.frame.z + std::cos(in.distance[i]) * in.gradients[i];
      return visible_fraction(VisibilityModel::directional, lobe, quantile_taps(table, lobe),
                              GreatCircle{normal});
    };
  };
  const char* name = "ASG in a half-space";
  return {
      scalar(in, name, "cap", model(VisibilityModel::cap), &truths.asg_half_space),
      scalar(in, name, "hemisphere", model(VisibilityModel::hemisphere), &truths.asg_half_space),
      scalar(in, name, "directional", model(VisibilityModel::directional), &truths.asg_half_space),
      scalar(in, name, "directional, 3 taps", taps(3), &truths.asg_half_space),
      scalar(in, name, "directional, 5 taps", taps(5), &truths.asg_half_space),
  };
}

/// One lobe against many, or many each by itself, as the shading kernels use them.
std::vector<Measured> batch_forms(Inputs& in, const Truths& truths) {
  const std::span<float> out(in.results);
  const auto form = [](const char* name, const char* level, std::function<void()> work,
                       const Truth* truth = nullptr) {
    return Measured{name, level, "batch", std::move(work), truth};
  };
  const auto integral_at = [&in, out](AsgIntegral level) {
    return [&in, out, level] { batch::asg_integral(in.bandwidth_x, in.bandwidth_y, level, out); };
  };
  const auto hemisphere_at = [&in, out](HemisphereLevel level) {
    return [&in, out, level] {
      batch::visible_fraction_hemisphere(in.sharpness, in.sg_distance, out, level);
    };
  };
  return {
      form(kExp, "", [&in, out] { batch::exp(in.exponents, out); }),
      form(kDot, "", [&in, out] { batch::dot(in.directions[0], in.soa(), out); }),
      form("SG eval", "", [&in, out] { batch::eval(in.round_lobes[0], in.soa(), out); }),
      form("SG integral", "", [&in, out] { batch::sg_integral(in.sharpness, out); }),
      form("SG inner product", "",
           [&in, out] { batch::inner_product(in.round_lobes[0], in.round_soa(), out); }),
      form("SG in a half-space", "fast", hemisphere_at(HemisphereLevel::fast),
           &truths.sg_half_space),
      form(
          "SG in a half-space", "fast, one lobe",
          [&in, out] { batch::visible_fraction_hemisphere(in.sharpness[0], in.sg_distance, out); }),
      form("SG in a half-space", "exact", hemisphere_at(HemisphereLevel::exact),
           &truths.sg_half_space),
      form(kAsgEval, "", [&in, out] { batch::eval(in.lobes[0], in.soa(), out); }),
      form(kAsgEval, "a lobe each", [&in, out] { batch::eval(in.lobes_soa(), in.soa(), out); }),
      form("ASG integral", "fast", integral_at(AsgIntegral::fast), &truths.asg_integral),
      form("ASG integral", "exact", integral_at(AsgIntegral::exact), &truths.asg_integral),
      form("ASG inner product", "closed form",
           [&in, out] { batch::inner_product(in.lobes[0], in.lobes_soa(), out); }),
      form("ASG clamped cosine", "from moments",
           [&in, out] {
             batch::mean_clamped_cosine(in.moments[0], in.lobes[0].frame, in.soa(), out);
           }),
      form(
          "ASG in a half-space", "hemisphere",
          [&in, out] { batch::visible_fraction_hemisphere(in.sharpness, in.distance, out); },
          &truths.asg_half_space),
      form("bandwidth across a boundary", "",
           [&in, out] {
             batch::directional_bandwidth(in.bandwidth_x, in.bandwidth_y, in.gradient_x,
                                          in.gradient_y, out);
           }),
      form(
          "ASG in a half-space", "directional",
          [&in, out] { batch::visible_fraction_directional(in.across, in.distance, out); },
          &truths.asg_half_space),
      form("SG clamped cosine", "",
           [&in, out, lobe = prepare_clamped_cosine(in.round_lobes[0])] {
             batch::clamped_cosine_integral(lobe, in.soa(), out);
           }),
      form("ASG convolution with SG", "",
           [&in, out] {
             batch::convolve(in.bandwidth_x, in.bandwidth_y, in.sharpness,
                             {in.warped[0], in.warped[1], out});
           }),
      form("warp", "peak",
           [&in] { batch::warp_to_incoming(in.lobes_soa(), in.soa(), in.warped_soa()); }),
      form("warp", "mean",
           [&in] {
             const batch::AnisotropicGaussians lobes = in.lobes_soa();
             batch::warp_mean_to_incoming(in.bandwidth_x[0], in.bandwidth_y[0], in.shapes[0],
                                          {lobes.x, lobes.z}, in.soa(), in.warped_soa());
           }),
      form("octahedral map", "",
           [&in, out] { batch::direction_to_octahedral(in.soa(), out, in.more_results); }),
  };
}

BenchRow make_row(const Measured& measured, double ns, const Inputs& in) {
  BenchRow row = {{"operator", measured.operator_name},
                  {"level", measured.level},
                  {"form", measured.form},
                  {"ns", ns}};
  if (!measured.truth) return row;
  measured.work();
  double worst = 0, sum = 0;
  for (size_t i = 0; i < kItems; ++i) {
    const double truth = measured.truth->values[i];
    const double error =
        std::abs(in.results[i] - truth) / (measured.truth->relative ? std::abs(truth) : 1.0);
    worst = std::max(worst, error);
    sum += error;
  }
  row["worst_error"] = worst;
  row["mean_error"] = sum / static_cast<double>(kItems);
  row["error_is"] = measured.truth->relative ? "relative" : "absolute";
  return row;
}

void run(const Options& options) {
  require_writable(std::vector{options.bench.json, options.bench.csv});
  batch::use_instruction_set(options.instruction_set);
  Work work(options.bench.common());
  Inputs in = make_inputs();
  const Truths truths = make_truths(in);
  std::vector<Measured> all;
  for (const auto& family : {sg_operators(in, truths), asg_operators(in, truths),
                             visibility_models(in, truths), batch_forms(in, truths)})
    all.insert(all.end(), family.begin(), family.end());

  std::vector<MicroBenchmark> timed;
  for (const Measured& measured : all)
    timed.push_back({fmt::format("{}/{}/{}", measured.operator_name, measured.level, measured.form),
                     kItems, measured.work});
  const std::vector<double> ns =
      time_benchmarks(timed, {options.repetitions, static_cast<double>(options.run_ms) / 1000});
  std::vector<BenchRow> rows;
  for (size_t i = 0; i < all.size(); ++i) rows.push_back(make_row(all[i], ns[i], in));
  report_bench("sphere", rows, options.bench, work);
  const auto ns_of = [&](const char* name) {
    for (size_t i = 0; i < all.size(); ++i)
      if (all[i].operator_name == name && all[i].form == "batch") return ns[i];
    return 0.0;
  };
  work.print(
      fmt::format("\nbatch forms on {}; ASG eval takes {:.2f} times an exp and two dot products",
                  options.instruction_set, ns_of(kAsgEval) / (ns_of(kExp) + 2 * ns_of(kDot))));
}

}  // namespace

std::function<void()> declare_sphere_bench(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  options->bench.threads = 1;
  options->instruction_set = batch::instruction_sets().front();
  add_number(app, "--repeat", "N", options->repetitions, {1, 1000},
             "timed runs of each operator; their median counts");
  add_number(app, "--run-ms", "MS", options->run_ms, {1, 10000, "milliseconds"},
             "least length of a run");
  std::vector<std::pair<std::string, std::string>> sets;
  for (const std::string_view name : batch::instruction_sets()) sets.emplace_back(name, name);
  add_choice(app, "--instruction-set", options->instruction_set, sets, "of the batch forms");
  add_report_options(app, options->bench);
  return [options] { run(*options); };
}

}  // namespace burnish::tools
