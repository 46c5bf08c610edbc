#include "scene_drawing.h"

#include <algorithm>
#include <glm/ext/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <utility>

namespace occlod::viewer {

SceneDrawing::SceneDrawing(const gl::Functions& gl)
    : gl_(&gl), plain_(gl, false), wire_(gl, true), background_(gl), lines_(gl) {}

void SceneDrawing::upload(std::shared_ptr<const RefinedFrame> frame) {
  if (frame == frame_) return;
  frame_ = std::move(frame);
  const std::size_t side_count = frame_ ? frame_->sides.size() : 0;
  const Objects none;
  const Objects& objects = frame_ ? *frame_->job.objects : none;
  std::erase_if(vertices_, [&](const auto& entry) {
    return std::none_of(objects.begin(), objects.end(),
                        [&](const PlacedObject& object) { return object.mesh == entry.first; });
  });
  for (const PlacedObject& object : objects) vertices_.try_emplace(object.mesh, *gl_, *object.mesh);
  sides_.resize(side_count);
  for (std::size_t s = 0; s < side_count; ++s) {
    Side& side = sides_[s];
    while (side.size() > objects.size()) side.pop_back();
    while (side.size() < objects.size()) side.emplace_back(*gl_);
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const RefinedSide& refined = frame_->sides[s];
      side[i].triangles.fill(refined.refinement.objects[i].triangles);
      side[i].colors.fill(refined.colors[i]);
      side[i].seen.fill(refined.seen_colors.empty() ? std::span<const glm::u8vec4>() : refined.seen_colors[i]);
    }
  }
}

void SceneDrawing::draw(RenderTarget& target, const Camera& camera, std::size_t side, const LookSettings& look,
                        const std::vector<Line>& lines, Colors colors) {
  const gl::Functions& gl = *gl_;
  target.begin(camera.width, camera.height, look.antialias ? 4 : 1);
  gl.DepthMask(GL_TRUE);
  gl.ClearDepth(1.0);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  background_.draw();
  const View view(camera);
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthFunc(GL_LESS);
  if (!sides_.empty()) {
    const Side& drawn = sides_[std::min(side, sides_.size() - 1)];
    for (std::size_t i = 0; i < drawn.size(); ++i)
      draw_object((*frame_->job.objects)[i], drawn[i].triangles,
                  colors == Colors::seen ? drawn[i].seen : drawn[i].colors, view, look);
  }
  gl.Disable(GL_CULL_FACE);
  gl.FrontFace(GL_CCW);
  lines_.draw(lines, view);
  gl.Disable(GL_DEPTH_TEST);
  gl.BindVertexArray(0);
  target.finish();
}

void SceneDrawing::draw_object(const PlacedObject& object, const TriangleBuffers& triangles,
                               const TriangleColors& colors, const View& view, const LookSettings& look) const {
  const Camera& camera = view.camera();
  const ObjectView object_view(view, object.object_to_world);
  const glm::dmat4 object_to_eye = glm::lookAt(camera.eye, camera.target, camera.up) * object.object_to_world;
  const VertexBuffers& vertices = vertices_.at(object.mesh);
  MeshProgram::Uniforms uniforms;
  uniforms.object_to_clip = object_view.object_to_clip();
  uniforms.object_to_eye = glm::mat4(object_to_eye);
  uniforms.normal_to_eye = glm::mat3(glm::transpose(glm::inverse(glm::dmat3(object_to_eye))));
  uniforms.flat = look.shading == Shading::flat;
  uniforms.dim_back_faces = !object.two_sided;
  if (colors.any())
    uniforms.color = MeshProgram::Color::triangles;
  else if (look.color_by == ColorBy::vertices && vertices.has_colors())
    uniforms.color = MeshProgram::Color::vertices;
  (look.wire ? wire_ : plain_).use(uniforms);
  gl_->FrontFace(object_view.mirrored() ? GL_CW : GL_CCW);
  if (look.back_faces || object.two_sided) {
    gl_->Disable(GL_CULL_FACE);
  } else {
    gl_->Enable(GL_CULL_FACE);
    gl_->CullFace(GL_BACK);
  }
  vertices.bind();
  colors.bind();
  triangles.draw();
}

}  // namespace occlod::viewer
