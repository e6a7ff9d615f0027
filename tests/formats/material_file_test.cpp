#include "burnish/formats/material_file.h"

#include <cmath>
#include <map>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include "burnish/formats/material_names.h"
#include "burnish/material/presets.h"
#include "burnish/material/roughness.h"
#include "files.h"
#include "json_damage.h"

namespace burnish::test {
namespace {

const std::string kName = "metal.material.json";

std::string parse_error(const std::string& json, ErrorKind kind = ErrorKind::input) {
  return error_of(
      kName, [&] { parse_material(json, kName); }, kind);
}

/// Numbers that no default has.
struct Numbers {
  std::mt19937 random;

  float in(float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random);
  }
  Rgb color(float low, float high) {
    const float r = in(low, high), g = in(low, high), b = in(low, high);
    return {r, g, b};
  }
  Vector3f direction() {
    Vector3f v;
    do v = color(-1, 1).matrix();
    while (!(v.squaredNorm() > 0.1f && v.squaredNorm() < 1));
    return v.normalized();
  }
};

std::shared_ptr<const FittedSpecular> random_fitted(Numbers& numbers, int lobes) {
  auto fitted = std::make_shared<FittedSpecular>();
  for (int i = 0; i < lobes; ++i) {
    AnisotropicGaussian<float> lobe;
    lobe.frame = frame_from_normal_tangent<float>(numbers.direction(), numbers.direction());
    lobe.bandwidth_x = std::exp(numbers.in(-3, 8));
    lobe.bandwidth_y = std::exp(numbers.in(-3, 8));
    lobe.amplitude = numbers.in(0, 3);
    fitted->lobes.push_back(lobe);
  }
  for (int i = 0; i < 3 + lobes; ++i) fitted->color_by_difference.push_back(numbers.color(0, 20));
  for (int i = 0; i < 2 * lobes; ++i) fitted->masking.push_back(numbers.in(0, 4));
  return fitted;
}

Fresnel random_fresnel(Numbers& numbers, FresnelModel model) {
  Fresnel fresnel;
  fresnel.model = model;
  if (model == FresnelModel::schlick) {
    fresnel.normal_reflectance = numbers.color(0, 1);
    return fresnel;
  }
  fresnel.eta = numbers.color(0.1f, 3);
  if (model == FresnelModel::conductor) fresnel.k = numbers.color(0, 9);
  return fresnel;
}

/// Only the fields of the model differ from the default.
Material random_material(Numbers& numbers, SpecularModel model, FresnelModel fresnel) {
  Material material;
  material.model = model;
  material.diffuse = numbers.color(0, 1);
  if (model != SpecularModel::none) material.specular = numbers.color(0, 2);
  if (has_alpha(model)) {
    material.alpha_x = std::exp(numbers.in(-9, 0));
    material.alpha_y = std::exp(numbers.in(-9, 0));
  }
  if (has_fresnel(model)) material.fresnel = random_fresnel(numbers, fresnel);
  if (model == SpecularModel::fitted) material.fitted = random_fitted(numbers, 2);
  return material;
}

void expect_equal(const FittedSpecular& a, const FittedSpecular& b) {
  ASSERT_EQ(a.lobes.size(), b.lobes.size());
  for (size_t i = 0; i < a.lobes.size(); ++i) {
    EXPECT_EQ(a.lobes[i].frame.z, b.lobes[i].frame.z);
    EXPECT_EQ(a.lobes[i].frame.x, b.lobes[i].frame.x);
    EXPECT_TRUE(a.lobes[i].frame.y.isApprox(b.lobes[i].frame.y, 1e-5f));  // computed: rounding
    EXPECT_EQ(a.lobes[i].bandwidth_x, b.lobes[i].bandwidth_x);
    EXPECT_EQ(a.lobes[i].bandwidth_y, b.lobes[i].bandwidth_y);
    EXPECT_EQ(a.lobes[i].amplitude, b.lobes[i].amplitude);
  }
  ASSERT_EQ(a.color_by_difference.size(), b.color_by_difference.size());
  for (size_t i = 0; i < a.color_by_difference.size(); ++i)
    EXPECT_TRUE((a.color_by_difference[i] == b.color_by_difference[i]).all());
  EXPECT_EQ(a.masking, b.masking);
}

/// Exact equality: floats are written in a form that reads back equal.
void expect_equal(const Material& a, const Material& b) {
  EXPECT_TRUE((a.diffuse == b.diffuse).all());
  EXPECT_TRUE((a.specular == b.specular).all());
  EXPECT_EQ(a.model, b.model);
  EXPECT_EQ(a.alpha_x, b.alpha_x);
  EXPECT_EQ(a.alpha_y, b.alpha_y);
  EXPECT_EQ(a.fresnel.model, b.fresnel.model);
  EXPECT_TRUE((a.fresnel.normal_reflectance == b.fresnel.normal_reflectance).all());
  EXPECT_TRUE((a.fresnel.eta == b.fresnel.eta).all());
  EXPECT_TRUE((a.fresnel.k == b.fresnel.k).all());
  EXPECT_EQ(a.distribution, b.distribution);
  EXPECT_EQ(a.shadowing, b.shadowing);
  ASSERT_EQ(a.fitted != nullptr, b.fitted != nullptr);
  if (a.fitted) expect_equal(*a.fitted, *b.fitted);
}

TEST(MaterialFile, ReadsBackWhatWasWritten) {
  constexpr unsigned kSeed = 71;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  Numbers numbers{std::mt19937(kSeed)};
  const TemporaryFolder folder;
  const std::string path = folder.file("a.material.json");
  for (const auto& [name, model] : kSpecularModelNames)
    for (const FresnelModel fresnel :
         {FresnelModel::schlick, FresnelModel::dielectric, FresnelModel::conductor}) {
      SCOPED_TRACE(name);
      const Material material = random_material(numbers, model, fresnel);
      write_material(material, path);
      expect_equal(read_material(path), material);
    }
  Material material = random_material(numbers, SpecularModel::cook_torrance, FresnelModel::schlick);
  for (const auto& [name, distribution] : kDistributionNames)
    for (const auto& [shadowing_name, shadowing] : kShadowingNames) {
      material.distribution = distribution;
      material.shadowing = shadowing;
      write_material(material, path);
      expect_equal(read_material(path), material);
    }
}

TEST(MaterialFile, KeepsItsNameSourceAndError) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.material.json");
  MaterialFile file;
  file.name = "quotes \" backslash \\ newline \n umlaut \xc3\xbc";
  file.source = "metal.bsdf";
  file.fit_relative_l2 = 0.0834567890123;
  write_material_file(file, path);
  const MaterialFile found = read_material_file(path);
  EXPECT_EQ(found.name, file.name);
  EXPECT_EQ(found.source, file.source);
  EXPECT_EQ(found.fit_relative_l2, file.fit_relative_l2);
  // A second round changes nothing.
  EXPECT_EQ(format_material(found, path), read_bytes(path));
}

