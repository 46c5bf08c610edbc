#include "occlod/gl/query_occlusion.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <cstdint>
#include <deque>
#include <glm/gtc/type_ptr.hpp>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "gl/objects.h"
#include "gl/occluder_mesh.h"
#include "gl/proxies.h"
#include "occlod/core/error.h"

namespace occlod::gl {
namespace {

constexpr const char* vertex_source = R"(#version 330 core
layout(location = 0) in vec4 position;
uniform mat4 to_clip;
void main() { gl_Position = to_clip * position; }
)";
constexpr const char* fragment_source = R"(#version 330 core
void main() {}
)";

// Depths that should be equal differ by rounding and by the 1/256 pixel of the rasteriser: the occluder is pushed away
// and proxies are pulled near by this much of the depth that one pixel spans, and so many steps of the depth buffer. A
// bound that touches the occluder is visible.
constexpr float bias_slope = 1.0F / 64.0F;
constexpr float bias_steps = 4.0F;

// Drivers answer within milliseconds. One that has not after this long never will.
constexpr std::chrono::seconds longest_wait{10};

// A vertex array with its vertices and indices.
struct Mesh {
  explicit Mesh(const Functions& gl, GLint components) : array(gl), vertices(gl), indices(gl) {
    gl.BindVertexArray(array.id());
    gl.BindBuffer(GL_ARRAY_BUFFER, vertices.id());
    gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices.id());
    gl.EnableVertexAttribArray(0);
    gl.VertexAttribPointer(0, components, GL_FLOAT, GL_FALSE, 0, nullptr);
  }
  VertexArray array;
  Buffer vertices;
  Buffer indices;
};

template <class T>
void fill(const Functions& gl, GLenum target, std::span<const T> data, GLenum usage) {
  gl.BufferData(target, static_cast<GLsizeiptr>(data.size_bytes()), data.data(), usage);
}

// All three proxies in one buffer.
class ProxyBuffer {
 public:
  explicit ProxyBuffer(const Functions& gl) : mesh_(gl, 3) {
    std::vector<glm::vec3> vertices;
    std::vector<std::uint16_t> indices;
    for (std::size_t i = 0; i < proxy_shape_count; ++i) {
      const ProxyMesh& proxy = unit_proxy(static_cast<ProxyShape>(i));
      parts_[i] = {static_cast<GLsizei>(proxy.indices.size()), indices.size() * sizeof(std::uint16_t)};
      const auto base = static_cast<std::uint16_t>(vertices.size());
      for (const std::uint16_t index : proxy.indices) indices.push_back(static_cast<std::uint16_t>(base + index));
      vertices.insert(vertices.end(), proxy.vertices.begin(), proxy.vertices.end());
    }
    fill(gl, GL_ARRAY_BUFFER, std::span<const glm::vec3>(vertices), GL_STATIC_DRAW);
    fill(gl, GL_ELEMENT_ARRAY_BUFFER, std::span<const std::uint16_t>(indices), GL_STATIC_DRAW);
  }
  void bind(const Functions& gl) const { gl.BindVertexArray(mesh_.array.id()); }
  void draw(const Functions& gl, ProxyShape shape) const {
    const Part& part = parts_[static_cast<std::size_t>(shape)];
    // OpenGL takes the offset into the bound buffer as a pointer. NOLINTNEXTLINE(performance-no-int-to-ptr)
    gl.DrawElements(GL_TRIANGLES, part.count, GL_UNSIGNED_SHORT, reinterpret_cast<const void*>(part.first_byte));
  }

 private:
  struct Part {
    GLsizei count = 0;
    std::size_t first_byte = 0;
  };
  Mesh mesh_;
  std::array<Part, proxy_shape_count> parts_;
};

// Everything that lives in the context.
struct Resources {
  explicit Resources(const Functions& gl)
      : target(gl), program(gl, vertex_source, fragment_source), occluder(gl, 4), proxies(gl) {
    to_clip = gl.GetUniformLocation(program.id(), "to_clip");
    check(gl, "set-up of occlusion queries");
  }
  DepthTarget target;
  Program program;
  GLint to_clip = -1;
  Mesh occluder;
  ProxyBuffer proxies;
  // Query objects that wait for nothing. They never leave this backend, because an object keeps the target of its first
  // use for good.
  std::vector<Query> idle;
};

