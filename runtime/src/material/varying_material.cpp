#include "burnish/material/varying_material.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace burnish {
namespace {

// Beyond, a normal lies in its surface as far as shading can tell, and squares of slopes would
// drown all others of a mean.
constexpr float kMaxSlope = 10;

/// What the maps give, summed over taps.
struct MapValues {
  Rgb diffuse = Rgb::Zero(), specular = Rgb::Zero();
  Rgb slope = Rgb::Zero();    ///< x, y
  Rgb moments = Rgb::Zero();  ///< xx, xy, yy

  void add(const MaterialMaps& maps, const TexturePlace& at, float weight) {
    if (maps.diffuse) diffuse += weight * eval_texture(*maps.diffuse, at.uv, at.width);
    if (maps.specular) specular += weight * eval_texture(*maps.specular, at.uv, at.width);
    if (maps.slope)
      slope += weight * eval_texture(*maps.slope, at.uv, at.width) * Rgb(at.u_sign, at.v_sign, 1);
    if (maps.moments)
      moments +=
          weight * eval_texture(*maps.moments, at.uv, at.width) * Rgb(1, at.u_sign * at.v_sign, 1);
  }
  Vector3f normal() const { return Vector3f(slope.x(), slope.y(), 1).normalized(); }
};

/// An anisotropic roughness and its axis.
struct Roughness {
  float alpha_x = 0, alpha_y = 0;
  float rotation_rad = 0;  ///< -pi/4..pi/4: the axis next to the tangent is x
};

float alpha_of_variance(float variance) {
  return std::clamp(std::sqrt(2 * std::max(variance, 0.0f)), kMinAlpha, kMaxAlpha);
}

/// From the covariance of slopes, of which alpha^2 / 2 are the eigenvalues.
Roughness roughness_of(const MapValues& values) {
  const float xx = values.moments[0] - values.slope[0] * values.slope[0];
  const float xy = values.moments[1] - values.slope[0] * values.slope[1];
  const float yy = values.moments[2] - values.slope[1] * values.slope[1];
  const float mean = (xx + yy) / 2, half = (xx - yy) / 2;
  float radius = std::hypot(half, xy);
  // Round as far as floats can tell: no axis.
  if (!(radius > 1e-6f * mean)) return {alpha_of_variance(mean), alpha_of_variance(mean), 0};
  float rotation = std::atan2(xy, half) / 2;
  if (std::abs(rotation) > kPi<float> / 4) {
    rotation -= std::copysign(kPi<float> / 2, rotation);
    radius = -radius;
  }
  return {alpha_of_variance(mean + radius), alpha_of_variance(mean - radius), rotation};
}

/// x turned about the normal, and the normal tilted.
Frame<float> turned_frame(const Frame<float>& frame, const Vector3f& normal, float rotation_rad) {
  const Vector3f tangent = std::cos(rotation_rad) * frame.x + std::sin(rotation_rad) * frame.y;
  return frame_from_normal_tangent<float>(frame.to_world(normal).normalized(), tangent);
}

template <class T>
std::string size_error(const char* field, std::span<const T> values, std::size_t vertices) {
  if (values.empty() || values.size() == vertices) return {};
  return std::string(field) + " has " + std::to_string(values.size()) +
         " values, expected none or " + std::to_string(vertices);
}

template <class T, class Bad>
std::string value_error(const char* field, std::span<const T> values, const char* expected,
                        const Bad& is_good) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!is_good(values[i]))
      return std::string(field) + "[" + std::to_string(i) + "] is out of range, expected " +
             expected;
  return {};
}

const char* const kAlphaRange = "0.0001 to 1";
bool is_alpha(float alpha) { return alpha >= kMinAlpha && alpha <= kMaxAlpha; }

/// The first channel of a picture, where there is one, at the places of another's pixels.
class ScalarPicture {
 public:
  ScalarPicture(const std::optional<Image>& picture, float otherwise, TextureWrap wrap)
      : otherwise_(otherwise) {
    if (picture) texture_ = Texture{{*picture}, wrap};
  }
  float at(const Vector2<float>& uv) const {
    return texture_ ? eval_texture(*texture_, uv, 0)[0] : otherwise_;
  }

