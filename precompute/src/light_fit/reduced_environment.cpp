#include "light_fit/reduced_environment.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include <tbb/parallel_for.h>

#include "light_fit/environment_cells.h"

namespace burnish {

ReducedEnvironment reduce_environment(const Image& environment, int max_width) {
  const int width = std::min(environment.width, max_width);
  const int height = std::min(environment.height, max_width / 2);
  ReducedEnvironment reduced;
  if (width == environment.width && height == environment.height) {
    reduced.image = environment;
    return reduced;
  }
  reduced.image = Image(width, height);
  std::vector<double> spread(height, 0.0);  // summed in order: the same bytes at any thread count
  const double columns = double(environment.width) / width;
  const double rows = double(environment.height) / height;
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const EnvironmentCell cell =
          make_cell(environment, x * columns, (x + 1) * columns, y * rows, (y + 1) * rows);
      reduced.image.at(x, y) = cell.radiance.cast<float>();
      spread[y] += cell.spread;
    }
  });
  reduced.spread = std::accumulate(spread.begin(), spread.end(), 0.0);
  return reduced;
}

}  // namespace burnish