struct Pending {
  std::optional<Query> query;    // none: answered without drawing
  std::uint32_t answer_or_most;  // the answer, or the largest that can be right
};

class QueryOcclusion final : public Visibility {
 public:
  QueryOcclusion(std::shared_ptr<Context> context, const QueryOcclusionOptions& options)
      : context_(std::move(context)), flight_(options.flight), counts_(options.count_pixels) {
    context_->make_current();
    resources_ = std::make_unique<Resources>(gl());
  }
  QueryOcclusion(const QueryOcclusion&) = delete;
  QueryOcclusion(QueryOcclusion&&) = delete;
  QueryOcclusion& operator=(const QueryOcclusion&) = delete;
  QueryOcclusion& operator=(QueryOcclusion&&) = delete;
  ~QueryOcclusion() override;

  [[nodiscard]] std::string_view name() const noexcept override { return "gl-query"; }
  [[nodiscard]] std::size_t flight() const noexcept override { return flight_; }
  void begin_view(const View& view, std::span<const ObjectView> objects) override;
  void draw_occluder(std::span<const OccluderPart> parts) override;
  void submit(const VisibilityQuery& query) override;
  [[nodiscard]] std::uint32_t collect() override;

 private:
  [[nodiscard]] const Functions& gl() const noexcept { return context_->functions(); }
  void start_occluder() const;
  void start_queries() const;
  [[nodiscard]] Query draw_query(const ProxyDraw& draw, bool mirrored);
  void wait_for(const Query& query) const;

  std::shared_ptr<Context> context_;
  std::size_t flight_;
  bool counts_;
  Screen screen_;
  std::vector<ProxySpace> objects_;
  OccluderMesh occluder_;
  std::unique_ptr<Resources> resources_;
  std::deque<Pending> pending_;
};

QueryOcclusion::~QueryOcclusion() {
  try {
    context_->make_current();
  } catch (const Error&) {
    // Deleting now would hit the objects of another context. Ours end with the context.
    static_cast<void>(resources_.release());
    for (Pending& pending : pending_)
      if (pending.query) pending.query->abandon();
  }
}

void QueryOcclusion::begin_view(const View& view, std::span<const ObjectView> objects) {
  context_->make_current();
  // Unanswered queries end with their objects, so that no late answer can be taken for one of this view.
  pending_.clear();
  screen_ = Screen(view);
  objects_.clear();
  for (const ObjectView& object : objects) objects_.emplace_back(screen_, object);
  resources_->target.bind(screen_.width, screen_.height);
  start_occluder();
  start_queries();
  check(gl(), "start of a view");
}

void QueryOcclusion::draw_occluder(std::span<const OccluderPart> parts) {
  assert(pending_.empty());
  context_->make_current();
  occluder_.assign(parts, objects_);
  resources_->target.bind(screen_.width, screen_.height);
  start_occluder();
  if (!occluder_.indices().empty()) {
    const glm::mat4 identity(1.0F);
    gl().UniformMatrix4fv(resources_->to_clip, 1, GL_FALSE, glm::value_ptr(identity));
    gl().BindVertexArray(resources_->occluder.array.id());
    gl().BindBuffer(GL_ARRAY_BUFFER, resources_->occluder.vertices.id());
    fill(gl(), GL_ARRAY_BUFFER, occluder_.vertices(), GL_STREAM_DRAW);
    fill(gl(), GL_ELEMENT_ARRAY_BUFFER, occluder_.indices(), GL_STREAM_DRAW);
    gl().DrawElements(GL_TRIANGLES, static_cast<GLsizei>(occluder_.indices().size()), GL_UNSIGNED_INT, nullptr);
  }
  start_queries();
  check(gl(), "drawing an occluder");
}

// Everything that the draw depends on is set, so that others may have used the context since the last view.
void QueryOcclusion::start_occluder() const {
  gl().Viewport(0, 0, screen_.width, screen_.height);
  gl().DepthRange(0.0, 1.0);
  gl().Disable(GL_SCISSOR_TEST);
  gl().Disable(GL_STENCIL_TEST);
  gl().Disable(GL_CULL_FACE);
  // What the near plane cuts off must not hide anything.
  gl().Disable(GL_DEPTH_CLAMP);
  gl().Enable(GL_DEPTH_TEST);
  gl().DepthFunc(GL_LESS);
  gl().DepthMask(GL_TRUE);
  gl().Enable(GL_POLYGON_OFFSET_FILL);
  gl().PolygonOffset(bias_slope, bias_steps);
  gl().UseProgram(resources_->program.id());
  gl().ClearDepth(1.0);
  gl().Clear(GL_DEPTH_BUFFER_BIT);
}

