#include "mesh_program.h"

#include <glm/gtc/type_ptr.hpp>
#include <string>

namespace occlod::viewer {
namespace {

constexpr const char* vertex_shader = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 color;
layout(location = 3) in float crease;
layout(location = 4) in vec2 coordinate;
layout(location = 5) in int layer;
layout(location = 6) in vec2 place;
uniform mat4 object_to_clip;
uniform mat4 object_to_eye;
uniform mat3 normal_to_eye;
uniform float crease_limit;
uniform vec4 clip_plane;
out VertexOut { vec3 position; vec3 normal; vec3 color; float smooth_share; vec2 coordinate; vec2 place; flat int layer; } vertex;
void main() {
  gl_Position = object_to_clip * vec4(position, 1.0);
  vertex.position = vec3(object_to_eye * vec4(position, 1.0));
  gl_ClipDistance[0] = dot(clip_plane, vec4(vertex.position, 1.0));
  // On a crease a vertex has no normal: its corners take that of their triangle.
  vec3 in_eye_space = normal_to_eye * normal;
  bool has_normal = crease <= crease_limit && dot(in_eye_space, in_eye_space) > 0.0;
  vertex.normal = has_normal ? normalize(in_eye_space) : vec3(0.0);
  vertex.smooth_share = has_normal ? 1.0 : 0.0;
  vertex.color = color.rgb;
  vertex.coordinate = coordinate;
  vertex.place = place;
  vertex.layer = layer;
}
)";

constexpr const char* geometry_shader = R"(#version 330 core
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;
in VertexOut { vec3 position; vec3 normal; vec3 color; float smooth_share; vec2 coordinate; vec2 place; flat int layer; } corners[];
out VertexOut { vec3 position; vec3 normal; vec3 color; float smooth_share; vec2 coordinate; vec2 place; flat int layer; } vertex;
out vec3 barycentric;
void main() {
  for (int i = 0; i < 3; ++i) {
    gl_Position = gl_in[i].gl_Position;
    gl_ClipDistance[0] = gl_in[i].gl_ClipDistance[0];
    gl_PrimitiveID = gl_PrimitiveIDIn;
    vertex.position = corners[i].position;
    vertex.normal = corners[i].normal;
    vertex.color = corners[i].color;
    vertex.smooth_share = corners[i].smooth_share;
    vertex.coordinate = corners[i].coordinate;
    vertex.place = corners[i].place;
    vertex.layer = corners[i].layer;
    barycentric = vec3(i == 0, i == 1, i == 2);
    EmitVertex();
  }
  EndPrimitive();
}
)";

// Lights and line widths are those of occlod::shade (lib/scene/shade.cpp).
constexpr const char* fragment_shader = R"(
in VertexOut { vec3 position; vec3 normal; vec3 color; float smooth_share; vec2 coordinate; vec2 place; flat int layer; } vertex;
uniform int color_mode;
uniform bool flat_shading;
uniform bool dim_back_faces;
uniform bool orthographic;
uniform bool texture_from_below;
uniform sampler2D triangle_colors;
uniform sampler2DArray layers;
uniform bool has_node_image;
uniform sampler2D node_image;
out vec4 target;

// A gamma of 2: where the CPU draws, powers cost more than everything else together.
vec3 to_linear(vec3 srgb) { return srgb * srgb; }

vec3 surface_color() {
  if (color_mode == 1) return to_linear(vertex.color);
  if (color_mode == 2)
    return to_linear(texelFetch(triangle_colors, ivec2(gl_PrimitiveID % 4096, gl_PrimitiveID / 4096), 0).rgb);
  if (color_mode == 3) {
    vec2 at = vec2(vertex.coordinate.x, texture_from_below ? 1.0 - vertex.coordinate.y : vertex.coordinate.y);
    vec3 color = to_linear(texture(layers, vec3(at, float(vertex.layer))).rgb);
    // Where nodes show a material by their own images, its layer is its base colour.
    if (has_node_image && vertex.place.x > -0.5) color *= to_linear(texture(node_image, vertex.place).rgb);
    return color;
  }
  return vec3(0.80, 0.70, 0.58);
}

vec3 light_on(vec3 normal, vec3 to_eye) {
  float head = max(dot(normal, to_eye), 0.0);
  float key = max(dot(normal, normalize(vec3(-0.60, 0.75, 0.45))), 0.0);
  float sky = 0.5 + 0.5 * normal.y;
  return 0.12 * head + 0.98 * key * vec3(1.0, 0.94, 0.84) + mix(vec3(0.045, 0.036, 0.034), vec3(0.12, 0.15, 0.20), sky);
}

// Of the triangle, towards the eye.
vec3 face_normal(vec3 to_eye) {
  vec3 normal = cross(dFdx(vertex.position), dFdy(vertex.position));
  normal = dot(normal, normal) > 0.0 ? normalize(normal) : to_eye;
  return dot(normal, to_eye) < 0.0 ? -normal : normal;
}

