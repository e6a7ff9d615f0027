#include "sample_files.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "burnish/formats/image_file.h"

namespace burnish::test {

std::string box_over_floor_obj() {
  std::string text;
  for (int i = 0; i < 8; ++i)
    text += fmt::format("v {} {} {}\n", i & 1 ? 0.5 : -0.5, i & 2 ? 1.3 : 0.3, i & 4 ? 0.5 : -0.5);
  text += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  for (int z = 0; z < 4; ++z)
    for (int x = 0; x < 4; ++x) text += fmt::format("v {} 0 {}\n", x - 1.5, z - 1.5);
  for (int z = 0; z < 3; ++z)
    for (int x = 0; x < 3; ++x) {
      const int corner = 9 + z * 4 + x;
      text += fmt::format("f {} {} {} {}\n", corner, corner + 4, corner + 5, corner + 1);
    }
  return text;
}

std::string sphere_obj(int rings, int segments) {
  constexpr double pi = std::numbers::pi;
  std::string text = "v 0 1 0\n";
  for (int ring = 1; ring < rings; ++ring)
    for (int segment = 0; segment < segments; ++segment) {
      const double polar = pi * ring / rings, around = 2 * pi * segment / segments;
      text += fmt::format("v {:.7f} {:.7f} {:.7f}\n", std::sin(polar) * std::sin(around),
                          std::cos(polar), std::sin(polar) * std::cos(around));
    }
  text += "v 0 -1 0\n";
  const auto vertex = [&](int ring, int segment) {
    if (ring == 0) return 1;
    if (ring == rings) return 2 + (rings - 1) * segments;
    return 2 + (ring - 1) * segments + segment % segments;
  };
  for (int ring = 0; ring < rings; ++ring)
    for (int segment = 0; segment < segments; ++segment) {
      const int a = vertex(ring, segment), b = vertex(ring + 1, segment);
      const int c = vertex(ring + 1, segment + 1), d = vertex(ring, segment + 1);
      if (ring == 0)
        text += fmt::format("f {} {} {}\n", a, b, c);
      else if (ring == rings - 1)
        text += fmt::format("f {} {} {}\n", a, b, d);
      else
        text += fmt::format("f {} {} {} {}\n", a, b, c, d);
    }
  return text;
}

void write_small_environment(const std::string& path) {
  Image image(64, 32, Rgb(0.2f, 0.25f, 0.3f));
  for (int y = 8; y < 12; ++y)
    for (int x = 40; x < 46; ++x) image.at(x, y) = Rgb(20, 18, 15);
  write_exr(image, path, ExrPixelType::single_float, true);
}

RunResult burnish(const std::vector<std::string>& arguments, const RunOptions& options) {
  return run_program(BURNISH_PROGRAM, arguments, options);
}

RunResult burnish_bench(const std::vector<std::string>& arguments, const RunOptions& options) {
  return run_program(BURNISH_BENCH_PROGRAM, arguments, options);
}

std::vector<std::string> quick_bake_options() {
  return {"--directions", "64", "--resolution", "32", "--terms", "8"};
}

std::vector<std::string> joined(std::vector<std::string> first,
                                const std::vector<std::string>& rest) {
  first.insert(first.end(), rest.begin(), rest.end());
  return first;
}

RunResult make_quick_bake(const ScratchFolder& folder) {
  write_whole_file(folder.file("box.obj"), box_over_floor_obj());
  write_small_environment(folder.file("env.exr"));
  return burnish(
      joined({"bake", folder.file("box.obj"), "-o", folder.file("box.h5")}, quick_bake_options()));
}

bool is_one_clean_line(const std::string& text) {
  if (text.empty() || text.back() != '\n') return false;
  return std::none_of(text.begin(), text.end() - 1,
                      [](unsigned char c) { return c < 0x20 || c == 0x7f; });
}

}  // namespace burnish::test
