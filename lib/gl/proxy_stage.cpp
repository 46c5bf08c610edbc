#include "gl/proxy_stage.h"

#include <algorithm>
#include <cassert>
#include <span>

#include "gl/programs.h"
#include "hlod/draw/box_proxy.h"
#include "occlod/base.h"

namespace occlod::gl {

void OccluderMesh::assign(std::span<const OccluderPart> parts, std::span<const glm::dmat4> object_to_clip) {
  vertices_.clear();
  indices_.clear();
  for (const OccluderPart& part : parts) {
    assert(part.object < object_to_clip.size());
    append(part, object_to_clip[part.object]);
  }
}

void OccluderMesh::append(const OccluderPart& part, const glm::dmat4& object_to_clip) {
  if (slots_.size() < part.positions.size()) slots_.resize(part.positions.size(), no_id);
  for (const Triangle& triangle : part.triangles) {
    for (int k = 0; k < 3; ++k) {
      const VertexId v = triangle[k];
      assert(v < part.positions.size());
      if (slots_[v] == no_id) {
        slots_[v] = static_cast<std::uint32_t>(vertices_.size());
        vertices_.emplace_back(object_to_clip * glm::dvec4(part.positions[v], 1.0));
      }
      indices_.push_back(slots_[v]);
    }
  }
  for (const Triangle& triangle : part.triangles)
    for (int k = 0; k < 3; ++k) slots_[triangle[k]] = no_id;
}

OccluderBuffer::OccluderBuffer(const Functions& gl) : array_(gl), vertices_(gl), indices_(gl) {
  gl.BindVertexArray(array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  gl.EnableVertexAttribArray(0);
  gl.VertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, 0, nullptr);
}

void OccluderBuffer::draw(const Functions& gl, const OccluderMesh& mesh) const {
  if (mesh.indices().empty()) return;
  gl.BindVertexArray(array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  fill(gl, GL_ARRAY_BUFFER, mesh.vertices(), GL_STREAM_DRAW);
  fill(gl, GL_ELEMENT_ARRAY_BUFFER, mesh.indices(), GL_STREAM_DRAW);
  gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(mesh.indices().size()), GL_UNSIGNED_INT, nullptr);
}

namespace {

// Draws a triangle over the whole target; each sample takes the farthest depth of its pixels.
constexpr const char* reduction_vertex = R"(#version 330 core
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }
)";
constexpr const char* reduction_fragment = R"(#version 330 core
uniform sampler2D depth;
uniform int divisor;
void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * divisor;
  ivec2 end = min(first + divisor, textureSize(depth, 0));
  float farthest = 0.0;
  for (int y = first.y; y < end.y; ++y)
    for (int x = first.x; x < end.x; ++x) farthest = max(farthest, texelFetch(depth, ivec2(x, y), 0).r);
  gl_FragDepth = farthest;
}
)";

}  // namespace

ProxyStage::ProxyStage(const Functions& gl, int divisor)
    : gl_(&gl),
      divisor_(divisor),
      full_(gl, FloatTarget::Kind::depth),
      plain_(gl),
      nothing_(gl),
      occluder_(gl),
      proxies_(gl) {
  if (divisor > 1) {
    reduced_.emplace(gl, FloatTarget::Kind::depth);
    reduction_.emplace(gl, std::initializer_list<ShaderSource>{{GL_VERTEX_SHADER, reduction_vertex},
                                                               {GL_FRAGMENT_SHADER, reduction_fragment}});
  }
  check(gl, "set-up of proxies");
}

void ProxyStage::begin_view(const View& view, std::span<const ObjectView> objects) {
  screen_ = Screen(view, divisor_);
  object_to_clip_ = clip_matrices(view.camera(), objects);
  spaces_.clear();
  for (std::size_t i = 0; i < objects.size(); ++i)
    spaces_.emplace_back(screen_, object_to_clip_[i], objects[i].mirrored());
  bind_target();
  start_occluder();
  start_proxies();
  check(gl(), "start of a view");
}

void ProxyStage::draw_occluder(std::span<const OccluderPart> parts) {
  mesh_.assign(parts, object_to_clip_);
  full_.bind(screen_.width, screen_.height);
  gl().Viewport(0, 0, screen_.width, screen_.height);
  start_occluder();
  plain_.set_to_clip(glm::mat4(1.0F));
  occluder_.draw(gl(), mesh_);
  if (reduced_) reduce();
  start_proxies();
  check(gl(), "drawing an occluder");
}

void ProxyStage::bind_target() {
  (reduced_ ? *reduced_ : full_).bind(screen_.target_width(), screen_.target_height());
  gl().Viewport(0, 0, screen_.target_width(), screen_.target_height());
}

void ProxyStage::start_occluder() const {
  set_surface_state(gl());
  plain_.use();
  gl().ClearDepth(1.0);
  gl().Clear(GL_DEPTH_BUFFER_BIT);
}

void ProxyStage::reduce() {
  bind_target();
  gl().UseProgram(reduction_->id());
  gl().ActiveTexture(GL_TEXTURE0);
  gl().BindTexture(GL_TEXTURE_2D, full_.texture());
  gl().Uniform1i(reduction_->uniform("depth"), 0);
  gl().Uniform1i(reduction_->uniform("divisor"), divisor_);
  gl().DepthFunc(GL_ALWAYS);
  gl().BindVertexArray(nothing_.id());
  gl().DrawArrays(GL_TRIANGLES, 0, 3);
  gl().BindTexture(GL_TEXTURE_2D, 0);
  plain_.use();
}

