#include "burnish/shading/shading_options.h"

namespace burnish {

ShadingOptions shading_options(Quality quality) {
  ShadingOptions options;
  switch (quality) {
    case Quality::fast:
      options.specular = {SpecularForm::moments, 1, 1};
      break;
    case Quality::balanced:
      break;
    case Quality::accurate:
      options.specular = {SpecularForm::moments, kMaxTaps, kTailLobes};
      options.environment_taps = 15;
      options.ladder_reach = 2;
      break;
  }
  return options;
}

}  // namespace burnish
