#include "burnish/shading/shading_options.h"

namespace burnish {

ShadingOptions shading_options(Quality quality) {
  ShadingOptions options;
  switch (quality) {
    case Quality::fast:
      options.specular = {SpecularForm::moments, 1, 1};
      options.environment_taps = 3;
      options.ladder_reach = 8;
      break;
    case Quality::balanced:
      break;
    case Quality::accurate:
      options.specular = {SpecularForm::moments, kMaxTaps, kTailLobes};
      options.environment_taps = 32;
      options.ladder_reach = 1;
      break;
  }
  return options;
}

}  // namespace burnish