/// What a model does not use is not in its file, and comes back as the default.
TEST(MaterialFile, LeavesOutWhatItsModelDoesNotUse) {
  Material material;
  material.model = SpecularModel::ward;
  material.fresnel.normal_reflectance = Rgb::Constant(0.7f);
  material.distribution = Distribution::beckmann;
  material.fitted = std::make_shared<FittedSpecular>();
  MaterialFile file;
  file.material = material;
  const Material found = parse_material(format_material(file, kName), kName).material;
  Material expected;
  expected.model = SpecularModel::ward;
  expect_equal(found, expected);
}

TEST(MaterialFile, StoresEveryPreset) {
  for (const MaterialPreset& preset : material_presets()) {
    SCOPED_TRACE(preset.name);
    MaterialFile file;
    file.name = preset.name;
    file.source = preset.source;
    file.material = preset.material;
    const MaterialFile found = parse_material(format_material(file, kName), kName);
    EXPECT_EQ(found.source, preset.source);
    EXPECT_EQ(domain_error(preset.material), "");
    expect_equal(found.material, preset.material);
  }
}

TEST(MaterialFile, IsReadableByPeople) {
  MaterialFile file;
  file.name = "gold";
  Material& material = file.material;
  material.model = SpecularModel::cook_torrance;
  material.diffuse = Rgb::Zero();
  material.alpha_x = 0.25f;
  material.alpha_y = 0.05f;
  material.fresnel = {FresnelModel::conductor, Rgb::Zero(), {0.25f, 0.5f, 1.5f}, {4, 2.5f, 1.625f}};
  EXPECT_EQ(format_material(file, kName), R"({
  "format": "burnish material",
  "format_version": 1,
  "name": "gold",
  "source": "",
  "model": "cook-torrance",
  "diffuse": [0, 0, 0],
  "specular": [1, 1, 1],
  "alpha_x": 0.25,
  "alpha_y": 0.05,
  "distribution": "ggx",
  "shadowing": "smith",
  "fresnel": {"eta": [0.25, 0.5, 1.5], "k": [4, 2.5, 1.625]}
}
)");
}

