// The whole way through the real program on a small mesh, and what it writes.

#include <cmath>
#include <cstring>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "burnish/formats/image_file.h"
#include "burnish/formats/light_file.h"
#include "burnish/formats/transfer_file.h"
#include "sample_files.h"

namespace burnish::test {
namespace {

using nlohmann::json;

void expect_success(const RunResult& result) {
  EXPECT_FALSE(result.timed_out);
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
}

json parse_info(const std::string& path) {
  const RunResult result = burnish({"info", path, "--json"});
  expect_success(result);
  return json::parse(result.out);
}

/// Width and height of a PNG file, from its header.
std::pair<std::uint32_t, std::uint32_t> png_size(const std::string& path) {
  const std::string bytes = read_whole_file(path);
  if (bytes.size() < 24 || !bytes.starts_with("\x89PNG\r\n\x1a\n")) return {0, 0};
  const auto big_endian = [&](size_t at) {
    std::uint32_t value = 0;
    for (size_t i = at; i < at + 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
    return value;
  };
  return {big_endian(16), big_endian(20)};
}

/// The floats of one vertex property of a binary PLY whose vertices are floats and then three
/// bytes of colour.
std::vector<float> ply_property(const std::string& path, const std::string& name) {
  const std::string bytes = read_whole_file(path);
  const std::string end_mark = "end_header\n";
  const size_t end = bytes.find(end_mark);
  if (end == std::string::npos) throw std::runtime_error("no PLY header in " + path);
  std::istringstream header(bytes.substr(0, end));
  size_t count = 0, stride = 0, offset = std::string::npos;
  bool in_vertex = false;
  for (std::string word; header >> word;) {
    if (word == "element") {
      std::string element;
      size_t size = 0;
      header >> element >> size;
      in_vertex = element == "vertex";
      if (in_vertex) count = size;
    } else if (word == "property" && in_vertex) {
      std::string type, property;
      header >> type >> property;
      if (property == name) offset = stride;
      stride += type == "float" ? 4 : 1;
    }
  }
  if (offset == std::string::npos) throw std::runtime_error("no " + name + " in " + path);
  std::vector<float> values(count);
  for (size_t i = 0; i < count; ++i)
    std::memcpy(&values[i], bytes.data() + end + end_mark.size() + i * stride + offset, 4);
  return values;
}

class Pipeline : public testing::Test {
 protected:
  void SetUp() override {
    const RunResult baked = make_quick_bake(folder_);
    ASSERT_EQ(baked.exit_code, 0) << baked.err;
    transfer_ = folder_.file("box.h5");
    environment_ = folder_.file("env.exr");
  }

  /// Renders a small picture with further options and reads it back. The lights are fitted once.
  Image render(const std::string& name, const std::vector<std::string>& options) {
    const std::string lights = folder_.file("fixture.json");
    if (!std::filesystem::exists(lights))
      expect_success(burnish({"fit-light", environment_, "-o", lights, "--lobes", "4"}));
    return render_fitting(name, joined({"--lights", lights}, options));
  }

  /// The same, with lights fitted by the command itself.
  Image render_fitting(const std::string& name, const std::vector<std::string>& options) {
    const std::string path = folder_.file(name + ".exr");
    expect_success(burnish(joined(
        {"render", transfer_, "--env", environment_, "--size", "48x32", "-o", path}, options)));
    return read_image(path);
  }

  const ScratchFolder folder_;
  std::string transfer_, environment_;
};

double relative_difference(const Image& a, const Image& b) {
  EXPECT_EQ(a.pixels.size(), b.pixels.size());
  double difference = 0, norm = 0;
  for (size_t i = 0; i < b.pixels.size(); ++i) {
    difference += (a.pixels[i] - b.pixels[i]).cast<double>().square().sum();
    norm += b.pixels[i].cast<double>().square().sum();
  }
  return std::sqrt(difference / norm);
}

TEST_F(Pipeline, BakeWritesTheTransferItDescribes) {
  const Transfer transfer = read_transfer(transfer_);
  EXPECT_EQ(transfer.vertex_count(), 24u);  // 8 of the box, 16 of the floor
  EXPECT_EQ(transfer.triangles.size(), 30u);
  EXPECT_EQ(transfer.terms(), 8);
  EXPECT_EQ(transfer.bases.at(0).resolution, 32);
  EXPECT_EQ(transfer.provenance.directions, 64);
  EXPECT_EQ(transfer.provenance.mesh_name, "box.obj");
  EXPECT_TRUE(transfer.occluder_triangles.empty());
}

TEST_F(Pipeline, OccludersCastShadowsAndAreNotBaked) {
  // It hides the sky from 3 degrees above the horizon on, with the bright patch at 34 degrees.
  write_whole_file(folder_.file("roof.obj"), "v -90 5 -90\nv 90 5 -90\nv 0 5 90\nf 1 2 3\n");
  const std::string roofed = folder_.file("roofed.h5");
  const std::string roof = folder_.file("roof.obj");
  expect_success(burnish(joined(
      {"bake", folder_.file("box.obj"), "--occluders", roof, "--occluders", roof, "-o", roofed},
      quick_bake_options())));
  const json info = parse_info(roofed);
  EXPECT_EQ(info["vertices"], 24);
  EXPECT_EQ(info["occluder_triangles"], 2);
  const auto brightness = [&](const std::string& transfer) {
    const std::string ply = folder_.file("shaded.ply");
    expect_success(
        burnish({"shade", transfer, "--env", environment_, "--material", "diffuse", "-o", ply}));
    double sum = 0;
    for (const float value : ply_property(ply, "radiance_r")) sum += value;
    return sum;
  };
  EXPECT_LT(brightness(roofed), 0.5 * brightness(transfer_));
}

TEST_F(Pipeline, InfoDescribesEachKindAsJson) {
  const json mesh = parse_info(folder_.file("box.obj"));
  EXPECT_EQ(mesh["kind"], "mesh");
  EXPECT_EQ(mesh["vertices"], 24);
  EXPECT_EQ(mesh["triangles"], 30);
  EXPECT_EQ(mesh["components"], 2);
  EXPECT_EQ(mesh["boundary_edges"], 12);  // of the floor; the box is closed
  EXPECT_EQ(mesh["non_manifold_edges"], 0);
  EXPECT_EQ(mesh["degenerate_triangles"], 0);
  EXPECT_EQ(mesh["duplicate_vertices"], 0);
  EXPECT_EQ(mesh["missing_normals"], 24);
  EXPECT_EQ(mesh["bounds_min"], json({-1.5, 0, -1.5}));

  const json image = parse_info(environment_);
  EXPECT_EQ(image["kind"], "image");
  EXPECT_EQ(image["width"], 64);
  EXPECT_EQ(image["height"], 32);
  EXPECT_EQ(image["max"], json({20, 18, 15}));
  EXPECT_EQ(image["nan_values"], 0);

  const json transfer = parse_info(transfer_);
  EXPECT_EQ(transfer["kind"], "transfer");
  EXPECT_EQ(transfer["vertices"], 24);
  EXPECT_EQ(transfer["terms"], 8);
  EXPECT_EQ(transfer["resolution"], 32);
  EXPECT_EQ(transfer["file_bytes"], std::filesystem::file_size(transfer_));

  const std::string lights = folder_.file("env.json");
  expect_success(burnish({"fit-light", environment_, "-o", lights, "--lobes", "3"}));
  const json info = parse_info(lights);
  EXPECT_EQ(info["kind"], "lights");
  EXPECT_EQ(info["lobes"], read_lights(lights).rig.lobes.size());
  EXPECT_EQ(info["source"], "env.exr");
}

TEST_F(Pipeline, InfoTextNamesTheSameFigures) {
  const RunResult result = burnish({"info", folder_.file("box.obj")});
  expect_success(result);
  for (const char* line : {"vertices              24\n", "triangles             30\n",
                           "components            2\n", "boundary edges        12\n"})
    EXPECT_NE(result.out.find(line), std::string::npos) << line << "not in\n" << result.out;
}

TEST_F(Pipeline, FitLightWritesAtMostTheLobesAskedFor) {
  const std::string lights = folder_.file("env.json");
  expect_success(burnish({"fit-light", environment_, "-o", lights, "--lobes", "3"}));
  const LightFile file = read_lights(lights);
  EXPECT_GE(file.rig.lobes.size(), 1u);
  EXPECT_LE(file.rig.lobes.size(), 3u);
  ASSERT_TRUE(file.fit_relative_l2.has_value());
  EXPECT_LT(*file.fit_relative_l2, 1);  // better than no light at all
  ASSERT_TRUE(file.fit_irradiance_relative_l2.has_value());
  EXPECT_LT(*file.fit_irradiance_relative_l2, 1);
}

TEST_F(Pipeline, RenderWritesBothPicturesInTheSizeAskedFor) {
  const Image picture = render("a", {"--png", folder_.file("a.png")});
  EXPECT_EQ(picture.width, 48);
  EXPECT_EQ(picture.height, 32);
  EXPECT_EQ(png_size(folder_.file("a.png")), std::pair(48u, 32u));
  for (const Rgb& pixel : picture.pixels) {
    ASSERT_TRUE(pixel.isFinite().all());
    ASSERT_TRUE((pixel >= 0).all());
  }
}

TEST_F(Pipeline, LightsOfAFileAreThoseFittedOnTheFly) {
  const std::string lights = folder_.file("env.json");
  expect_success(burnish({"fit-light", environment_, "-o", lights, "--lobes", "5"}));
  const Image fitted = render_fitting("fitted", {"--lobes", "5"});
  const Image read = render_fitting("read", {"--lights", lights});
  // The file keeps a lobe's colour and amplitude as their product: a rounding each, then halves.
  EXPECT_LT(relative_difference(read, fitted), 1e-3);
  const Image other = render_fitting("other", {"--lobes", "1", "--material", "diffuse"});
  EXPECT_GT(relative_difference(other, fitted), 1e-2);
}

TEST_F(Pipeline, LightFilesOfHandmadeLightsNeedNoEnvironment) {
  const std::string lights = folder_.file("lamps.json");
  const auto render_with = [&](const std::string& list, const std::string& name) {
    std::ofstream(lights) << R"({"format": "burnish lights", "format_version": 2, )" << list << "}";
    expect_success(burnish({"render", transfer_, "--lights", lights, "--size", "48x32", "--per",
                            "pixel", "--material", "diffuse", "--reference", "64", "--report",
                            folder_.file("r.json"), "-o", folder_.file(name + ".exr")}));
    return read_image(folder_.file(name + ".exr"));
  };
  const std::string sun =
      R"("directionals": [{"toward": [0.6, 0.8, 0], "angular_radius_rad": 0.05, "irradiance": [3, 3, 3]}])";
  const std::string lamp =
      R"("spheres": [{"center": [-1, 2, 1], "radius": 0.2, "power": [90, 90, 90]}])";
  const std::string panel =
      R"("rectangles": [{"center": [1, 2, 2], "edge_x": [1, 0, 0], "edge_y": [0, 0, 1], "radiance": [4, 4, 4], "two_sided": true}])";
  for (const std::string& light : {sun, lamp, panel}) {
    const Image picture = render_with(light, "one");
    double sum = 0;
    for (const Rgb& pixel : picture.pixels) sum += double(pixel.x());
    EXPECT_GT(sum / double(picture.pixels.size()), 0.01) << light;
    const json report = json::parse(read_whole_file(folder_.file("r.json")));
    // 24 vertices that interpolate shadows leave a third; twice the energy would be off by 1.
    EXPECT_LT(report["reference"]["relative_l2"].get<double>(), 0.5) << light;
  }
  const Image once = render_with(sun + ", " + lamp + ", " + panel, "once");
  const Image twice = render_with(sun + ", " + lamp + ", " + panel + R"(, "scale": 2)", "twice");
  for (size_t i = 0; i < once.pixels.size(); ++i)
    ASSERT_TRUE((twice.pixels[i] == 2 * once.pixels[i]).all()) << i;  // exact in halves
}

TEST_F(Pipeline, AReferenceOfLobesNeedsTheirMap) {
  render("a", {});
  const RunResult result = burnish({"render", transfer_, "--lights", folder_.file("fixture.json"),
                                    "--reference", "4", "--png", folder_.file("a.png")});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(is_one_clean_line(result.err)) << result.err;
}

TEST_F(Pipeline, AlbedoScalesTheDiffusePicture) {
  const std::vector<std::string> diffuse = {"--material", "diffuse", "--diffuse"};
  const Image white = render("white", joined(diffuse, {"1,1,1"}));
  const Image tinted = render("tinted", joined(diffuse, {"1,0.5,0"}));
  const Rgb center_white = white.at(24, 16), center_tinted = tinted.at(24, 16);
  ASSERT_GT(center_white.minCoeff(), 0);  // the default camera frames the box
  EXPECT_EQ(center_tinted.x(), center_white.x());
  EXPECT_EQ(center_tinted.y(), 0.5f * center_white.y());  // exact in floats and in halves
  EXPECT_EQ(center_tinted.z(), 0);
}

TEST_F(Pipeline, EachLookOptionChangesThePicture) {
  const Image plain = render("plain", {});
  const std::vector<std::vector<std::string>> changes = {
      {"--material", "ashikhmin"},
      {"--material", "diffuse"},
      {"--alpha-x", "0.1"},
      {"--alpha-y", "0.2"},
      {"--specular", "0.1,0.2,0.3"},
      {"--rotate-env", "90"},
      {"--camera", "3,2,1,0,0.5,0,50"},
      {"--per", "pixel"},
      {"--antialias", "1"},
      {"--visibility", "cap"},
      {"--cosine", "constant"},
      {"--specular-from", "lobes"},
      {"--up", "z"},
      {"--terms", "2"},
  };
  for (const auto& change : changes)
    // Well above the rounding of halves, 5e-4.
    EXPECT_GT(relative_difference(render("changed", change), plain), 2e-3)
        << testing::PrintToString(change);
  EXPECT_EQ(relative_difference(render("exposed", {"--exposure", "3"}), plain), 0);
  // A full turn is none, but for the rounding of the rotation.
  EXPECT_LT(relative_difference(render("turned", {"--rotate-env", "360"}), plain), 1e-2);
}

TEST_F(Pipeline, QualityIsOverriddenByDialsInAnyOrder) {
  const std::vector<std::string> brushed = {"--material", "ward", "--alpha-x", ".3"};
  const auto with = [&](const std::string& name, const std::vector<std::string>& options) {
    return render(name, joined(brushed, options));
  };
  const Image plain = with("plain", {});
  const Image fast = with("fast", {"--quality", "fast"});
  EXPECT_EQ(relative_difference(with("balanced", {"--quality", "balanced"}), plain), 0);
  EXPECT_GT(relative_difference(fast, plain), 2e-3);  // well above the rounding of halves, 5e-4
  EXPECT_GT(relative_difference(with("accurate", {"--quality", "accurate"}), plain), 0);
  EXPECT_EQ(relative_difference(with("set", {"--specular-form", "moments", "--specular-taps", "1",
                                             "--specular-lobes", "1", "--ladder-reach", "8"}),
                                fast),
            0);
  const Image before = with("before", {"--visibility", "cap", "--quality", "fast", "--terms", "2"});
  const Image after = with("after", {"--terms", "2", "--quality", "fast", "--visibility", "cap"});
  EXPECT_EQ(relative_difference(before, after), 0);
  EXPECT_GT(relative_difference(before, fast), 2e-3);
}

TEST_F(Pipeline, BenchmarkTimesFramesAndWritesNoPicture) {
  const std::vector<std::string> before = folder_.names();
  for (const std::string per : {"vertex", "pixel"}) {
    const RunResult result =
        burnish({"render", transfer_, "--env", environment_, "--size", "48x32", "--per", per,
                 "--frames", "7", "--benchmark", "--report", folder_.file("r.json")});
    expect_success(result);
    EXPECT_NE(result.out.find("frames/s"), std::string::npos) << result.out;
    const json figures = json::parse(read_whole_file(folder_.file("r.json")))["benchmark"];
    EXPECT_EQ(figures["frames"], 7);
    EXPECT_EQ(figures["per"], per);
    EXPECT_EQ(figures.contains("trace_ms"), per == "pixel");
    for (const char* part : {"prepare_ms", "shade_ms", "total_ms"}) {
      const json& ms = figures[part];
      EXPECT_GT(ms["min"].get<double>(), 0) << part;
      EXPECT_LE(ms["min"].get<double>(), ms["median"].get<double>()) << part;
      EXPECT_LE(ms["median"].get<double>(), ms["percentile_95"].get<double>()) << part;
    }
    EXPECT_NEAR(figures["fps"].get<double>() * figures["total_ms"]["median"].get<double>(), 1000,
                1e-6);
  }
  std::filesystem::remove(folder_.file("r.json"));
  EXPECT_EQ(folder_.names(), before);
}

TEST_F(Pipeline, BenchmarkRefusesWhatItWouldNotDo) {
  const std::vector<std::vector<std::string>> refused = {
      {"--benchmark", "--png", folder_.file("a.png")},
      {"--benchmark", "-o", folder_.file("a.gif"), "--frames", "3"},
      {"--benchmark", "--reference", "4"}};
  for (const auto& options : refused) {
    const RunResult result = burnish(joined({"render", transfer_, "--env", environment_}, options));
    EXPECT_EQ(result.exit_code, 1) << testing::PrintToString(options);
    EXPECT_TRUE(is_one_clean_line(result.err)) << result.err;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_.file("a.png")));
}

TEST_F(Pipeline, TermsBeyondTheBakedOnesAreRefused) {
  const RunResult result = burnish(
      {"render", transfer_, "--env", environment_, "--terms", "9", "--png", folder_.file("a.png")});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(is_one_clean_line(result.err)) << result.err;
}

TEST_F(Pipeline, ReferenceIsWrittenBesideAndItsErrorReported) {
  const Image baked =
      render("a", {"--material", "diffuse", "--reference", "16", "--png", folder_.file("a.png"),
                   "--compare", folder_.file("both.png"), "--report", folder_.file("r.json")});
  const Image truth = read_image(folder_.file("a.reference.exr"));
  EXPECT_EQ(png_size(folder_.file("a.reference.png")), std::pair(48u, 32u));
  EXPECT_EQ(png_size(folder_.file("both.png")).second, 32u);
  EXPECT_GE(png_size(folder_.file("both.png")).first, 96u);

  const json report = json::parse(read_whole_file(folder_.file("r.json")));
  const double error = report["reference"]["relative_l2"];
  EXPECT_GT(error, 0);
  EXPECT_GT(report["reference"]["truth_noise"].get<double>(), 0);
  EXPECT_EQ(report["reference"]["samples"], 16);
  EXPECT_TRUE(report["machine"].contains("cpu"));
  // Over the whole pictures instead of the covered pixels: the background is the same in both and
  // can only lower the figure; pixels on silhouettes are in it and not in the report's.
  EXPECT_LT(relative_difference(baked, truth), 1.5 * error);
}

TEST_F(Pipeline, ShadeWritesRadianceAndColours) {
  const std::string ply = folder_.file("box.ply");
  const std::vector<std::string> command = {"shade",     transfer_,   "--env",      environment_,
                                            "-o",        ply,         "--material", "diffuse",
                                            "--diffuse", "1,0.5,0.25"};
  expect_success(burnish(command));
  const std::vector<float> red = ply_property(ply, "radiance_r");
  const std::vector<float> green = ply_property(ply, "radiance_g");
  ASSERT_EQ(red.size(), 24u);
  float brightest = 0;
  for (size_t i = 0; i < red.size(); ++i) {
    ASSERT_TRUE(std::isfinite(red[i]) && red[i] >= 0 && std::isfinite(green[i]));
    brightest = std::max(brightest, red[i]);
  }
  EXPECT_GT(brightest, 0);
  EXPECT_EQ(ply_property(ply, "x").front(), -0.5f);
  EXPECT_NE(read_whole_file(ply).find("property uchar red"), std::string::npos);
}

TEST_F(Pipeline, QuietPrintsNothing) {
  expect_success(
      burnish(joined({"bake", folder_.file("box.obj"), "-o", folder_.file("b.h5"), "--quiet"},
                     quick_bake_options())));
  const RunResult result = burnish({"render", transfer_, "--env", environment_, "--size", "24x16",
                                    "-q", "--png", folder_.file("a.png")});
  expect_success(result);
  EXPECT_EQ(result.out, "");
}

TEST_F(Pipeline, AnyNumberOfThreadsGivesTheSameFiles) {
  for (const char* threads : {"1", "2"}) {
    const std::string t = threads;
    const auto file = [&](const char* name) { return folder_.file(t + name); };
    // From stdout too, no word may depend on the threads but the times; so only files are compared.
    expect_success(
        burnish(joined({"bake", folder_.file("box.obj"), "-o", file(".h5"), "--threads", t},
                       quick_bake_options())));
    expect_success(burnish({"fit-light", environment_, "-o", file(".json"), "--threads", t}));
    expect_success(burnish({"render", file(".h5"), "--env", environment_, "--lights", file(".json"),
                            "--size", "48x32", "-o", file(".exr"), "--png", file(".png"),
                            "--reference", "4", "--threads", t}));
    expect_success(burnish({"shade", file(".h5"), "--env", environment_, "--lights", file(".json"),
                            "-o", file(".ply"), "--threads", t}));
  }
  for (const char* name : {".h5", ".json", ".exr", ".png", ".reference.exr", ".ply"})
    EXPECT_TRUE(read_whole_file(folder_.file(fmt::format("1{}", name))) ==
                read_whole_file(folder_.file(fmt::format("2{}", name))))
        << name;
}

TEST_F(Pipeline, BakeReportHoldsTheFigures) {
  const std::string report_path = folder_.file("r.json");
  expect_success(burnish(
      joined({"bake", folder_.file("box.obj"), "-o", folder_.file("b.h5"), "--report", report_path},
             quick_bake_options())));
  const json report = json::parse(read_whole_file(report_path));
  EXPECT_EQ(report["bake"]["vertices"], 24);
  EXPECT_EQ(report["bake"]["file_bytes"], std::filesystem::file_size(folder_.file("b.h5")));
  EXPECT_GT(report["bake"]["rays"].get<double>(), 0);
  EXPECT_GT(report["bake"]["timings"]["total_s"].get<double>(), 0);
  EXPECT_NE(report["machine"]["command_line"].get<std::string>().find("--terms 8"),
            std::string::npos);
}

TEST(Demo, BakesRendersAndComparesTheBuiltInScene) {
  const ScratchFolder folder;
  const RunResult result =
      burnish(joined({"demo", "-o", folder.file("out"), "--scene", "wall", "--size", "48x32",
                      "--reference", "8", "--report", folder.file("r.json")},
                     quick_bake_options()));
  expect_success(result);
  EXPECT_NE(result.out.find("relative L2 error"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("frame time"), std::string::npos) << result.out;
  EXPECT_GE(png_size(folder.file("out/wall.png")).first, 96u);
  const json report = json::parse(read_whole_file(folder.file("r.json")));
  EXPECT_GT(report["frame"]["frame_ms"].get<double>(), 0);
  EXPECT_GT(report["bake"]["file_bytes"].get<double>(), 0);
  // Diffuse, lit by a fit of ten lobes, 64 x 64 directions: far off would be another picture.
  EXPECT_LT(report["reference"]["relative_l2"].get<double>(), 0.5);
}

TEST(ProgressBar, ShowsOnATerminalAndIsErasedAtTheEnd) {
  const ScratchFolder folder;
  // 146 million rays on one thread: more than the 0.3 s before a bar shows on any machine of today.
  write_whole_file(folder.file("sphere.obj"), sphere_obj(12, 24));
  const std::vector<std::string> command = {"bake",     folder.file("sphere.obj"),
                                            "-o",       folder.file("a.h5"),
                                            "--ground", "--directions",
                                            "256",      "--coarsest",
                                            "all",      "--resolution",
                                            "32",       "--terms",
                                            "8",        "--threads",
                                            "1"};
  RunOptions terminal;
  terminal.terminal_stderr = true;
  const RunResult shown = burnish(command, terminal);
  EXPECT_EQ(shown.exit_code, 0);
  EXPECT_NE(shown.err.find("%"), std::string::npos);
  EXPECT_TRUE(shown.err.ends_with("\r\x1b[K")) << shown.err;
  EXPECT_EQ(shown.err.find('\n'), std::string::npos) << shown.err;
  expect_success(burnish(command));  // piped: nothing on stderr
  const RunResult quiet = burnish(joined(command, {"--quiet"}), terminal);
  EXPECT_EQ(quiet.exit_code, 0);
  EXPECT_EQ(quiet.err, "");
}

}  // namespace
}  // namespace burnish::test
