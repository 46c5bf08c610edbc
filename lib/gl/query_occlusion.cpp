// The backend `gl-query`: OpenGL occlusion queries in flights, as in Birkholz & Rahn, sec. 3.1 and 3.3.
#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <deque>
#include <glm/ext/matrix_transform.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/timing.h"
#include "gl/backend_options.h"
#include "gl/objects.h"
#include "gl/programs.h"
#include "gl/proxies.h"
#include "hlod/draw/box_proxy.h"
#include "occlod/base.h"
#include "occlod/gl.h"

namespace occlod::gl {
namespace {

// Builds and draws the occluder of one view as a single indexed mesh in clip space.

// Contains only the vertices that some triangle uses, each once, transformed in double precision: the product of a
// matrix and a point close to the eye suffers from cancellation, and single precision would move the occluder there. An
// occluder uses few of its object's vertices, so streaming them costs less than checking whether a copy of all of them
// on the GPU is still current. Reuses its memory.
class OccluderMesh {
 public:
  explicit OccluderMesh(const Functions& gl);
  // Replaces the mesh. `object_to_clip` is indexed by object. O(triangles), plus O(vertices) when a part is larger than
  // all before.
  void assign(std::span<const OccluderPart> parts, std::span<const glm::dmat4> object_to_clip);
  // Uploads and draws the mesh, with positions at location 0.
  void draw(const Functions& gl) const;

 private:
  void append(const OccluderPart& part, const glm::dmat4& object_to_clip);

  std::vector<glm::vec4> vertices_;  // clip space
  std::vector<std::uint32_t> indices_;
  std::vector<std::uint32_t> slots_;  // index in vertices_ of each vertex of a part; all no_id between calls
  VertexArray array_;
  Buffer vertex_buffer_;
  Buffer index_buffer_;
};

OccluderMesh::OccluderMesh(const Functions& gl) : array_(gl), vertex_buffer_(gl), index_buffer_(gl) {
  gl.BindVertexArray(array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, vertex_buffer_.id());
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, index_buffer_.id());
  gl.EnableVertexAttribArray(0);
  gl.VertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, 0, nullptr);
}

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

void OccluderMesh::draw(const Functions& gl) const {
  if (indices_.empty()) return;
  gl.BindVertexArray(array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, vertex_buffer_.id());
  fill(gl, GL_ARRAY_BUFFER, std::span<const glm::vec4>(vertices_), GL_STREAM_DRAW);
  fill(gl, GL_ELEMENT_ARRAY_BUFFER, std::span<const std::uint32_t>(indices_), GL_STREAM_DRAW);
  gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(indices_.size()), GL_UNSIGNED_INT, nullptr);
}

// A framebuffer with a depth buffer of 32-bit floats that shaders can read.
class DepthTarget {
 public:
  explicit DepthTarget(const Functions& gl) : gl_(&gl), framebuffer_(gl), texture_(gl) {}
  // Binds the framebuffer, with storage of this size in pixels. Throws Error for sizes that the driver does not
  // support.
  void bind(int width, int height);
  [[nodiscard]] GLuint texture() const noexcept { return texture_.id(); }

 private:
  void allocate() const;

  const Functions* gl_;
  Framebuffer framebuffer_;
  Texture texture_;
  int width_ = 0;
  int height_ = 0;
};

void DepthTarget::bind(int width, int height) {
  gl_->BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  if (width == width_ && height == height_) return;
  GLint largest = 0;
  gl_->GetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  check(*gl_, "occlusion target");
  if (width > largest || height > largest)
    throw Error({"OpenGL", "occlusion target", "the driver holds at most " + std::to_string(largest) + " pixels a side",
                 "use a smaller image, or the software backend"});
  width_ = width;
  height_ = height;
  allocate();
}

void DepthTarget::allocate() const {
  gl_->BindTexture(GL_TEXTURE_2D, texture_.id());
  gl_->BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, width_, height_, 0, GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  gl_->FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texture_.id(), 0);
  gl_->DrawBuffer(GL_NONE);
  gl_->ReadBuffer(GL_NONE);
  const GLenum status = gl_->CheckFramebufferStatus(GL_FRAMEBUFFER);
  check(*gl_, "occlusion target");
  if (status != GL_FRAMEBUFFER_COMPLETE)
    throw Error({"OpenGL", "occlusion target", "the driver refuses a framebuffer with one image of floats",
                 "try another driver, or use the software backend"});
}

// Draws the occluder into a depth buffer and tests proxies against it.

