#include "bench/reproduce/figure.h"

namespace burnish::tools {

std::span<const Figure> all_figures() {
  // A figure is listed here once its group makes it.
  static const std::vector<Figure> figures = {
      {"fig1", "Xu 2013, Figure 1: one ASG against 1 to 15 SGs",
       "renders a metal dish of Ashikhmin's model with anisotropy 10:1 under a map and two local "
       "lights: one ASG has an L2 error of 0.10 % at 125 frames per second; more than ten SGs are "
       "needed for a similar quality, at 19 (13 SGs) and 17 (15 SGs) frames per second.",
       make_lobe_count_figure},
      {"fig8", "Xu 2013, Figure 8: Ashikhmin's model by one ASG and by SGs",
       "shows three pairs of exponents: 5 SGs are enough at anisotropy 3, 19 SGs still differ "
       "visibly at anisotropy 10, and one ASG cannot be told from the path-traced picture.",
       make_ashikhmin_figure},
      {"fig11", "Xu 2013, Figure 11: visibility compressed to 16, 32 and 48 terms",
       "shows a brushed teapot and cylinder on a diffuse and on a brushed plane: without "
       "compression the picture differs subtly from the reference, and 48 terms are a good "
       "trade-off.",
       make_visibility_figure},
      {"fig12", "Xu 2013, Figure 12: a dish and balls",
       "shows highlights of Ward's model on balls and a dish of several anisotropies and frames, "
       "one ASG each.",
       make_dish_balls_figure},
      {"table1", "Xu 2013, Table 1: frames per second",
       "gives 83 to 278 frames per second for eight scenes of 6k to 54k vertices, 720 x 480 pixels "
       "on a GeForce GTX 680.",
       make_frame_rate_table},
  };
  return figures;
}

}  // namespace burnish::tools