void ProxyStage::start_proxies() const {
  proxies_.bind(gl());
  set_proxy_state(gl());
}

QueryPlan ProxyStage::plan(const VisibilityQuery& query) const {
  assert(query.object < spaces_.size());
  return plan_query(screen_, spaces_[query.object], query);
}

std::uint32_t ProxyStage::answer(const QueryPlan& plan, bool counts) const {
  if (!plan.visible) return 0;
  return counts ? static_cast<std::uint32_t>(screen_.width) * static_cast<std::uint32_t>(screen_.height) : 1;
}

std::uint32_t ProxyStage::pixels(std::uint32_t samples, std::uint32_t max_pixels) const {
  const std::uint64_t pixels = std::uint64_t{samples} * static_cast<std::uint64_t>(divisor_ * divisor_);
  // llvmpipe has been seen to count some 60,000 too many, so a count is limited to the pixels that the proxy can cover.
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(pixels, max_pixels));
}

void ProxyStage::draw(const ProxyDraw& draw) const {
  const ProxyBuffer::Part& part = proxies_.part(draw.shape);
  plain_.set_to_clip(draw.unit_to_clip);
  gl().DrawElements(GL_TRIANGLES, part.count, GL_UNSIGNED_SHORT, part.pointer());
}

namespace {

// Computes positions bit for bit like PlainProgram.
constexpr const char* vertex_source = R"(#version 430 core
layout(location = 0) in vec4 position;
layout(location = 1) in mat4 to_clip;
layout(location = 5) in uint word;
flat out uint marked;
invariant gl_Position;
void main() {
  gl_Position = to_clip * position;
  marked = word;
}
)";

// Front faces of a convex proxy cover each pixel once, so the sum of additions is the number of pixels.
constexpr const char* mark_source = R"(#version 430 core
layout(early_fragment_tests) in;
layout(std430, binding = 0) buffer Marks { uint marks[]; };
flat in uint marked;
void main() { if (marks[marked] == 0u) marks[marked] = 1u; }
)";
constexpr const char* count_source = R"(#version 430 core
layout(early_fragment_tests) in;
layout(std430, binding = 0) buffer Marks { uint marks[]; };
flat in uint marked;
void main() { atomicAdd(marks[marked], 1u); }
)";

}  // namespace

ProxyMarks::ProxyMarks(const Functions& gl, Marking marking)
    : gl_(&gl),
      program_(gl, {{GL_VERTEX_SHADER, vertex_source},
                    {GL_FRAGMENT_SHADER, marking == Marking::visible ? mark_source : count_source}}),
      proxies_(gl),
      instances_(gl) {
  proxies_.bind(gl);
  gl.BindBuffer(GL_ARRAY_BUFFER, instances_.id());
  const auto attribute = [](std::size_t offset) {
    return reinterpret_cast<const void*>(offset);  // NOLINT(performance-no-int-to-ptr)
  };
  for (GLuint column = 0; column < 4; ++column) {
    gl.EnableVertexAttribArray(1 + column);
    gl.VertexAttribPointer(1 + column, 4, GL_FLOAT, GL_FALSE, sizeof(MarkedProxy),
                           attribute(column * sizeof(glm::vec4)));
    gl.VertexAttribDivisor(1 + column, 1);
  }
  gl.EnableVertexAttribArray(5);
  gl.VertexAttribIPointer(5, 1, GL_UNSIGNED_INT, sizeof(MarkedProxy), attribute(offsetof(MarkedProxy, word)));
  gl.VertexAttribDivisor(5, 1);
  check(gl, "set-up of marks");
}

void ProxyMarks::upload(const MarkedProxies& proxies) const {
  std::size_t count = 0;
  for (const auto& of_shape : proxies) count += of_shape.size();
  gl_->BindBuffer(GL_ARRAY_BUFFER, instances_.id());
  gl_->BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(count * sizeof(MarkedProxy)), nullptr, GL_STREAM_DRAW);
  std::size_t first = 0;
  for (const auto& of_shape : proxies) {
    if (of_shape.empty()) continue;
    gl_->BufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(first * sizeof(MarkedProxy)),
                       static_cast<GLsizeiptr>(of_shape.size() * sizeof(MarkedProxy)), of_shape.data());
    first += of_shape.size();
  }
}

void ProxyMarks::draw(const MarkedProxies& proxies, const Buffer& words) const {
  upload(proxies);
  gl_->BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, words.id());
  gl_->UseProgram(program_.id());
  proxies_.bind(*gl_);
  std::size_t first = 0;
  for (std::size_t i = 0; i < proxy_shape_count; ++i) {
    if (proxies[i].empty()) continue;
    const ProxyBuffer::Part& part = proxies_.part(static_cast<ProxyShape>(i));
    gl_->DrawElementsInstancedBaseInstance(GL_TRIANGLES, part.count, GL_UNSIGNED_SHORT, part.pointer(),
                                           static_cast<GLsizei>(proxies[i].size()), static_cast<GLuint>(first));
    first += proxies[i].size();
  }
}

}  // namespace occlod::gl
