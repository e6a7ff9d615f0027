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
      {"fig3", "Xu 2013, Figure 3: integral of an ASG",
       "plots the integral and its two approximations over the bandwidths; to the eye they agree. "
       "The text bounds the relative error: for bandwidths above 5, 0.027 % (Eq. 10) and 0.68 % "
       "(Eq. 11); above 1, 5.2 % (Eq. 10).",
       make_integral_figure},
      {"fig4", "Xu 2013, Figures 4 and 5 (left): product of two ASGs",
       "shows three pairs of lobes, their true product and Eq. 13, which look identical, and plots "
       "the L2 error over the cosine between the axes, both lobes having integral one. The text "
       "calls the error small for all three and prints no number.",
       make_product_figure},
      {"fig6", "Xu 2013, Figures 5 (right) and 6: convolution of an ASG with an SG",
       "shows three lobes and kernels, their true convolution and Eq. 18, which look identical, "
       "and "
       "plots the L2 error over the kernel's bandwidth nu, both inputs having integral one. The "
       "text bounds the error for any kernel: 0.2 % for bandwidths of the ASG above 3, 2.8 % above "
       "1.",
       make_convolution_figure},
      {"fig7", "Xu 2013, Figure 7: environments fitted by ASGs and by SGs",
       "fits St. Peter's Basilica and Grace Cathedral by a mixture of ASGs and by one of SGs. Only "
       "the ASGs follow the long shapes. The text prints neither errors nor the number of lobes; a "
       "fit takes 23 to 51 seconds.",
       make_light_fit_figure},
      {"fig8", "Xu 2013, Figure 8: Ashikhmin's model by one ASG and by SGs",
       "shows three pairs of exponents: 5 SGs are enough at anisotropy 3, 19 SGs still differ "
       "visibly at anisotropy 10, and one ASG cannot be told from the path-traced picture.",
       make_ashikhmin_figure},
      {"fig9", "Xu 2013, Figures 9 and 13: measured BRDFs",
       "fits two measured BRDFs, brushed aluminium and purple satin, by three or four ASGs and by "
       "the best Ashikhmin and Ward materials. The pictures carry L2 errors, which the text at "
       "hand "
       "lacks. The parametric models come close on the aluminium and fail on the satin, whose "
       "highlight is off-specular; ASGs do well on both. Figure 13 has scenes with such materials, "
       "an aluminium of 10:1 by a single ASG. A fit of one to three ASGs takes 0.9 to 3 seconds.",
       make_measured_figure},
      {"fig10", "Xu 2013, Figure 10: spherical warp",
       "draws a lobe over half vectors, the frame at the reflected direction and the ASG that "
       "stands for the warped lobe, found by second derivatives at its peak (Eq. 23-26). It prints "
       "no error; the evaluation is in a supplement that is not at hand.",
       make_warp_figure},
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