// Lives in a context that must be current in every call. After begin_view and draw_occluder the target is bound and the
// state is set for drawing front faces of proxies, with depth test and without depth writes. All state that the draws
// depend on is set there, so other code may use the context between views.
class ProxyStage {
 public:
  // With a `divisor`, the target has one sample for divisor x divisor pixels, at the farthest depth that the occluder
  // has there.
  ProxyStage(const Functions& gl, int divisor);

  void begin_view(const View& view, std::span<const ObjectView> objects);
  void draw_occluder(std::span<const OccluderPart> parts);

  [[nodiscard]] const Functions& gl() const noexcept { return *gl_; }
  [[nodiscard]] QueryPlan plan(const VisibilityQuery& query) const;
  // Returns the answer to a query that is not drawn; with `counts`, all pixels where nothing is known.
  [[nodiscard]] std::uint32_t answer(const QueryPlan& plan, bool counts) const;
  // Converts samples of the target that passed to pixels of the view; max_pixels as in ProxyDraw.
  [[nodiscard]] std::uint32_t pixels(std::uint32_t samples, std::uint32_t max_pixels) const;
  // Draws one proxy.
  void draw(const ProxyDraw& draw) const;

 private:
  void bind_target();
  void start_occluder() const;
  void reduce();
  void start_proxies() const;

  const Functions* gl_;
  int divisor_;
  Screen screen_;
  std::vector<glm::dmat4> object_to_clip_;
  std::vector<ProxySpace> spaces_;
  DepthTarget full_;
  std::optional<DepthTarget> reduced_;  // when the divisor is above 1
  PlainProgram plain_;
  std::optional<Program> reduction_;
  VertexArray nothing_;  // OpenGL draws nothing without a vertex array, even without attributes
  OccluderMesh occluder_;
  ProxyBuffer proxies_;
};

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

