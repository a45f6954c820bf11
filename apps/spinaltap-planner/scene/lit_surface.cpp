#include "apps/spinaltap-planner/scene/lit_surface.h"

#include <vtkActor.h>
#include <vtkShaderProperty.h>

#include <string>

namespace spinaltap {
namespace {

/// In view coordinates: x to the right, y up, z to the eye. The colours are those of the vertices or the property, and
/// already brightened by the power of 1 / 1.6 that render_bone() ends with; so must the light be.
const std::string kLight =
    "  vec3 key = normalize(vec3(-0.5, 0.6, 1.0));\n"
    "  vec3 fill = normalize(vec3(0.8, -0.3, 1.0));\n"
    "  float light = 0.28 + 0.62 * max(0.0, dot(normalVCVSOutput, key)) + 0.18 * max(0.0, dot(normalVCVSOutput, "
    "fill));\n"
    "  vec3 lit = min(diffuseColor * pow(light, 0.625), vec3(1.0));\n";

void set_light(vtkActor& actor, const std::string& code) {
  vtkShaderProperty* shader = actor.GetShaderProperty();
  shader->ClearAllFragmentShaderReplacements();
  shader->AddFragmentShaderReplacement("//VTK::Light::Impl", true, kLight + code, false);
}

}  // namespace

void light_softly(vtkActor& actor) { set_light(actor, "  gl_FragData[0] = vec4(lit, opacity);\n"); }

void light_as_glass(vtkActor& actor) {
  set_light(actor,
            "  float facing = abs(normalVCVSOutput.z);\n"
            "  float edge = 1.0 - facing;\n"
            "  gl_FragData[0] = vec4(min(1.2 * lit, vec3(1.0)), opacity * (0.4 + 1.4 * edge * edge));\n");
}

}  // namespace spinaltap
