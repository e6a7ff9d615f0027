#include "tradeoff/trade_pictures.h"

#include <algorithm>
#include <cmath>

#include "harness/error_metrics.h"
#include "harness/tone_map.h"

namespace burnish::tools {
namespace {

/// The inverse of the sRGB transfer function: write_png will apply it to what is encoded already.
Image decoded(Image image) {
  for (Rgb& pixel : image.pixels)
    for (int c = 0; c < 3; ++c) {
      const float encoded = pixel[c];
      pixel[c] =
          encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
    }
  return image;
}

}  // namespace

std::vector<size_t> rows_to_show(const Sweep& sweep, const Trade& time) {
  std::vector<size_t> rows;
  const auto add = [&](size_t row) {
    if (std::find(rows.begin(), rows.end(), row) == rows.end()) rows.push_back(row);
  };
  for (size_t i = 0; i < sweep.rows.size(); ++i) {
    const SweepRow& row = sweep.rows[i];
    if (row.kind == RowKind::preset || row.kind == RowKind::paper || row.name == "bases 1") add(i);
  }
  if (!time.front.empty()) {
    add(time.front.front());
    add(time.front.back());
  }
  return rows;
}

TradePicture trade_picture(Trial& trial, const Settings& settings,
                           const TradePictureOptions& options) {
  const View view = {trial.scene().scene.camera, options.width, options.height, 2};
  const Picture shaded = trial.render(settings, view);
  const Picture truth = trial.render_truth(view, options.truth);
  const float exposure = exposure_of(truth);
  const FlipError flip = flip_error(shaded, truth);
  TradePicture result;
  result.picture = side_by_side(std::vector<Image>{decoded(tone_map(shaded.radiance, exposure)),
                                                   decoded(tone_map(truth.radiance, exposure)),
                                                   decoded(flip.map)});
  result.flip = flip.mean;
  result.relative_l2 = relative_l2(shaded, truth).without_noise;
  result.psnr_db = psnr_db(shaded, truth);
  return result;
}

}  // namespace burnish::tools