void QueryOcclusion::start_queries() const {
  resources_->proxies.bind(gl());
  gl().Enable(GL_CULL_FACE);
  gl().CullFace(GL_BACK);
  // What reaches beyond the far plane must not vanish there.
  gl().Enable(GL_DEPTH_CLAMP);
  gl().DepthFunc(GL_LEQUAL);
  gl().DepthMask(GL_FALSE);
  gl().PolygonOffset(-bias_slope, -bias_steps);
}

void QueryOcclusion::submit(const VisibilityQuery& query) {
  assert(query.object < objects_.size());
  const ProxySpace& space = objects_[query.object];
  const QueryPlan plan = plan_query(screen_, space, query);
  if (plan.draw) {
    context_->make_current();
    pending_.push_back({draw_query(*plan.draw, space.mirrored), counts_ ? plan.draw->most_pixels : 1U});
  } else {
    const auto all =
        counts_ ? static_cast<std::uint32_t>(screen_.width) * static_cast<std::uint32_t>(screen_.height) : 1U;
    pending_.push_back({std::nullopt, plan.visible ? all : 0U});
  }
}

// Front faces only: the eye is outside and the proxy convex, so they cover each pixel once.
Query QueryOcclusion::draw_query(const ProxyDraw& draw, bool mirrored) {
  std::vector<Query>& idle = resources_->idle;
  if (idle.empty()) idle.emplace_back(gl());
  Query query = std::move(idle.back());
  idle.pop_back();
  const GLenum target = counts_ ? GL_SAMPLES_PASSED : GL_ANY_SAMPLES_PASSED;
  gl().FrontFace(mirrored ? GL_CW : GL_CCW);
  gl().UniformMatrix4fv(resources_->to_clip, 1, GL_FALSE, glm::value_ptr(draw.unit_to_clip));
  gl().BeginQuery(target, query.id());
  resources_->proxies.draw(gl(), draw.shape);
  gl().EndQuery(target);
  return query;
}

std::uint32_t QueryOcclusion::collect() {
  assert(!pending_.empty());
  Pending oldest = std::move(pending_.front());
  pending_.pop_front();
  if (!oldest.query) return oldest.answer_or_most;
  context_->make_current();
  wait_for(*oldest.query);
  GLuint passed = 0;
  gl().GetQueryObjectuiv(oldest.query->id(), GL_QUERY_RESULT, &passed);
  resources_->idle.push_back(*std::move(oldest.query));
  // llvmpipe has been seen to count some 60,000 too many, so a count is believed only as far as the proxy reaches.
  return std::min<std::uint32_t>(passed, oldest.answer_or_most);
}

void QueryOcclusion::wait_for(const Query& query) const {
  GLuint available = GL_FALSE;
  gl().GetQueryObjectuiv(query.id(), GL_QUERY_RESULT_AVAILABLE, &available);
  if (available == GL_TRUE) return;
  gl().Flush();
  const auto deadline = std::chrono::steady_clock::now() + longest_wait;
  while (available != GL_TRUE) {
    gl().GetQueryObjectuiv(query.id(), GL_QUERY_RESULT_AVAILABLE, &available);
    if (available == GL_TRUE) return;
    if (std::chrono::steady_clock::now() > deadline)
      throw Error(
          {"OpenGL", "occlusion query", "the driver gave no answer", "use another driver, or the software backend"});
    std::this_thread::yield();
  }
}

}  // namespace

std::unique_ptr<Visibility> make_query_occlusion(std::shared_ptr<Context> context,
                                                 const QueryOcclusionOptions& options) {
  if (!context) throw Error({"gl-query", "", "has no OpenGL context", "make one with create_context()"});
  if (options.flight == 0) throw Error({"gl-query", "flight", "is 0", "use at least 1"});
  return std::make_unique<QueryOcclusion>(std::move(context), options);
}

}  // namespace occlod::gl
