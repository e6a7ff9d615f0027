#pragma once

#include <string>

#include "burnish/formats/measured_brdf.h"
#include "burnish/material/material.h"
#include "burnish/precompute/progress.h"

namespace burnish {

/// Dials of a fit to a measured BRDF.
struct BrdfFitOptions {
  int lobes = 3;         ///< of the distribution, at most: 1..kMaxFittedLobes
  int resolution = 256;  ///< edge of the table of half vectors that lobes are fitted to, 32..512
  /// Directions further from the normal do not count, 0.1..pi / 2. Measurements at grazing angles
  /// are extrapolated for the most part.
  double max_angle_rad = 80 * kPi<double> / 180;
  std::string subject = "measured BRDF";  ///< stands for the data in errors
};

/// How far a material is from a measurement, over pairs of directions. All pairs up to the
/// options' and the data's greatest angle, evenly over both hemispheres (d outgoing d incoming); of
/// irregular data, the samples themselves, all alike. The three channels count together.
struct BrdfError {
  double relative_l2 = 0;  ///< of f cos(incoming)
  double cube_root = 0;    ///< relative L2 of its cube root, which sees the tails, too
};

/// What fit_brdf found.
struct BrdfFit {
  Material material;  ///< `fitted`
  BrdfError error;
  int rounds = 0;  ///< of alternation between lobes and smooth factor
};

/// Fits f = diffuse / pi + D(h) F(h.o) S(o.z) S(i.z) to a measurement (xu2013asg, section 5.2): D a
/// mixture of lobes of free frames, F and S in tables, all by least squares of f cos(incoming).
/// Isotropic data get round lobes about the normal, irregular data none that would fall between its
/// samples. Lobes that gain nothing are left out; if all do, the material is diffuse, with a lobe
/// of amplitude 0. Diffuse keeps to 1 in the fit. Same input, same bytes, at any number of threads.
///
/// Throws Error for options out of range, for data without a pair within max_angle_rad or without a
/// value above 0, and for values that no material can have; Cancelled when
/// `progress` (stage "fit BRDF", in rounds) asked to stop.
BrdfFit fit_brdf(const MeasuredBrdf& measured, const BrdfFitOptions& options = {},
                 const Progress& progress = {});

/// The material of `model` (ward or ashikhmin_shirley, with a diffuse part) that is closest in the
/// same sense: alpha_x, alpha_y, diffuse, specular and, of ashikhmin_shirley, normal_reflectance.
/// Its tangent is the measurement's x axis. `options.lobes` is not used. Diffuse keeps to 1 in the
/// fit, specular to kMaxSpecular. Throws Error as fit_brdf does.
Material fit_parametric_brdf(const MeasuredBrdf& measured, SpecularModel model,
                             const BrdfFitOptions& options = {});

/// The error of any material, at pairs of directions other than those of a fit (of irregular data,
/// at the samples).
BrdfError measure_brdf_fit(const MeasuredBrdf& measured, const Material& material,
                           const BrdfFitOptions& options = {});

/// The least relative_l2 of any reciprocal material: what remains where the measurement itself
/// changes as outgoing and incoming are exchanged. 0 for irregular data, where it is unknown.
double reciprocity_bound(const MeasuredBrdf& measured, const BrdfFitOptions& options = {});

}  // namespace burnish
