#include "scene_drawing.h"

#include <algorithm>
#include <glm/ext/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <set>
#include <utility>

namespace occlod::viewer {

SceneDrawing::SceneDrawing(const gl::Functions& gl)
    : gl_(&gl), plain_(gl, false), wire_(gl, true), background_(gl), lines_(gl) {}

std::size_t SceneDrawing::upload(std::shared_ptr<const RefinedFrame> frame) {
  if (frame == frame_) return 0;
  frame_ = std::move(frame);
  keep_vertices_of(frame_ ? *frame_->job.objects : Objects());
  const bool is_hlod = frame_ && !frame_->hlod_sides.empty();
  if (is_hlod != std::exchange(is_hlod_, is_hlod)) sides_.clear();
  sides_.resize(frame_ ? frame_->side_count() : 0);
  std::size_t bytes = 0;
  for (std::size_t s = 0; s < sides_.size(); ++s)
    bytes += is_hlod ? upload(sides_[s], frame_->hlod_sides[s]) : upload(sides_[s], frame_->sides[s]);
  drop_unshown_images();
  return bytes;
}

void SceneDrawing::keep_vertices_of(const Objects& objects) {
  const auto is_gone = [&](const auto& entry) {
    return std::none_of(objects.begin(), objects.end(),
                        [&](const PlacedObject& object) { return object.mesh == entry.first; });
  };
  std::erase_if(vertices_, is_gone);
  std::erase_if(layers_, [&](const auto& entry) {
    return std::none_of(objects.begin(), objects.end(),
                        [&](const PlacedObject& object) { return texture_of(object) == entry.first; });
  });
  for (const PlacedObject& object : objects) {
    if (const auto& texture = texture_of(object)) layers_.try_emplace(texture, *gl_, *texture);
    if (object.hlod || vertices_.contains(object.mesh)) continue;
    vertices_.try_emplace(object.mesh, *gl_).first->second.fill(vertex_data_of(*object.mesh), true);
  }
}

// Makes one entry for each object of the frame.
void SceneDrawing::fit(Side& side) const {
  const Objects& objects = *frame_->job.objects;
  while (side.objects.size() > objects.size()) side.objects.pop_back();
  while (side.objects.size() < objects.size()) side.objects.emplace_back(*gl_);
  gl_->BindVertexArray(0);  // its index buffer might be replaced
}

std::size_t SceneDrawing::upload(Side& side, const HlodSide& drawn) {
  fit(side);
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < side.objects.size(); ++i) {
    Drawn& object = side.objects[i];
    const FrontObject& front = drawn.front->objects[i];
    if (side.number != drawn.front->number) {
      bytes += object.triangles.fill(front.triangles);
      if (!object.vertices) object.vertices.emplace(*gl_);
      bytes += object.vertices->fill({front.positions,
                                      front.normals,
                                      {},
                                      front.colors,
                                      front.texture_coordinates,
                                      front.materials,
                                      front.image_coordinates},
                                     false);
      gl_->BindVertexArray(0);
    }
    bytes += object.colors.fill(drawn.colors[i]);
  }
  side.number = drawn.front->number;
  return bytes + upload_images(side, drawn);
}

std::size_t SceneDrawing::upload_images(Side& side, const HlodSide& drawn) {
  for (Drawn& object : side.objects) object.runs.clear();
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < drawn.images.size(); ++i) {
    const std::size_t object = drawn.front->frame.draws[i].object;
    const auto first = static_cast<std::uint32_t>(drawn.front->first_triangle[i]);
    std::vector<ImageRun>& runs = side.objects[object].runs;
    if (!runs.empty()) runs.back().triangles.count = first - runs.back().triangles.first;
    const ImageBuffer* buffer = nullptr;
    if (const std::shared_ptr<const Image>& image = drawn.images[i]) {
      const auto [place, is_new] = images_.try_emplace(image, *gl_, *image);
      if (is_new) bytes += std::span(image->pixels).size_bytes();
      buffer = &place->second;
    }
    runs.push_back({{first, 0}, buffer});
  }
  for (std::size_t i = 0; i < side.objects.size(); ++i) {
    std::vector<ImageRun>& runs = side.objects[i].runs;
    if (std::ranges::all_of(runs, [](const ImageRun& run) { return run.image == nullptr; })) runs.clear();
    const auto end = static_cast<std::uint32_t>(drawn.front->objects[i].triangles.size());
    if (!runs.empty()) runs.back().triangles.count = end - runs.back().triangles.first;
  }
  return bytes;
}

void SceneDrawing::drop_unshown_images() {
  std::set<const Image*> shown;
  if (is_hlod_)
    for (const HlodSide& side : frame_->hlod_sides)
      for (const std::shared_ptr<const Image>& image : side.images) shown.insert(image.get());
  std::erase_if(images_, [&](const auto& entry) { return !shown.contains(entry.first.get()); });
}

std::size_t SceneDrawing::upload(Side& side, const RefinedSide& refined) {
  const Objects& objects = *frame_->job.objects;
  const bool is_there = side.number == refined.number;
  const bool follows = refined.follows > 0 && side.number == refined.follows;
  fit(side);
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    Drawn& drawn = side.objects[i];
    const RefinedObject& object = refined.refinement.objects[i];
    if (!is_there) {
      if (!follows) drawn.morphs.reset();  // of another mesh
      bytes +=
          follows ? drawn.triangles.change(object.triangles, object.changes) : drawn.triangles.fill(object.triangles);
      bytes += upload_morphs(drawn, objects[i], object.geomorphs);
    }
    bytes += drawn.colors.fill(refined.colors[i]);
    bytes += drawn.seen.fill(refined.seen_colors.empty() ? std::span<const glm::u8vec4>() : refined.seen_colors[i]);
  }
  side.number = refined.number;
  return bytes;
}