 private:
  std::optional<Texture> texture_;
  float otherwise_;
};

/// Of a normal of any length > 0; none points below the surface.
Vector2<float> slope_of(const Vector3f& normal) {
  const float z = std::max(normal.z(), normal.norm() / kMaxSlope);
  if (!(z > 0)) return {0, 0};
  const Vector2<float> slope = normal.head<2>() / z;
  const float length = slope.norm();
  return length > kMaxSlope ? Vector2<float>(slope * (kMaxSlope / length)) : slope;
}

/// R diag(alpha_x^2, alpha_y^2) / 2 R^T + slope slope^T, as xx, xy, yy.
Rgb moments_of(float alpha_x, float alpha_y, float rotation_rad, const Vector2<float>& slope) {
  const float c = std::cos(rotation_rad), s = std::sin(rotation_rad);
  const float x = alpha_x * alpha_x / 2, y = alpha_y * alpha_y / 2;
  return {c * c * x + s * s * y + slope.x() * slope.x(), c * s * (x - y) + slope.x() * slope.y(),
          s * s * x + c * c * y + slope.y() * slope.y()};
}

Image clamped(Image picture, float high) {
  for (Rgb& pixel : picture.pixels) pixel = pixel.max(0.0f).min(high);
  return picture;
}

/// The pixels' places in the pictures.
template <class Set>
void for_each_pixel(int width, int height, const Set& set) {
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      set(x, y,
          Vector2<float>((float(x) + 0.5f) / float(width), 1 - (float(y) + 0.5f) / float(height)));
}

void add_slope_maps(const Material& base, const MaterialPictures& pictures, TextureWrap wrap,
                    MaterialMaps& maps) {
  int width = 0, height = 0;
  for (const auto* picture :
       {&pictures.alpha_x, &pictures.alpha_y, &pictures.tangent_rotation_rad, &pictures.normal})
    if (*picture) {
      width = std::max(width, (*picture)->width);
      height = std::max(height, (*picture)->height);
    }
  if (width == 0) return;
  const ScalarPicture alpha_x(pictures.alpha_x, base.alpha_x, wrap);
  const ScalarPicture alpha_y(pictures.alpha_y, base.alpha_y, wrap);
  const ScalarPicture rotation(pictures.tangent_rotation_rad, 0, wrap);
  std::optional<Texture> normal;
  if (pictures.normal) normal = Texture{{*pictures.normal}, wrap};
  Image slopes(width, height), moments(width, height);
  for_each_pixel(width, height, [&](int x, int y, const Vector2<float>& uv) {
    Vector2<float> slope = Vector2<float>::Zero();
    if (normal) slope = slope_of(eval_texture(*normal, uv, 0).matrix());
    slopes.at(x, y) = {slope.x(), slope.y(), 0};
    moments.at(x, y) =
        moments_of(std::clamp(alpha_x.at(uv), kMinAlpha, kMaxAlpha),
                   std::clamp(alpha_y.at(uv), kMinAlpha, kMaxAlpha), rotation.at(uv), slope);
  });
  if (normal) maps.slope = make_texture(std::move(slopes), wrap);
  maps.moments = make_texture(std::move(moments), wrap);
}

}  // namespace

std::string domain_error(const MaterialVariation& variation, std::size_t vertices) {
  const auto is_color = [](float high) {
    return [high](const Rgb& color) { return (color >= 0).all() && (color <= high).all(); };
  };
  for (const std::string& error :
       {size_error("diffuse", variation.diffuse, vertices),
        size_error("specular", variation.specular, vertices),
        size_error("alpha_x", variation.alpha_x, vertices),
        size_error("alpha_y", variation.alpha_y, vertices),
        size_error("tangent_rotation_rad", variation.tangent_rotation_rad, vertices),
        size_error("normal", variation.normal, vertices),
        value_error("diffuse", variation.diffuse, "0 to 1", is_color(1)),
        value_error("specular", variation.specular, "0 to 1e6", is_color(kMaxSpecular)),
        value_error("alpha_x", variation.alpha_x, kAlphaRange, is_alpha),
        value_error("alpha_y", variation.alpha_y, kAlphaRange, is_alpha),
        value_error("tangent_rotation_rad", variation.tangent_rotation_rad, "a finite number",
                    [](float angle) { return std::isfinite(angle); }),
        value_error("normal", variation.normal, "a unit vector with z > 0",
                    [](const Vector3f& normal) {
                      return normal.z() > 0 && std::abs(normal.norm() - 1) <= 1e-3f;
                    })})
    if (!error.empty()) return error;
  return {};
}