/// A file of a model, with its fields.
std::string material_json(const std::string& model, const std::string& fields) {
  return "{\"format\": \"burnish material\", \"format_version\": 1, \"model\": \"" + model + "\"" +
         (fields.empty() ? "" : ",\n" + fields) + "}";
}

TEST(MaterialFile, TakesShortForms) {
  const auto read = [](const std::string& model, const std::string& fields) {
    return parse_material(material_json(model, fields), kName).material;
  };
  const Material plain = read("diffuse", R"("diffuse": 0.25)");
  EXPECT_TRUE((plain.diffuse == Rgb::Constant(0.25f)).all());
  EXPECT_FALSE(plain.has_specular());
  const Material glossy = read("cook-torrance", R"("roughness": 0.5, "fresnel": {"eta": 1.5})");
  EXPECT_TRUE((glossy.diffuse == 0).all());
  EXPECT_TRUE((glossy.specular == 1).all());
  EXPECT_EQ(glossy.alpha_x, 0.25f);
  EXPECT_EQ(glossy.alpha_y, 0.25f);
  EXPECT_EQ(glossy.fresnel.model, FresnelModel::dielectric);
  EXPECT_EQ(glossy.distribution, Distribution::ggx);
  EXPECT_EQ(glossy.shadowing, Shadowing::smith);
  const Material round = read("ward", R"("alpha": 0.125, "specular": [0.5, 0.25, 0])");
  EXPECT_EQ(round.alpha_x, 0.125f);
  EXPECT_EQ(round.alpha_y, 0.125f);
  EXPECT_EQ(round.specular.y(), 0.25f);
  const Material metal =
      read("ashikhmin-shirley", R"("alpha": 1, "fresnel": {"eta": [1, 2, 3], "k": 4})");
  EXPECT_EQ(metal.fresnel.model, FresnelModel::conductor);
  EXPECT_EQ(metal.fresnel.eta.z(), 3);
  EXPECT_EQ(metal.fresnel.k.z(), 4);
}

TEST(MaterialFile, ConvertsRoughnessInItsWholeRange) {
  EXPECT_EQ(alpha_from_roughness(1), 1);
  EXPECT_EQ(alpha_from_roughness(0.5f), 0.25f);
  EXPECT_EQ(alpha_from_roughness(kMinRoughness), kMinAlpha);
  const std::string fields = R"("roughness": 0.01, "specular": 1)";
  EXPECT_EQ(parse_material(material_json("ward", fields), kName).material.alpha_y, kMinAlpha);
}