std::size_t SceneDrawing::upload_morphs(Drawn& drawn, const PlacedObject& object, std::span<const Geomorph> geomorphs) {
  if (frame_->job.options.geomorph_frames == 0) drawn.morphs.reset();
  if (!drawn.morphs && geomorphs.empty()) return 0;
  if (!drawn.morphs) drawn.morphs.emplace(*gl_, vertices_.at(object.mesh), object.mesh->hierarchy->positions());
  return drawn.morphs->update(geomorphs);
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
    const std::size_t shown = std::min(side, sides_.size() - 1);
    const std::vector<Drawn>& drawn = sides_[shown].objects;
    const bool seen = colors == Colors::seen && !is_hlod_;  // HLODs have no such colours
    const bool own = has_own_colors(shown, look);
    if (clip_plane_) gl.Enable(GL_CLIP_DISTANCE0);
    for (std::size_t i = 0; i < drawn.size(); ++i)
      draw_object((*frame_->job.objects)[i], drawn[i], seen ? drawn[i].seen : drawn[i].colors, own, view, look);
  }
  gl.Disable(GL_CLIP_DISTANCE0);
  gl.Disable(GL_CULL_FACE);
  gl.FrontFace(GL_CCW);
  lines_.draw(lines, view);
  gl.Disable(GL_DEPTH_TEST);
  gl.BindVertexArray(0);
  target.finish();
}

// Returns whether the side is drawn in the colours of the file.
bool SceneDrawing::has_own_colors(std::size_t side, const LookSettings& look) const {
  if (is_hlod_) return frame_->job.hlod.color_by == HlodColorBy::vertices;
  if (frame_->cells && side == 0) return frame_->job.walk.color_by == CellColorBy::vertices;
  return look.color_by == ColorBy::vertices;
}

void SceneDrawing::draw_object(const PlacedObject& object, const Drawn& drawn, const TriangleColors& colors,
                               bool own_colors, const View& view, const LookSettings& look) const {
  const Camera& camera = view.camera();
  const ObjectView object_view(view, object.object_to_world);
  const glm::dmat4 world_to_eye = glm::lookAt(camera.eye, camera.target, camera.up);
  const glm::dmat4 object_to_eye = world_to_eye * object.object_to_world;
  const VertexBuffers& vertices = drawn.vertices ? *drawn.vertices : vertices_.at(object.mesh);
  MeshProgram::Uniforms uniforms;
  uniforms.object_to_clip = object_view.object_to_clip();
  uniforms.object_to_eye = glm::mat4(object_to_eye);
  uniforms.normal_to_eye = glm::mat3(glm::transpose(glm::inverse(glm::dmat3(object_to_eye))));
  uniforms.crease_limit = static_cast<float>(look.crease_deg / 180.0);
  uniforms.flat = look.shading == Shading::flat;
  uniforms.dim_back_faces = !object.two_sided;
  uniforms.orthographic = view.is_orthographic();
  if (clip_plane_) uniforms.clip_plane = glm::vec4(glm::transpose(glm::inverse(world_to_eye)) * *clip_plane_);
  if (colors.any())
    uniforms.color = MeshProgram::Color::triangles;
  else if (own_colors && vertices.has_colors())
    uniforms.color = MeshProgram::Color::vertices;
  const auto layers = layers_.find(texture_of(object));
  const bool textured =
      is_hlod_ ? frame_->job.hlod.color_by == HlodColorBy::texture : look.color_by == ColorBy::texture;
  if (layers != layers_.end() && !colors.any() && textured) {
    uniforms.color = MeshProgram::Color::texture;
    uniforms.texture_from_below = layers->second.from_below();
    layers->second.bind();
  }
  (look.wire ? wire_ : plain_).use(uniforms);
  drawn.morphs ? drawn.morphs->bind() : vertices.bind();
  colors.bind();
  gl_->FrontFace(object_view.mirrored() ? GL_CW : GL_CCW);
  gl_->Enable(GL_CULL_FACE);
  gl_->CullFace(GL_BACK);
  draw_triangles(drawn, uniforms, look);
  if (!look.back_faces && !object.two_sided) return;
  // At a contour the back face is as near as the front face in front of it, except for rounding, so it is drawn second
  // and slightly farther away.
  gl_->CullFace(GL_FRONT);
  gl_->Enable(GL_POLYGON_OFFSET_FILL);
  gl_->PolygonOffset(1.0F, 1.0F);
  draw_triangles(drawn, uniforms, look);
  gl_->Disable(GL_POLYGON_OFFSET_FILL);
}

// Draws them with the images of nodes where these are shown; the program is in use with these uniforms.
void SceneDrawing::draw_triangles(const Drawn& drawn, MeshProgram::Uniforms& uniforms, const LookSettings& look) const {
  if (uniforms.color != MeshProgram::Color::texture || drawn.runs.empty()) return drawn.triangles.draw();
  for (const ImageRun& run : drawn.runs) {
    if (run.image != nullptr) run.image->bind();
    if (const bool has_image = run.image != nullptr; std::exchange(uniforms.node_image, has_image) != has_image)
      (look.wire ? wire_ : plain_).use(uniforms);
    drawn.triangles.draw(run.triangles);
  }
}

}  // namespace occlod::viewer
