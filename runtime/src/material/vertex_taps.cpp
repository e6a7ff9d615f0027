#include <cmath>
#include <stdexcept>

#include "burnish/material/varying_material.h"

namespace burnish {
namespace {

double surface_area(const Transfer& transfer, const Triangle& t) {
  const Vector3d a = transfer.positions[t[0]].cast<double>();
  return (transfer.positions[t[1]].cast<double>() - a)
             .cross(transfer.positions[t[2]].cast<double>() - a)
             .norm() /
         2;
}

double uv_area(const Transfer& transfer, const Triangle& t) {
  const Vector2<double> a = transfer.texcoords[t[0]].cast<double>();
  const Vector2<double> b = transfer.texcoords[t[1]].cast<double>() - a;
  const Vector2<double> c = transfer.texcoords[t[2]].cast<double>() - a;
  return std::abs(b.x() * c.y() - b.y() * c.x()) / 2;
}

/// The tap of a triangle's third that is next to its corner `i`.
TextureTap corner_tap(const Transfer& transfer, const Triangle& t, size_t i) {
  // The centroid of where a corner's barycentric coordinate is the largest.
  constexpr float kOwn = 11.0f / 18, kOther = 7.0f / 36;
  TextureTap tap;
  tap.place.uv = kOwn * transfer.texcoords[t[i]] +
                 kOther * (transfer.texcoords[t[(i + 1) % 3]] + transfer.texcoords[t[(i + 2) % 3]]);
  tap.place.width = static_cast<float>(std::sqrt(uv_area(transfer, t) / 3));
  const TextureSigns signs = texture_signs(
      transfer, t, frame_from_normal_tangent(transfer.normals[t[i]], transfer.tangents[t[i]]));
  tap.place.u_sign = signs.u;
  tap.place.v_sign = signs.v;
  tap.weight = static_cast<float>(surface_area(transfer, t));
  return tap;
}

}  // namespace

TextureSigns texture_signs(const Transfer& transfer, const Triangle& t,
                           const Frame<float>& frame) noexcept {
  const Vector3f a = transfer.positions[t[0]];
  const Vector3f to_b = transfer.positions[t[1]] - a, to_c = transfer.positions[t[2]] - a;
  const Vector2<float> uv = transfer.texcoords[t[0]];
  const Vector2<float> b = transfer.texcoords[t[1]] - uv, c = transfer.texcoords[t[2]] - uv;
  const float turn = b.x() * c.y() - b.y() * c.x() < 0 ? -1.0f : 1.0f;
  const Vector3f along_u = turn * (c.y() * to_b - b.y() * to_c);
  const Vector3f along_v = turn * (b.x() * to_c - c.x() * to_b);
  return {along_u.dot(frame.x) < 0 ? -1.0f : 1.0f, along_v.dot(frame.y) < 0 ? -1.0f : 1.0f};
}

VertexTaps vertex_taps(const Transfer& transfer) {
  const size_t vertices = transfer.vertex_count();
  if (transfer.texcoords.size() != vertices)
    throw std::invalid_argument("the transfer has no texture coordinates");
  std::vector<double> area(vertices, 0);
  VertexTaps taps;
  taps.first.assign(vertices + 1, 0);
  for (const Triangle& t : transfer.triangles)
    for (const std::uint32_t v : t) {
      area[v] += surface_area(transfer, t);
      ++taps.first[v + 1];
    }
  // A vertex without triangles, or with flat ones only, has one tap, at itself.
  for (size_t v = 0; v < vertices; ++v) {
    if (!(area[v] > 0)) taps.first[v + 1] = 1;
    taps.first[v + 1] += taps.first[v];
  }
  taps.taps.resize(taps.first.back());
  std::vector<std::uint32_t> next(taps.first.begin(), taps.first.end() - 1);
  for (size_t v = 0; v < vertices; ++v)
    if (!(area[v] > 0)) taps.taps[next[v]] = {{transfer.texcoords[v]}, 1};
  for (const Triangle& t : transfer.triangles)
    for (size_t i = 0; i < 3; ++i) {
      if (!(area[t[i]] > 0)) continue;
      TextureTap& tap = taps.taps[next[t[i]]++];
      tap = corner_tap(transfer, t, i);
      tap.weight = static_cast<float>(double(tap.weight) / area[t[i]]);
    }
  return taps;
}

}  // namespace burnish