// Between the normals of the corners, where those that have none have the triangle's.
vec3 shading_normal(vec3 to_eye) {
  vec3 normal = gl_FrontFacing ? vertex.normal : -vertex.normal;
  normal += (1.0 - vertex.smooth_share) * face_normal(to_eye);
  return dot(normal, normal) > 0.0 ? normalize(normal) : to_eye;
}

void main() {
  vec3 to_eye = orthographic ? vec3(0.0, 0.0, 1.0) : normalize(-vertex.position);
  vec3 normal = flat_shading ? face_normal(to_eye) : shading_normal(to_eye);
  vec3 color = surface_color() * light_on(normal, to_eye);
  // Colours that tell something must be told apart in the dark too.
  if (color_mode == 2) color = mix(color, surface_color(), 0.35);
  if (dim_back_faces && !gl_FrontFacing) color *= 0.35;
#ifdef WIRE
  vec3 pixel = fwidth(barycentric);
  vec3 distances = barycentric / max(pixel, vec3(1e-9));
  float nearest = min(distances.x, min(distances.y, distances.z));
  float size = 1.0 / max(max(pixel.x, max(pixel.y, pixel.z)), 1e-9);
  color *= 1.0 - 0.6 * smoothstep(1.2, 6.0, size) * (1.0 - smoothstep(0.2, 1.1, nearest));
#endif
  target = vec4(sqrt(color), 1.0);
}
)";

constexpr const char* background_vertex_shader = R"(#version 330 core
out vec3 color;
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  color = mix(vec3(0.91, 0.92, 0.935), vec3(0.60, 0.665, 0.745), 0.5 + 0.5 * corner.y);
  gl_Position = vec4(corner, 1.0, 1.0);
}
)";

constexpr const char* background_fragment_shader = R"(#version 330 core
in vec3 color;
out vec4 target;
void main() { target = vec4(color, 1.0); }
)";

std::string fragment_source(bool wire) {
  return std::string("#version 330 core\n") + (wire ? "#define WIRE\nin vec3 barycentric;\n" : "") + fragment_shader;
}

}  // namespace

MeshProgram::MeshProgram(const gl::Functions& gl, bool wire)
    : gl_(&gl),
      program_(wire ? gl::Program(gl, {{GL_VERTEX_SHADER, vertex_shader},
                                       {GL_GEOMETRY_SHADER, geometry_shader},
                                       {GL_FRAGMENT_SHADER, fragment_source(true).c_str()}})
                    : gl::Program(gl, {{GL_VERTEX_SHADER, vertex_shader},
                                       {GL_FRAGMENT_SHADER, fragment_source(false).c_str()}})),
      object_to_clip_(program_.uniform("object_to_clip")),
      object_to_eye_(program_.uniform("object_to_eye")),
      normal_to_eye_(program_.uniform("normal_to_eye")),
      color_(program_.uniform("color_mode")),
      crease_limit_(program_.uniform("crease_limit")),
      flat_(program_.uniform("flat_shading")),
      dim_(program_.uniform("dim_back_faces")),
      orthographic_(program_.uniform("orthographic")),
      from_below_(program_.uniform("texture_from_below")),
      node_image_(program_.uniform("has_node_image")),
      clip_plane_(program_.uniform("clip_plane")) {
  // Samplers of different kinds may not share a unit.
  gl.UseProgram(program_.id());
  gl.Uniform1i(program_.uniform("layers"), 1);
  gl.Uniform1i(program_.uniform("node_image"), 2);
}

void MeshProgram::use(const Uniforms& uniforms) const {
  gl_->UseProgram(program_.id());
  gl_->UniformMatrix4fv(object_to_clip_, 1, GL_FALSE, glm::value_ptr(uniforms.object_to_clip));
  gl_->UniformMatrix4fv(object_to_eye_, 1, GL_FALSE, glm::value_ptr(uniforms.object_to_eye));
  gl_->UniformMatrix3fv(normal_to_eye_, 1, GL_FALSE, glm::value_ptr(uniforms.normal_to_eye));
  gl_->Uniform1i(color_, static_cast<GLint>(uniforms.color));
  gl_->Uniform1f(crease_limit_, uniforms.crease_limit);
  gl_->Uniform1i(flat_, uniforms.flat ? 1 : 0);
  gl_->Uniform1i(dim_, uniforms.dim_back_faces ? 1 : 0);
  gl_->Uniform1i(orthographic_, uniforms.orthographic ? 1 : 0);
  gl_->Uniform1i(from_below_, uniforms.texture_from_below ? 1 : 0);
  gl_->Uniform1i(node_image_, uniforms.node_image ? 1 : 0);
  gl_->Uniform4fv(clip_plane_, 1, glm::value_ptr(uniforms.clip_plane));
}

BackgroundProgram::BackgroundProgram(const gl::Functions& gl)
    : gl_(&gl),
      program_(gl, {{GL_VERTEX_SHADER, background_vertex_shader}, {GL_FRAGMENT_SHADER, background_fragment_shader}}),
      array_(gl) {}

void BackgroundProgram::draw() const {
  gl_->Disable(GL_DEPTH_TEST);
  gl_->UseProgram(program_.id());
  gl_->BindVertexArray(array_.id());
  gl_->DrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace occlod::viewer