/// Line numbers below refer to these.
constexpr const char* kMicrofacets = R"({
  "format": "burnish material",
  "format_version": 1,
  "name": "n", "source": "s",
  "model": "cook-torrance",
  "diffuse": [0.1, 0.2, 0.3],
  "specular": [1, 0.5, 2],
  "alpha_x": 0.5, "alpha_y": 0.25,
  "distribution": "beckmann",
  "shadowing": "v-cavity",
  "fresnel": {"eta": [1, 2, 3],
              "k": [4, 5, 6]}
})";
constexpr const char* kFitted = R"({
  "format": "burnish material",
  "format_version": 1,
  "model": "fitted",
  "fit_relative_l2": 0.1,
  "fitted": {
    "lobes": [
      {"axis": [0, 0, 1], "tangent": [1, 0, 0],
       "bandwidth_x": 2, "bandwidth_y": 3, "amplitude": 4}
    ],
    "color_by_difference": [[1, 2, 3], 1],
    "masking": [0.5, 2]
  }
})";

std::string replaced(std::string json, const std::string& replace, const std::string& with) {
  const size_t place = json.find(replace);
  EXPECT_NE(place, std::string::npos) << replace;
  return json.replace(place, replace.size(), with);
}

struct Damage {
  const char *replace, *with, *place, *cause;
};

void expect_refused(const char* json, std::initializer_list<Damage> cases) {
  ASSERT_EQ(parse_error(json), "");
  for (const Damage& bad : cases) {
    const std::string error = parse_error(replaced(json, bad.replace, bad.with));
    EXPECT_NE(error.find(bad.place), std::string::npos) << bad.place << " / " << error;
    EXPECT_NE(error.find(bad.cause), std::string::npos) << bad.cause << " / " << error;
  }
}

TEST(MaterialFile, RejectsBadValuesByPathAndLine) {
  expect_refused(
      kMicrofacets,
      {{"burnish material", "burnish lights", "line 2, /format:", "expected 'burnish material'"},
       {"version\": 1", "version\": 0", "line 3, /format_version:", "1 or more"},
       {"\"n\"", "7", "line 4, /name:", "is number, expected a string"},
       {"\"s\"", "[]", "line 4, /source:", "is array, expected a string"},
       {"\"model\"", "\"modell\"", "line 5, /modell:", "unknown field, expected one of format,"},
       {"\"model\": \"cook-torrance\",", "", "line 1, /:", "has no field 'model'"},
       {"cook-torrance", "blinn", "line 5, /model:",
        "'blinn', expected diffuse, ward, ward-balanced, ashikhmin-shirley, cook-torrance or "
        "fitted"},
       {"[0.1, 0.2, 0.3]", "[0.1, 0.2, 1.3]", "line 6, /diffuse/2:", "1.3, expected 0..1"},
       {"[0.1, 0.2, 0.3]", "-1", "line 6, /diffuse:", "-1, expected 0..1"},
       {"[0.1, 0.2, 0.3]", "\"red\"", "line 6, /diffuse:", "is string, expected an array"},
       {"[1, 0.5, 2]", "[1, -0.5, 2]", "line 7, /specular/1:", "-0.5, expected 0.."},
       {"[1, 0.5, 2]", "[1, 0.5]", "line 7, /specular:", "has 2 elements, expected 3"},
       {"\"alpha_x\": 0.5", "\"alpha_x\": 0", "line 8, /alpha_x:", "0, expected 0.0001..1"},
       {"\"alpha_y\": 0.25", "\"alpha_y\": 1.5", "line 8, /alpha_y:", "1.5, expected"},
       {", \"alpha_y\": 0.25", "", "line 1, /:", "has no field 'alpha_y'"},
       {"\"alpha_y\"", "\"alpha\"", "line 1, /:", "expected one of 'alpha', 'roughness', and"},
       {"\"alpha_x\": 0.5, \"alpha_y\": 0.25", "\"roughness\": 0.001",
        "line 8, /roughness:", "0.001, expected 0.01..1"},
       {"\"alpha_x\": 0.5, \"alpha_y\": 0.25,", "", "line 1, /:", "expected one of 'alpha'"},
       {"beckmann", "gtr", "line 9, /distribution:", "expected beckmann, ggx or blinn-phong"},
       {"v-cavity", "kelemen", "line 10, /shadowing:", "expected smith, smith-separable or v-c"},
       {"\"eta\": [1, 2, 3]", "\"eta\": [1, 0, 3]", "line 11, /fresnel/eta/1:", "0, expected"},
       {"\"eta\": [1, 2, 3]", "\"normal_reflectance\": 0.5",
        "line 12, /fresnel/k:", "beside 'normal_reflectance'"},
       {"\"eta\": [1, 2, 3],", "",
        "line 11, /fresnel:", "expected one of the fields 'normal_reflectance' and 'eta'"},
       {"[4, 5, 6]", "[4, 5, -6]", "line 12, /fresnel/k/2:", "-6, expected 0..100"},
       {"\"k\"", "\"kappa\"", "line 12, /fresnel/kappa:", "unknown field"}});
  EXPECT_EQ(
      parse_error(replaced(kMicrofacets, "version\": 1", "version\": 2"), ErrorKind::unsupported),
      kName + ": material format version 2, this build reads up to 1");
  EXPECT_NE(parse_error("[]").find("is array, expected an object"), std::string::npos);
}

