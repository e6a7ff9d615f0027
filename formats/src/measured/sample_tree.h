#pragma once

#include <vector>

#include "burnish/formats/measured_brdf.h"

namespace burnish::detail {

/// Irregular samples of a BRDF, between which values are interpolated.
class SampleTree {
 public:
  /// One sample or more.
  explicit SampleTree(const std::vector<BrdfSample>& samples);
  /// Mean of the eight nearest samples by their inverse squared distances; a sample itself at its
  /// own directions, and at the same ones exchanged (reciprocity).
  Rgb eval(const Vector3d& outgoing, const Vector3d& incoming) const;

 private:
  using Place = Eigen::Vector4f;
  struct Node {
    Place place;
    Rgb value;
  };
  struct Nearest;
  void split(std::size_t begin, std::size_t end, int axis);
  void search(std::size_t begin, std::size_t end, int axis, const Place& at,
              Nearest& nearest) const;
  static Place place_of(const Vector3d& outgoing, const Vector3d& incoming);

  std::vector<Node> nodes_;  ///< a k-d tree: the middle of a range divides it
};

}  // namespace burnish::detail
