#include <fmt/format.h>

#include "burnish/formats/light_file.h"
#include "burnish/formats/output_file.h"
#include "light_format.h"

namespace burnish {
namespace {

std::string format_lobe(const EnvironmentLobe& light) {
  const AnisotropicGaussian<float>& lobe = light.lobe;
  return fmt::format(
      "{{\"axis\": {}, \"tangent\": {}, \"bandwidth_x\": {}, \"bandwidth_y\": {}, "
      "\"color\": {}}}",
      format_vector(lobe.frame.z), format_vector(lobe.frame.x), lobe.bandwidth_x, lobe.bandwidth_y,
      format_vector(light.color * lobe.amplitude));
}

std::string format_sphere(const SphereLight& light) {
  return fmt::format("{{\"center\": {}, \"radius\": {}, \"radiance\": {}}}",
                     format_vector(light.center), light.radius, format_vector(light.radiance));
}

std::string format_directional(const DirectionalLight& light) {
  return fmt::format("{{\"toward\": {}, \"angular_radius_rad\": {}, \"irradiance\": {}}}",
                     format_vector(light.toward), light.angular_radius_rad,
                     format_vector(light.irradiance));
}

std::string format_rectangle(const RectangleLight& light) {
  return fmt::format(
      "{{\"center\": {}, \"edge_x\": {}, \"edge_y\": {}, \"two_sided\": {}, \"radiance\": {}}}",
      format_vector(light.center), format_vector(light.edge_x), format_vector(light.edge_y),
      light.two_sided, format_vector(light.radiance));
}

}  // namespace

std::string format_lights(const LightFile& lights, const std::string& subject) {
  const Eigen::Matrix3f& rotation = lights.world_from_environment;
  std::string text = "{\n";
  text += fmt::format("  \"format\": \"{}\",\n", kLightFormat.name);
  text += fmt::format("  \"format_version\": {},\n", kLightFormatVersion);
  text += fmt::format("  \"name\": {},\n", json_string(lights.name));
  text += fmt::format("  \"source\": {},\n", json_string(lights.source));
  if (lights.fit_relative_l2)
    text += fmt::format("  \"fit_relative_l2\": {},\n", *lights.fit_relative_l2);
  if (lights.fit_irradiance_relative_l2)
    text +=
        fmt::format("  \"fit_irradiance_relative_l2\": {},\n", *lights.fit_irradiance_relative_l2);
  text +=
      fmt::format("  \"world_from_environment\": [{}, {}, {}],\n", format_vector(rotation.row(0)),
                  format_vector(rotation.row(1)), format_vector(rotation.row(2)));
  text += fmt::format("  \"scale\": {},\n", lights.scale);
  text += format_list("lobes", lights.rig.lobes, format_lobe) + ",\n";
  text += format_list("directionals", lights.rig.directionals, format_directional) + ",\n";
  text += format_list("spheres", lights.rig.spheres, format_sphere) + ",\n";
  text += format_list("rectangles", lights.rig.rectangles, format_rectangle) + "\n}\n";
  require_readable(subject, "these lights", [&] { parse_lights(text, subject); });
  return text;
}

void write_lights(const LightFile& lights, const std::string& path) {
  const std::string text = format_lights(lights, path);
  OutputFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace burnish
