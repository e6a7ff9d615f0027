#include "material_times.h"

#include <algorithm>
#include <array>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "burnish/material/specular_slice.h"
#include "burnish/sphere/batch.h"
#include "micro.h"

namespace burnish::tools {
namespace {

constexpr size_t kViews = 2048;  ///< all arrays stay in the second cache
constexpr unsigned kSeed = 2013;

/// Half-vector frames of many surfaces, and views of them from above their horizons.
struct Views {
  std::array<std::vector<float>, 3> x, z, outgoing, local_outgoing;
  std::array<std::vector<float>, 12> warped;
  std::string instruction_set;

  batch::Frames frames() const { return {{x[0], x[1], x[2]}, {z[0], z[1], z[2]}}; }
  batch::Directions views() const { return {outgoing[0], outgoing[1], outgoing[2]}; }
  batch::Directions local_views() const {
    return {local_outgoing[0], local_outgoing[1], local_outgoing[2]};
  }
  /// Only if it is another one: that takes as long as a thousand lobes.
  void use(const std::string& set) {
    if (set != instruction_set) batch::use_instruction_set(set);
    instruction_set = set;
  }
  batch::WarpedLobes results() {
    auto& w = warped;
    return {{w[0], w[1], w[2]}, {w[3], w[4], w[5]}, w[6], w[7], w[8], w[9]};
  }
  SpecularSlices slices() {
    auto& w = warped;
    return {{w[0], w[1], w[2]}, {w[3], w[4], w[5]}, w[6], w[7], w[8], {w[9], w[10], w[11]}};
  }
};

Views make_views() {
  Views views;
  std::mt19937 random(kSeed);
  std::normal_distribution<float> normal;
  const auto direction = [&] {
    return Vector3f(normal(random), normal(random), normal(random)).normalized();
  };
  for (size_t i = 0; i < kViews; ++i) {
    const Vector3f z = direction(), x = z.cross(direction()).normalized();
    Vector3f local = direction();
    local.z() = std::abs(local.z());
    const Vector3f outgoing = Frame<float>{x, z.cross(x), z}.to_world(local);
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<size_t>(axis);
      views.x[a].push_back(x[axis]);
      views.z[a].push_back(z[axis]);
      views.outgoing[a].push_back(outgoing[axis]);
      views.local_outgoing[a].push_back(local[axis]);
    }
  }
  for (std::vector<float>& array : views.warped) array.resize(kViews);
  return views;
}

/// A row without its time, and the loop to be timed.
struct Timed {
  BenchRow row;
  size_t items;
  std::function<void()> work;
};

BenchRow start_row(const char* operation, const char* per, const std::string& on, double alpha_x,
                   double alpha_y) {
  BenchRow row = {{"what", "time"}, {"operation", operation}, {"per", per}, {"on", on}};
  row["alpha_x"] = alpha_x;
  row["alpha_y"] = alpha_y;
  return row;
}

/// The best one and AVX2.
std::vector<std::string> instruction_sets() {
  std::vector<std::string> sets;
  for (const std::string_view set : batch::instruction_sets())
    if (sets.empty() || set == "AVX2") sets.emplace_back(set);
  return sets;
}

void add_warps(Views& views, std::vector<Timed>& all) {
  for (const std::string& set : instruction_sets()) {
    for (const auto& [alpha_x, alpha_y] : {std::pair{0.3f, 0.03f}, {0.1f, 0.03f}}) {
      const float bx = 1 / (alpha_x * alpha_x), by = 1 / (alpha_y * alpha_y);
      all.push_back(
          {start_row("warp, peak", "lobe", set, alpha_x, alpha_y), kViews, [&views, set, bx, by] {
             views.use(set);
             batch::warp_to_incoming(bx, by, views.frames(), views.views(), views.results());
           }});
      all.push_back({start_row("warp, mean", "lobe", set, alpha_x, alpha_y), kViews,
                     [&views, set, bx, by, shape = make_lobe_shape(bx, by)] {
                       views.use(set);
                       batch::warp_mean_to_incoming(bx, by, shape, views.frames(), views.views(),
                                                    views.results());
                     }});
    }
  }
}

struct NamedMaterial {
  const char* name;
  Material material;
};

std::array<NamedMaterial, 4> materials() {
  Material ward;
  ward.model = SpecularModel::ward;
  ward.alpha_x = 0.3f;
  ward.alpha_y = 0.03f;
  Material ashikhmin = ward, ggx = ward, beckmann = ward;
  ashikhmin.model = SpecularModel::ashikhmin_shirley;
  ggx.model = beckmann.model = SpecularModel::cook_torrance;
  beckmann.distribution = Distribution::beckmann;
  return {{{"ward", ward}, {"ashikhmin", ashikhmin}, {"beckmann", beckmann}, {"ggx", ggx}}};
}

/// Of all teeth from all views; `per` a tooth and view.
void add_slice(Views& views, std::vector<Timed>& all, const BenchRow& row,
               const std::shared_ptr<const PreparedMaterial>& prepared, const std::string& set) {
  const auto work = [&views, prepared, set] {
    views.use(set);
    for (int tooth = 0; tooth < prepared->count; ++tooth)
      specular_slices(*prepared, tooth, views.local_views(), views.slices());
  };
  all.push_back({row, kViews * static_cast<size_t>(prepared->count), work});
}

void add_slices(Views& views, std::vector<Timed>& all) {
  for (const NamedMaterial& named : materials()) {
    const Material& material = named.material;
    for (const int taps : {0, 1, 5, 9}) {  // 0: the paper's form
      SpecularOptions options;
      options.form = taps == 0 ? SpecularForm::peak : SpecularForm::moments;
      options.taps = std::max(taps, 1);
      const auto prepared =
          std::make_shared<const PreparedMaterial>(prepare_material(material, options));
      const auto row = [&](const char* operation, const char* per, const std::string& on) {
        BenchRow r = start_row(operation, per, on, material.alpha_x, material.alpha_y);
        r["model"] = named.name;
        r["taps"] = options.taps;
        r["lobes"] = prepared->count;
        return r;
      };
      all.push_back({row("prepare", "call", "scalar"), 1, [&views, material, options] {
                       views.warped[0][0] = prepare_material(material, options).tooth[0].integral;
                     }});
      for (const std::string& set : instruction_sets())
        add_slice(views, all, row(taps == 0 ? "slice, peak" : "slice", "lobe", set), prepared, set);
    }
  }
}

}  // namespace

std::vector<BenchRow> measure_material_times(int repetitions) {
  Views views = make_views();
  std::vector<Timed> all;
  add_warps(views, all);
  add_slices(views, all);
  std::vector<MicroBenchmark> loops;
  for (const Timed& timed : all)
    loops.push_back({fmt::format("{}", loops.size()), timed.items, timed.work});
  const std::vector<double> ns = time_benchmarks(loops, {repetitions});
  batch::use_instruction_set("");
  std::vector<BenchRow> rows;
  for (size_t i = 0; i < all.size(); ++i) {
    rows.push_back(all[i].row);
    rows.back()["ns"] = ns[i];
  }
  return rows;
}

}  // namespace burnish::tools
