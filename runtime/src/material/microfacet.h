#pragma once

#include "material/half_vector.h"

/// Based on: walter2007, heitz2014, dupuy2023. Distributions of microfacet normals and what they
/// hide of each other.
namespace burnish::internal {

struct Microfacets {
  Distribution distribution = Distribution::ggx;
  float alpha_x = 1, alpha_y = 1;  ///< equal for blinn_phong
};

/// Of cook_torrance; of ward_balanced, Beckmann's.
Microfacets microfacets_of(const Material& material);

/// D at the normal: 1 / (pi alpha_x alpha_y) for all three.
float microfacet_peak(const Microfacets& facets);
/// D(h) over D at the normal, h.z > 0. Beckmann's rises off the axis for alpha > 1 / sqrt(2).
float eval_microfacet_lobe(const Microfacets& facets, const Vector3f& half);

/// cos(theta) / G1: the area of the microfacets that face a direction, projected to it. Never
/// below the cosine, above zero at the horizon. heitz2014, section 4; for Blinn-Phong
/// walter2007's substitution, which is Beckmann's of the same alpha.
float facing_area(const Microfacets& facets, const Vector3f& direction);

/// G(i, o) / (4 i.z o.z), for directions above the horizon.
float shadowing_over_cosines(const Microfacets& facets, Shadowing shadowing,
                             const Vector3f& outgoing, const Vector3f& incoming,
                             const HalfVector& half);

/// A half vector: by D(h) h.z, or for GGX, where it is as simple, by what the view sees of D
/// (dupuy2023), which leaves a weight of F G / G1.
Vector3f sample_microfacet_half(const Microfacets& facets, const Vector3f& outgoing, float u,
                                float v);
/// Density of the reflected direction, per sr.
float pdf_microfacet_reflection(const Microfacets& facets, const Vector3f& outgoing,
                                const HalfVector& half);

}  // namespace burnish::internal
