#include "harness/parallel_prefilter.h"

#include <tbb/parallel_for.h>

namespace burnish {

PrefilteredEnvironment prefilter_in_parallel(const Image& environment) {
  PrefilterOptions options;
  options.parallel_for = [](int count, const std::function<void(int)>& body) {
    tbb::parallel_for(0, count, body);
  };
  return prefilter_environment(environment, options);
}

}  // namespace burnish