ProxyStage::ProxyStage(const Functions& gl, int divisor)
    : gl_(&gl), divisor_(divisor), full_(gl), plain_(gl), nothing_(gl), occluder_(gl), proxies_(gl) {
  if (divisor > 1) {
    reduced_.emplace(gl);
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
  occluder_.assign(parts, object_to_clip_);
  full_.bind(screen_.width, screen_.height);
  gl().Viewport(0, 0, screen_.width, screen_.height);
  start_occluder();
  plain_.set_to_clip(glm::mat4(1.0F));
  occluder_.draw(gl());
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

using Clock = std::chrono::steady_clock;

GLenum gl_target(QueryTarget target) {
  switch (target) {
    case QueryTarget::any:
      return GL_ANY_SAMPLES_PASSED;
    case QueryTarget::any_conservative:
      return GL_ANY_SAMPLES_PASSED_CONSERVATIVE;
    default:
      return GL_SAMPLES_PASSED;
  }
}

// Draws one proxy with its own query.
Query draw_query(QueryPool& pool, const ProxyStage& stage, const ProxyDraw& draw) {
  Query query = pool.begin(stage.gl());
  stage.draw(draw);
  pool.end(stage.gl());
  return query;
}

// Measures how many queries can be issued between issuing one and its answer: with that many pending, the oldest is
// answered when the youngest has been issued. Returns twice that number, since neither time is steady.
std::size_t measured_window(const ProxyStage& stage, QueryPool& pool, std::size_t most) {
  constexpr int warm_up = 3;
  constexpr int rounds = 9;
  // Draws a box of about ten pixels in the middle of the screen.
  const ProxyDraw box{ProxyShape::box, glm::scale(glm::mat4(1.0F), glm::vec3(0.005F)), 1};
  std::vector<double> issue;
  std::vector<double> answer;
  for (int i = -warm_up; i < rounds; ++i) {
    const Clock::time_point start = Clock::now();
    Query query = draw_query(pool, stage, box);
    const Clock::time_point issued = Clock::now();
    static_cast<void>(pool.take(stage.gl(), std::move(query)));
    if (i < 0) continue;
    issue.push_back(std::chrono::duration<double>(issued - start).count());
    answer.push_back(std::chrono::duration<double>(Clock::now() - issued).count());
  }
  const double meanwhile = median(answer) / std::max(median(issue), 1e-9);
  return static_cast<std::size_t>(std::clamp(std::ceil(1.0 + 2.0 * meanwhile), 1.0, static_cast<double>(most)));
}

struct Pending {
  std::optional<ProxyDraw> draw;  // empty: answered without drawing
  std::optional<Query> query;     // set once it is issued
  std::uint32_t answer = 0;       // used when nothing is drawn
};

// Owns everything that lives in the context.
struct Resources {
  Resources(const Functions& gl, const QueryOcclusionOptions& options)
      : stage(gl, options.divisor), pool(gl_target(options.target)) {}
  ProxyStage stage;
  QueryPool pool;
  std::deque<Pending> pending;  // oldest first; issued ones before the others
};

class QueryOcclusion final : public Visibility {
 public:
  QueryOcclusion(std::shared_ptr<Context> context, const QueryOcclusionOptions& options)
      : resources_(std::move(context), options),
        flight_(options.flight),
        window_(options.window),
        counts_(options.target == QueryTarget::count) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "gl-query"; }
  [[nodiscard]] std::size_t flight() const noexcept override { return flight_; }
  void begin_view(const View& view, std::span<const ObjectView> objects) override;
  void draw_occluder(std::span<const OccluderPart> parts) override;
  void submit(const VisibilityQuery& query) override;
  [[nodiscard]] std::uint32_t collect() override;

 private:
  void issue(Resources& resources);

  InContext<Resources> resources_;
  std::size_t flight_;
  std::size_t window_;  // maximum of queries pending in OpenGL; 0 = not measured yet
  bool counts_;
  std::size_t looked_at_ = 0;  // number of processed entries at the front: issued, or answered without drawing
  std::size_t issued_ = 0;     // number of issued queries among them
};

void QueryOcclusion::begin_view(const View& view, std::span<const ObjectView> objects) {
  Resources& resources = resources_.use();
  // Unanswered queries are destroyed, so that a late answer of an older view cannot arrive.
  resources.pending.clear();
  looked_at_ = 0;
  issued_ = 0;
  resources.stage.begin_view(view, objects);
  if (window_ == 0) window_ = measured_window(resources.stage, resources.pool, flight_);
}

void QueryOcclusion::draw_occluder(std::span<const OccluderPart> parts) {
  Resources& resources = resources_.use();
  assert(resources.pending.empty());
  resources.stage.draw_occluder(parts);
}

void QueryOcclusion::submit(const VisibilityQuery& query) {
  Resources& resources = resources_.use();
  const QueryPlan plan = resources.stage.plan(query);
  resources.pending.push_back({plan.draw, std::nullopt, plan.draw ? 0U : resources.stage.answer(plan, counts_)});
  issue(resources);
}

// Issues as many queries as the window has room for.
void QueryOcclusion::issue(Resources& resources) {
  for (; issued_ < window_ && looked_at_ < resources.pending.size(); ++looked_at_) {
    Pending& next = resources.pending[looked_at_];
    if (!next.draw) continue;
    next.query = draw_query(resources.pool, resources.stage, *next.draw);
    ++issued_;
  }
}

std::uint32_t QueryOcclusion::collect() {
  Resources& resources = resources_.use();
  assert(!resources.pending.empty());
  Pending oldest = std::move(resources.pending.front());
  resources.pending.pop_front();
  --looked_at_;
  if (!oldest.query) return oldest.answer;
  --issued_;
  const std::uint32_t passed = resources.pool.take(resources.stage.gl(), *std::move(oldest.query));
  issue(resources);
  // Checks once for all queries between two occluders, because a lost context may return any answer.
  if (issued_ == 0) check(resources.stage.gl(), "occlusion query");
  return counts_ ? resources.stage.pixels(passed, oldest.draw->max_pixels) : std::min(passed, 1U);
}

}  // namespace

std::unique_ptr<Visibility> make_query_occlusion(std::shared_ptr<Context> context,
                                                 const QueryOcclusionOptions& options) {
  if (context == nullptr) throw Error({"gl-query", "", "has no OpenGL context", "make one with create_context()"});
  if (options.flight == 0) throw Error({"gl-query", "flight", "is 0", "use at least 1"});
  if (options.divisor < 1)
    throw Error(
        {"gl-query", "divisor", "is " + std::to_string(options.divisor), "use 1 (the view's own size) or more"});
  if (const int version = context->functions().version; options.target == QueryTarget::any_conservative && version < 43)
    throw Error({"gl-query with conservative queries", "",
                 "needs OpenGL 4.3, and this context offers " + std::to_string(version / 10) + "." +
                     std::to_string(version % 10),
                 "use a newer driver, gl-query with its default target (OpenGL 3.3), or the software backend"});
  return std::make_unique<QueryOcclusion>(std::move(context), options);
}

std::unique_ptr<Visibility> make_query_occlusion(std::shared_ptr<Context> context) {
  return make_query_occlusion(std::move(context), QueryOcclusionOptions{});
}

}  // namespace occlod::gl