TEST(MaterialFile, RejectsBadFitsByPathAndLine) {
  expect_refused(
      kFitted,
      {{"0.1", "-0.1", "line 5, /fit_relative_l2:", "expected 0 or more"},
       {"\"fitted\": {", "\"shadowing\": {",
        "line 6, /shadowing:", "not a field of the model 'fitted'"},
       {"\"fit_relative_l2\": 0.1", "\"alpha\": 0.1",
        "line 5, /alpha:", "not a field of the model 'fitted'"},
       {"[0, 0, 1]", "[0, 0, 2]", "line 8, /fitted/lobes/0/axis:", "length 2"},
       {"[1, 0, 0]", "[0, 0, 1]", "line 8, /fitted/lobes/0/tangent:", "cosine 1"},
       {"\"bandwidth_x\": 2", "\"bandwidth_x\": 0",
        "line 9, /fitted/lobes/0/bandwidth_x:", "0, expected"},
       {"\"bandwidth_y\": 3", "\"bandwidth_y\": 1e40",
        "line 9, /fitted/lobes/0/bandwidth_y:", "1e+40, expected"},
       {"\"amplitude\": 4", "\"amplitude\": -4",
        "line 9, /fitted/lobes/0/amplitude:", "-4, expected"},
       {"\"amplitude\"", "\"color\"", "line 9, /fitted/lobes/0/color:", "unknown field"},
       {"[[1, 2, 3], 1]", "[1]",
        "line 11, /fitted/color_by_difference:", "has 1 elements, expected 2..4096"},
       {"[[1, 2, 3], 1]", "[1, [1, 2, -3]]",
        "line 11, /fitted/color_by_difference/1/2:", "-3, expected 0"},
       {"[0.5, 2]", "[0.5, null]", "line 12, /fitted/masking/1:", "is null, expected a number"},
       {",\n    \"masking\": [0.5, 2]", "", "line 6, /fitted:", "has no field 'masking'"}});
  std::string lobes = "\"lobes\": [";
  EXPECT_NE(parse_error(replaced(kFitted, "\"lobes\": [\n", "\"lobes\": [], \"masking_\": [\n"))
                .find("unknown field"),
            std::string::npos);
  for (int i = 0; i < kMaxFittedLobes; ++i)
    lobes += R"({"axis": [0, 0, 1], "tangent": [1, 0, 0], "bandwidth_x": 1, "bandwidth_y": 1,
                 "amplitude": 1},)";
  EXPECT_NE(parse_error(replaced(kFitted, "\"lobes\": [", lobes))
                .find("/fitted/lobes: has 9 elements, expected 1..8"),
            std::string::npos);
}