SurfaceMaterial material_at(const Material& base, const MaterialVariation& variation,
                            std::size_t vertex, const Frame<float>& frame) noexcept {
  SurfaceMaterial at = {base, frame};
  if (!variation.diffuse.empty()) at.material.diffuse = variation.diffuse[vertex];
  if (!variation.specular.empty()) at.material.specular = variation.specular[vertex];
  if (!variation.alpha_x.empty()) at.material.alpha_x = variation.alpha_x[vertex];
  if (!variation.alpha_y.empty()) at.material.alpha_y = variation.alpha_y[vertex];
  const bool rotates = !variation.tangent_rotation_rad.empty();
  if (rotates || !variation.normal.empty())
    at.frame =
        turned_frame(frame, variation.normal.empty() ? Vector3f::UnitZ() : variation.normal[vertex],
                     rotates ? variation.tangent_rotation_rad[vertex] : 0.0f);
  return at;
}

MaterialMaps make_material_maps(const Material& base, const MaterialPictures& pictures,
                                TextureWrap wrap) {
  MaterialMaps maps;
  if (pictures.diffuse) maps.diffuse = make_texture(clamped(*pictures.diffuse, 1), wrap);
  if (pictures.specular)
    maps.specular = make_texture(clamped(*pictures.specular, kMaxSpecular), wrap);
  add_slope_maps(base, pictures, wrap, maps);
  return maps;
}

MaterialVariation variation_of(const MaterialArrays& arrays) {
  return {
      arrays.diffuse, arrays.specular, arrays.alpha_x, arrays.alpha_y, arrays.tangent_rotation_rad,
      arrays.normal};
}

void resize(MaterialArrays& arrays, const MaterialMaps& maps, std::size_t vertices) {
  const auto count = [vertices](const auto& map) { return map ? vertices : 0; };
  arrays.diffuse.resize(count(maps.diffuse));
  arrays.specular.resize(count(maps.specular));
  arrays.alpha_x.resize(count(maps.moments));
  arrays.alpha_y.resize(count(maps.moments));
  arrays.tangent_rotation_rad.resize(count(maps.moments));
  arrays.normal.resize(count(maps.slope));
}

void sample_vertices(const MaterialMaps& maps, const VertexTaps& taps, std::size_t first,
                     std::size_t last, MaterialArrays& arrays) noexcept {
  for (std::size_t v = first; v < last; ++v) {
    MapValues values;
    for (std::uint32_t i = taps.first[v]; i < taps.first[v + 1]; ++i)
      values.add(maps, taps.taps[i].place, taps.taps[i].weight);
    if (maps.diffuse) arrays.diffuse[v] = values.diffuse;
    if (maps.specular) arrays.specular[v] = values.specular;
    if (maps.slope) arrays.normal[v] = values.normal();
    if (!maps.moments) continue;
    const Roughness roughness = roughness_of(values);
    arrays.alpha_x[v] = roughness.alpha_x;
    arrays.alpha_y[v] = roughness.alpha_y;
    arrays.tangent_rotation_rad[v] = roughness.rotation_rad;
  }
}

SurfaceMaterial material_at(const Material& base, const MaterialMaps& maps,
                            const TexturePlace& place, const Frame<float>& frame) noexcept {
  MapValues values;
  values.add(maps, place, 1);
  SurfaceMaterial at = {base, frame};
  if (maps.diffuse) at.material.diffuse = values.diffuse;
  if (maps.specular) at.material.specular = values.specular;
  if (!maps.moments) return at;
  const Roughness roughness = roughness_of(values);
  at.material.alpha_x = roughness.alpha_x;
  at.material.alpha_y = roughness.alpha_y;
  at.frame = turned_frame(frame, values.normal(), roughness.rotation_rad);
  return at;
}

}  // namespace burnish
