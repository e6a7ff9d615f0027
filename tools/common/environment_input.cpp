#include "common/environment_input.h"

#include <fmt/format.h>

#include "burnish/formats/image_file.h"
#include "common/interrupt.h"
#include "harness/studio_environment.h"

namespace burnish::tools {

Image load_environment(const std::string& name, Work& work) {
  if (name == kStudioName) return studio_environment();
  EnvironmentReport report;
  Image image = read_environment(name, &report);
  throw_if_interrupted();
  for (const std::string& note : report.image.notes) work.print(fmt::format("{}: {}", name, note));
  const ImageReport& image_report = report.image;
  if (image_report.nan_values > 0 || image_report.infinite_values > 0)
    work.print(fmt::format("{}: {} values that are not numbers became 0, {} that are infinite {:g}",
                           name, image_report.nan_values, image_report.infinite_values,
                           report.infinity_replacement));
  return image;
}

}  // namespace burnish::tools
