// The fits of D(h) by lobes that the runtime interpolates. BURNISH_UPDATE=1 fits them anew and
// writes runtime/src/material/half_vector_tables.cpp.

#include <cstdlib>
#include <fstream>
#include <iomanip>

#include <gtest/gtest.h>

#include "material/half_vector_fit.h"

namespace burnish {
namespace {

constexpr int kSteps = 10;

struct TableModel {
  const char* name;
  SpecularModel model;
  Distribution distribution;
  test::LobeFit start;  ///< near the limit of narrow lobes
};

const test::LobeFit kOne{{1, 1, 1}};

const TableModel kModels[] = {
    {"kWardLobes", SpecularModel::ward, Distribution::ggx, kOne},
    {"kAshikhminLobes", SpecularModel::ashikhmin_shirley, Distribution::ggx, kOne},
    {"kBeckmannLobes", SpecularModel::cook_torrance, Distribution::beckmann, kOne},
    {"kGgxLobes1", SpecularModel::cook_torrance, Distribution::ggx, kOne},
    {"kGgxLobes2", SpecularModel::cook_torrance, Distribution::ggx, {{1.8, 1.8, 1}, {.3, .3, 1}}},
    {"kGgxLobes3",
     SpecularModel::cook_torrance,
     Distribution::ggx,
     {{2.5, 2.5, 1}, {.7, .7, 1}, {.1, .1, 1}}},
};

Material material_of(const TableModel& table, float alpha_x, float alpha_y) {
  Material material;
  material.model = table.model;
  material.distribution = table.distribution;
  material.alpha_x = alpha_x;
  material.alpha_y = alpha_y;
  return material;
}

void write_node(std::ostream& out, const test::LobeFit& node) {
  out << "  {";
  for (size_t k = 0; k < node.size(); ++k)
    out << (k > 0 ? ", " : "") << "{" << node[k].scaled_bandwidth_x << "f, "
        << node[k].scaled_bandwidth_y << "f, " << node[k].amplitude << "f}";
  out << "},\n";
}

/// Round lobes only, each started from the one before.
std::vector<test::LobeFit> blinn_phong_fits() {
  std::vector<test::LobeFit> nodes;
  for (int i = 0; i <= kSteps; ++i) {
    Material material;
    material.model = SpecularModel::cook_torrance;
    material.distribution = Distribution::blinn_phong;
    material.alpha_x = material.alpha_y = std::max(float(i) / float(kSteps), 1e-3f);
    nodes.push_back(fit_half_vector_lobes(material, i > 0 ? nodes.back() : kOne).lobes);
  }
  return nodes;
}

void write_tables(const std::string& path) {
  std::ofstream out(path);
  out << std::fixed << std::setprecision(4) << "#include \"material/half_vector_tables.h\"\n\n"
      << "// Written by the test HalfVectorTables.* with BURNISH_UPDATE=1.\n"
      << "// clang-format off\nnamespace burnish::internal {\n";
  const auto write = [&](const std::string& head, const std::vector<test::LobeFit>& nodes) {
    out << "\nconst TabulatedLobe " << head << " = {\n";
    for (const test::LobeFit& node : nodes) write_node(out, node);
    out << "};\n";
  };
  for (const TableModel& table : kModels)
    write(std::string(table.name) + "[kTableNodes][" + std::to_string(table.start.size()) + "]",
          fit_half_vector_table(material_of(table, 1, 1), table.start, kSteps));
  write("kBlinnPhongLobes[kTableSteps + 1][1]", blinn_phong_fits());
  out << "\n}  // namespace burnish::internal\n";
}

/// The lobes of a grid's node, as the runtime has them, in the units of the fit.
test::LobeFit held_at(const Material& material, int count) {
  const HalfVectorLobes lobes = half_vector_lobes(material, count);
  const double x2 = double(material.alpha_x) * material.alpha_x;
  const double y2 = double(material.alpha_y) * material.alpha_y;
  test::LobeFit held;
  for (size_t k = 0; k < static_cast<size_t>(lobes.count); ++k)
    held.push_back({double(lobes.lobe[k].bandwidth_x) * x2, double(lobes.lobe[k].bandwidth_y) * y2,
                    double(lobes.lobe[k].amplitude)});
  return held;
}

TEST(HalfVectorTables, HoldFitsThatASearchDoesNotImprove) {
  if (std::getenv("BURNISH_UPDATE"))
    write_tables(BURNISH_SOURCE_DIR "/runtime/src/material/half_vector_tables.cpp");
  for (const TableModel& table : kModels)
    for (const auto& [x, y] : {std::pair{0.1f, 0.1f}, {0.3f, 0.1f}, {0.5f, 0.5f}, {1.0f, 0.4f}}) {
      const Material material = material_of(table, x, y);
      const auto count = static_cast<int>(table.start.size());
      const double error =
          test::fit_error(material, half_vector_lobes(material, count)).projected_l2;
      const double found = fit_half_vector_lobes(material, held_at(material, count)).error;
      // Four digits in the table, and an energy within 1e-4, move a minimum of .001 by that much.
      EXPECT_LE(error, 1.02 * found + 2e-4) << table.name << " " << x << " " << y;
    }
}

}  // namespace
}  // namespace burnish