/// Every field that some model has, in files of the models that do not.
TEST(MaterialFile, FieldsOfOtherModelsAreRefused) {
  const std::map<std::string, std::string> needed = {
      {"diffuse", R"("diffuse": 1)"},
      {"ward", R"("alpha": 0.5)"},
      {"ward-balanced", R"("alpha": 0.5)"},
      {"ashikhmin-shirley", R"("alpha": 0.5, "fresnel": {"eta": 2})"},
      {"cook-torrance", R"("alpha": 0.5, "fresnel": {"eta": 2})"},
      {"fitted",
       R"("fitted": {"lobes": [{"axis": [0, 0, 1], "tangent": [1, 0, 0], "bandwidth_x": 1,
          "bandwidth_y": 1, "amplitude": 1}], "color_by_difference": [1, 1], "masking": [1, 1]})"}};
  const std::map<std::string, std::pair<std::string, std::string>> fields = {
      {"specular", {"1", "ward ward-balanced ashikhmin-shirley cook-torrance fitted"}},
      {"alpha_x", {"1", "ward ward-balanced ashikhmin-shirley cook-torrance"}},
      {"alpha_y", {"1", "ward ward-balanced ashikhmin-shirley cook-torrance"}},
      {"roughness", {"1", "ward ward-balanced ashikhmin-shirley cook-torrance"}},
      {"distribution", {"\"ggx\"", "cook-torrance"}},
      {"shadowing", {"\"smith\"", "cook-torrance"}}};
  for (const auto& [model, own] : needed) {
    ASSERT_EQ(parse_error(material_json(model, own)), "") << model;
    for (const auto& [field, use] : fields) {
      const std::string error =
          parse_error(material_json(model, own + ",\n\"" + field + "\": " + use.first));
      const bool refused = error.find("/" + field + ": not a field of the model '" + model + "'") !=
                           std::string::npos;
      EXPECT_EQ(refused, (" " + use.second + " ").find(" " + model + " ") == std::string::npos)
          << model << ", " << field << ": " << error;
    }
  }
  EXPECT_NE(parse_error(material_json("ward", R"("alpha": 1, "fresnel": {"eta": 2})"))
                .find("/fresnel: not a field of the model 'ward'"),
            std::string::npos);
  EXPECT_NE(parse_error(material_json("ward", R"("alpha": 1, "fitted": {})"))
                .find("/fitted: not a field of the model 'ward'"),
            std::string::npos);
}

TEST(MaterialFile, WriterRejectsWhatCannotBeReadBack) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.json");
  const auto write_error = [&](SpecularModel model, auto spoil) {
    Numbers numbers{std::mt19937(5)};
    Material material = random_material(numbers, model, FresnelModel::conductor);
    spoil(material);
    return error_of(
        path, [&] { write_material(material, path); }, ErrorKind::output);
  };
  EXPECT_EQ(write_error(SpecularModel::ward, [](Material& m) { m.alpha_x = 2; }),
            path + ": this material cannot be stored: line 9, /alpha_x: 2, expected 0.0001..1");
  EXPECT_NE(write_error(SpecularModel::ward, [](Material& m) { m.specular[1] = NAN; }), "");
  EXPECT_NE(write_error(SpecularModel::none, [](Material& m) { m.diffuse[1] = -1; }), "");
  EXPECT_NE(write_error(SpecularModel::cook_torrance, [](Material& m) { m.fresnel.k[2] = -1; }),
            "");
  EXPECT_NE(write_error(SpecularModel::fitted, [](Material& m) { m.fitted = nullptr; })
                .find("has no field 'fitted'"),
            std::string::npos);
  EXPECT_NE(write_error(SpecularModel::fitted,
                        [](Material& m) {
                          FittedSpecular fitted = *m.fitted;
                          fitted.masking.clear();
                          m.fitted = std::make_shared<FittedSpecular>(fitted);
                        })
                .find("/fitted/masking: has 0 elements"),
            std::string::npos);
  EXPECT_EQ(folder.file_count(), 0u);
}

