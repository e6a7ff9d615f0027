#pragma once

#include <string>
#include <vector>

#include "subprocess.h"

/// Small inputs that the tests of the programs share.
namespace burnish::test {

/// A box of 8 vertices over a floor of 16, as OBJ: 12 + 18 triangles, 2 components, no normals.
std::string box_over_floor_obj();

/// A closed sphere of rings x segments quads (triangles at the poles), as OBJ.
std::string sphere_obj(int rings, int segments);

/// A 64 x 32 environment with a bright patch, as an OpenEXR file.
void write_small_environment(const std::string& path);

/// The programs under test.
/// @{
RunResult burnish(const std::vector<std::string>& arguments, const RunOptions& options = {});
RunResult burnish_bench(const std::vector<std::string>& arguments, const RunOptions& options = {});
/// @}

/// Options of a bake that takes a moment.
std::vector<std::string> quick_bake_options();

/// `first` and then `rest`.
std::vector<std::string> joined(std::vector<std::string> first,
                                const std::vector<std::string>& rest);

/// In a folder: box.obj, env.exr and box.h5 baked from it. Returns how the bake ended.
RunResult make_quick_bake(const ScratchFolder& folder);

/// Whether a text is exactly one line, without control characters but its end.
bool is_one_clean_line(const std::string& text);

}  // namespace burnish::test