/// Frames that are off by just what is kept as written.
TEST(MaterialFile, RoundingThatIsKeptAsWrittenIsSound) {
  constexpr unsigned kSeed = 29;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  Numbers numbers{std::mt19937(kSeed)};
  for (int i = 0; i < 300; ++i) {
    const auto near = [&](double value) {
      return value + (numbers.in(-1, 1) < 0 ? -3.9e-6 : 3.9e-6);
    };
    std::ostringstream axis, tangent;
    axis.precision(9);
    tangent.precision(9);
    axis << '[' << near(0) << ", 0, " << near(1) << ']';
    tangent << '[' << near(1) << ", 0, 0]";
    const std::string json =
        replaced(replaced(kFitted, "[0, 0, 1]", axis.str()), "[1, 0, 0]", tangent.str());
    EXPECT_EQ(parse_error(json), "") << json;
  }
}

TEST(MaterialFile, FailedWriteLeavesTheOldFile) {
  expect_output_survives_failure("a.json",
                                 [](const std::string& path) { write_material(Material(), path); });
}

TEST(MaterialFile, EveryTruncationAndChangeIsRejectedOrRead) {
  Numbers numbers{std::mt19937(9)};
  for (const SpecularModel model : {SpecularModel::cook_torrance, SpecularModel::fitted}) {
    MaterialFile file;
    file.material = random_material(numbers, model, FresnelModel::conductor);
    expect_damage_is_refused_or_read(format_material(file, kName), 12,
                                     [](const std::string& json) { parse_material(json, kName); });
  }
}

/// tests/data/materials/version1.json and version1-fitted.json were written when version 1 was the
/// newest, from the values that are expected here.
TEST(MaterialFile, VersionOneStaysReadable) {
  const std::string folder = std::string(BURNISH_TEST_DATA) + "/materials/";
  const MaterialFile file = read_material_file(folder + "version1.json");
  EXPECT_EQ(file.name, "brushed metal");
  EXPECT_EQ(file.source, "measured by hand");
  Material expected;
  expected.model = SpecularModel::cook_torrance;
  expected.diffuse = {0.1f, 0.2f, 0.3f};
  expected.specular = {1, 0.5f, 2};
  expected.alpha_x = 0.5f;
  expected.alpha_y = 1e-4f;
  expected.distribution = Distribution::beckmann;
  expected.shadowing = Shadowing::v_cavity;
  expected.fresnel = {FresnelModel::conductor, Fresnel().normal_reflectance, {1, 2, 3}, {4, 5, 6}};
  expect_equal(file.material, expected);

  const MaterialFile fit = read_material_file(folder + "version1-fitted.json");
  EXPECT_EQ(fit.fit_relative_l2, 0.0834567890123);
  FittedSpecular lobes;
  lobes.lobes.resize(2);
  lobes.lobes[0] = {{}, 2, 0.1f, 4};
  lobes.lobes[1] = {{{0, 1, 0}, {-0.8f, 0, 0.6f}, {0.6f, 0, 0.8f}}, 12.5f, 800, 0.25f};
  lobes.color_by_difference = {{1, 2, 3}, {0.5f, 0.25f, 0.125f}};
  lobes.masking = {0.5f, 0.75f, 2};
  Material fitted;
  fitted.model = SpecularModel::fitted;
  fitted.diffuse = Rgb::Zero();
  fitted.fitted = std::make_shared<FittedSpecular>(lobes);
  expect_equal(fit.material, fitted);
}

}  // namespace
}  // namespace burnish::test
