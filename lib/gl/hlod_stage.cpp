#include "gl/hlod_stage.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <glm/common.hpp>
#include <string>

#include "occlod/base.h"
#include "scene/color.h"

namespace occlod::gl {
namespace {

std::size_t pixel_count(int width, int height) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

// OpenGL's rows start at the bottom.
std::size_t from_bottom(std::size_t row, int height) { return static_cast<std::size_t>(height) - 1 - row; }

glm::u8vec4 background(std::size_t row, int height) {
  constexpr glm::vec3 top{0.33F, 0.41F, 0.52F};
  constexpr glm::vec3 bottom{0.80F, 0.83F, 0.86F};
  return picture::to_srgb(glm::mix(top, bottom, (static_cast<float>(row) + 0.5F) / static_cast<float>(height)));
}

// Converts a depth in [0, 1] to the nearness that DepthBuffer stores.
float nearness(const Camera& camera, float depth) {
  if (depth >= 1.0F) return 0.0F;
  if (camera.orthographic_height) return 1.0F - depth;
  return static_cast<float>((camera.far - depth * (camera.far - camera.near)) / (camera.far * camera.near));
}

}  // namespace

HlodTarget::HlodTarget(const Functions& gl, int samples) : gl_(&gl), samples_(samples), drawn_(gl) {
  if (samples == 1) return;
  GLint most = 0;
  gl.GetIntegerv(GL_MAX_SAMPLES, &most);
  check(gl, "image");
  if (most < samples)
    throw Error({"gl device", "quality",
                 "needs " + std::to_string(samples) + " samples a pixel, and the driver has " + std::to_string(most),
                 "use another driver, or draw without quality"});
  resolved_.emplace(gl);
}

void HlodTarget::begin(const View& view) {
  camera_ = view.camera();
  const int width = camera_.width;
  const int height = camera_.height;
  if (width != width_ || height != height_) {
    require_size(width, height);
    width_ = width;
    height_ = height;
    if (resolved_) allocate(*resolved_, 1);
    allocate(drawn_, samples_);
  }
  gl_->BindFramebuffer(GL_FRAMEBUFFER, drawn_.framebuffer.id());
  gl_->DrawBuffer(GL_COLOR_ATTACHMENT0);
  gl_->Viewport(0, 0, width, height);
  gl_->Disable(GL_SCISSOR_TEST);
  gl_->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl_->DepthMask(GL_TRUE);
  constexpr std::array<GLfloat, 4> nothing{};
  constexpr GLfloat farthest = 1.0F;
  gl_->ClearBufferfv(GL_COLOR, 0, nothing.data());
  gl_->ClearBufferfv(GL_DEPTH, 0, &farthest);
}

void HlodTarget::require_size(int width, int height) const {
  GLint largest = 0;
  gl_->GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
  check(*gl_, "image");
  if (width > largest || height > largest)
    throw Error({"OpenGL", "image", "the driver holds at most " + std::to_string(largest) + " pixels a side",
                 "use a smaller image, or the software device"});
}

void HlodTarget::allocate(const Storage& storage, int samples) const {
  const auto attach = [&](const Renderbuffer& buffer, GLenum format, GLenum attachment) {
    gl_->BindRenderbuffer(GL_RENDERBUFFER, buffer.id());
    gl_->RenderbufferStorageMultisample(GL_RENDERBUFFER, samples > 1 ? samples : 0, format, width_, height_);
    gl_->FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer.id());
  };
  gl_->BindFramebuffer(GL_FRAMEBUFFER, storage.framebuffer.id());
  attach(storage.color, GL_RGBA8, GL_COLOR_ATTACHMENT0);
  attach(storage.depth, GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT);
  const GLenum status = gl_->CheckFramebufferStatus(GL_FRAMEBUFFER);
  check(*gl_, "image");
  if (status != GL_FRAMEBUFFER_COMPLETE)
    throw Error({"OpenGL", "image",
                 "the driver refuses " + std::to_string(width_) + " x " + std::to_string(height_) + " pixels with " +
                     std::to_string(samples) + (samples == 1 ? " sample" : " samples"),
                 "use a smaller image, or the software device"});
}

void HlodTarget::read(GLbitfield what, GLenum format, GLenum type, void* pixels) const {
  gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, drawn_.framebuffer.id());
  gl_->ReadBuffer(GL_COLOR_ATTACHMENT0);
  if (resolved_) {
    gl_->Disable(GL_SCISSOR_TEST);
    gl_->BindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_->framebuffer.id());
    gl_->BlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, what, GL_NEAREST);
    gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, resolved_->framebuffer.id());
    gl_->ReadBuffer(GL_COLOR_ATTACHMENT0);
    gl_->BindFramebuffer(GL_DRAW_FRAMEBUFFER, drawn_.framebuffer.id());
  }
  gl_->BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  gl_->PixelStorei(GL_PACK_ALIGNMENT, 4);
  for (const int skip : {GL_PACK_ROW_LENGTH, GL_PACK_SKIP_ROWS, GL_PACK_SKIP_PIXELS})
    gl_->PixelStorei(static_cast<GLenum>(skip), 0);
  gl_->ReadPixels(0, 0, width_, height_, format, type, pixels);
  check(*gl_, "reading an image");
}

Image HlodTarget::read_image() const {
  std::vector<glm::u8vec4> found(pixel_count(width_, height_));
  read(GL_COLOR_BUFFER_BIT, GL_RGBA, GL_UNSIGNED_BYTE, found.data());
  Image image{width_, height_, {}};
  image.pixels.reserve(found.size());
  const auto width = static_cast<std::size_t>(width_);
  for (std::size_t y = 0; y < static_cast<std::size_t>(height_); ++y) {
    const glm::vec4 behind(background(y, height_));
    for (std::size_t x = 0; x < width; ++x) {
      // Drawn colours have been multiplied by their coverage of the pixel.
      const glm::vec4 drawn(found[from_bottom(y, height_) * width + x]);
      const glm::vec4 mixed = drawn + behind * (1.0F - drawn.w / 255.0F);
      image.pixels.emplace_back(glm::u8vec4(glm::vec3(mixed) + 0.5F, 255));
    }
  }
  return image;
}

DepthBuffer HlodTarget::read_depth() const {
  std::vector<GLfloat> found(pixel_count(width_, height_));
  read(GL_DEPTH_BUFFER_BIT, GL_DEPTH_COMPONENT, GL_FLOAT, found.data());
  DepthBuffer depth;
  depth.reset(width_, height_);
  const auto width = static_cast<std::size_t>(width_);
  for (std::size_t y = 0; y < static_cast<std::size_t>(height_); ++y)
    for (std::size_t x = 0; x < width; ++x)
      depth.nearness[y * width + x] = nearness(camera_, found[from_bottom(y, height_) * width + x]);
  return depth;
}

namespace {

// Computes positions bit for bit like PlainProgram.
constexpr const char* mark_vertex = R"(#version 430 core
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
constexpr const char* mark_fragment = R"(#version 430 core
layout(early_fragment_tests) in;
layout(std430, binding = 0) buffer Marks { uint marks[]; };
flat in uint marked;
void main() { atomicAdd(marks[marked], 1u); }
)";

}  // namespace

BoxMarks::BoxMarks(const Functions& gl)
    : gl_(&gl),
      program_(gl, {{GL_VERTEX_SHADER, mark_vertex}, {GL_FRAGMENT_SHADER, mark_fragment}}),
      proxies_(gl),
      instances_(gl) {
  proxies_.bind(gl);
  gl.BindBuffer(GL_ARRAY_BUFFER, instances_.id());
  const auto attribute = [](std::size_t offset) {
    return reinterpret_cast<const void*>(offset);  // NOLINT(performance-no-int-to-ptr)
  };
  for (GLuint column = 0; column < 4; ++column) {
    gl.EnableVertexAttribArray(1 + column);
    gl.VertexAttribPointer(1 + column, 4, GL_FLOAT, GL_FALSE, sizeof(MarkedBox), attribute(column * sizeof(glm::vec4)));
    gl.VertexAttribDivisor(1 + column, 1);
  }
  gl.EnableVertexAttribArray(5);
  gl.VertexAttribIPointer(5, 1, GL_UNSIGNED_INT, sizeof(MarkedBox), attribute(offsetof(MarkedBox, word)));
  gl.VertexAttribDivisor(5, 1);
  check(gl, "set-up of marks");
}

void BoxMarks::draw(std::span<const MarkedBox> boxes, const Buffer& words) const {
  gl_->BindBuffer(GL_ARRAY_BUFFER, instances_.id());
  fill(*gl_, GL_ARRAY_BUFFER, boxes, GL_STREAM_DRAW);
  gl_->BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, words.id());
  gl_->UseProgram(program_.id());
  proxies_.bind(*gl_);
  const ProxyBuffer::Part& part = proxies_.part(ProxyShape::box);
  gl_->DrawElementsInstancedBaseInstance(GL_TRIANGLES, part.count, GL_UNSIGNED_SHORT, part.pointer(),
                                         static_cast<GLsizei>(boxes.size()), 0);
}

namespace {

constexpr int quality_samples = 4;

}  // namespace

HlodStage::HlodStage(const Functions& gl, const HlodDeviceOptions& options, const HlodDeviceCalls& calls)
    : gl_(&gl),
      target_(gl, options.quality ? quality_samples : 1),
      arena_(gl, options.mesh_bytes, [this] { submit(); }),
      nodes_(gl, options.quality),
      plain_(gl),
      proxies_(gl) {
  if (calls.indirect && gl.MultiDrawElementsIndirect != nullptr) gathered_.emplace(gl);
  if (calls.marks && !options.quality && gl.version >= 43) marks_.emplace(gl);
  check(gl, "set-up of the device");
}

void HlodStage::begin_frame(const View& view, std::span<const hlod::PlacedHlod> objects) {
  screen_ = Screen(view);
  objects_.clear();
  for (const hlod::PlacedHlod& object : objects) {
    const EyeSpace eye_space(view, object.object_to_world);
    objects_.push_back({eye_space, ProxySpace(screen_, eye_space.object_to_clip, eye_space.mirrored)});
  }
  mode_ = Mode::nothing;
  object_ = no_id;
  calls_ = {};
  if (gathered_) gathered_->clear();
  target_.begin(view);
  arena_.begin_frame(objects);
  set_common_state();
  nodes_.use();
  nodes_.set_view(view);
  check(gl(), "start of a frame");
}

void HlodStage::set_common_state() const {
  for (const int capability : {GL_BLEND, GL_COLOR_LOGIC_OP, GL_FRAMEBUFFER_SRGB, GL_PRIMITIVE_RESTART,
                               GL_RASTERIZER_DISCARD, GL_SAMPLE_ALPHA_TO_COVERAGE, GL_SAMPLE_COVERAGE, GL_SAMPLE_MASK})
    gl().Disable(static_cast<GLenum>(capability));
  gl().Enable(GL_MULTISAMPLE);
}

void HlodStage::start_nodes(std::uint32_t object) {
  assert(object < objects_.size());
  if (mode_ != Mode::nodes) {
    mode_ = Mode::nodes;
    set_surface_state(gl());
    gl().ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    nodes_.use();
  }
  if (object_ == object) return;
  object_ = object;
  nodes_.set_object(objects_[object].eye_space);
}

void HlodStage::draw(const hlod::NodeDraw& draw) {
  if (!draw.cut.empty()) return draw_cut(draw);
  assert(!draw.ranges.empty());
  const bool morphs = std::any_of(draw.ranges.begin(), draw.ranges.end(),
                                  [](const hlod::DrawRange& range) { return range.morph > 0.0F; });
  draw_ranges(draw.object, arena_.place(draw.object, draw.node, morphs), draw.ranges);
}

void HlodStage::draw_cut(const hlod::NodeDraw& draw) {
  const hlod::DrawRange all{0, static_cast<std::uint32_t>(draw.cut.size()), 0.0F};
  draw_ranges(draw.object, arena_.place_cut(draw.object, draw.node, draw.splits, draw.cut), {&all, 1});
}

void HlodStage::draw_ranges(std::uint32_t object, const ArenaPlace& place, std::span<const hlod::DrawRange> ranges) {
  ++calls_.draws;
  if (gathered_) return gathered_->add(object, place, ranges);
  start_nodes(object);
  gl().BindVertexArray(place.array);
  for (std::size_t first = 0; first < ranges.size();) {
    std::size_t end = first + 1;
    while (end < ranges.size() && ranges[end].morph == ranges[first].morph) ++end;
    draw_run(place, ranges.subspan(first, end - first));
    first = end;
  }
}

void HlodStage::submit() {
  if (!gathered_ || gathered_->empty()) return;
  for (const DrawKind& kind : gathered_->kinds()) {
    start_nodes(kind.object);
    gathered_->draw(kind);
    ++calls_.draw_calls;
  }
  gathered_->clear();
}

// Draws ranges that morph alike; adjacent ranges are merged.
void HlodStage::draw_run(const ArenaPlace& place, std::span<const hlod::DrawRange> ranges) {
  counts_.clear();
  first_indices_.clear();
  std::uint32_t end = 0;
  for (const hlod::DrawRange& range : ranges) {
    if (!counts_.empty() && range.first_index == end) {
      counts_.back() += static_cast<GLsizei>(range.index_count);
    } else {
      counts_.push_back(static_cast<GLsizei>(range.index_count));
      first_indices_.push_back(place.index_pointer(range.first_index));
    }
    end = range.first_index + range.index_count;
  }
  gl().VertexAttrib1f(NodeProgram::morph_location, ranges.front().morph);
  ++calls_.draw_calls;
  if (counts_.size() == 1) {
    gl().DrawElementsBaseVertex(GL_TRIANGLES, counts_[0], GL_UNSIGNED_SHORT, first_indices_[0], place.base_vertex);
    return;
  }
  base_vertices_.assign(counts_.size(), place.base_vertex);
  gl().MultiDrawElementsBaseVertex(GL_TRIANGLES, counts_.data(), GL_UNSIGNED_SHORT, first_indices_.data(),
                                   static_cast<GLsizei>(counts_.size()), base_vertices_.data());
}

BoxProxy HlodStage::project(const hlod::BoxRef& box) const {
  assert(box.object < objects_.size());
  return project_box(screen_, objects_[box.object].proxy_space, box.box);
}

std::uint32_t HlodStage::max_pixels(const BoxProxy& proxy) const {
  const glm::dvec2 size(screen_.width, screen_.height);
  const glm::dvec2 pixels = glm::ceil(glm::min(proxy.max, size)) - glm::floor(glm::max(proxy.min, glm::dvec2(0.0)));
  return static_cast<std::uint32_t>(pixels.x * pixels.y);
}

Image HlodStage::read_image() {
  submit();
  return target_.read_image();
}

DepthBuffer HlodStage::read_depth() {
  submit();
  return target_.read_depth();
}

void HlodStage::set_proxy_state() {
  if (mode_ == Mode::nothing) set_surface_state(gl());
  gl::set_proxy_state(gl());
  gl().ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
}

void HlodStage::start_proxies() {
  submit();
  if (mode_ == Mode::proxies) return;
  set_proxy_state();
  mode_ = Mode::proxies;
  plain_.use();
  proxies_.bind(gl());
}

glm::mat4 HlodStage::unit_to_clip(const BoxProxy& proxy) {
  // Clip space is homogeneous: scaling so that the centre is at w = 1 keeps everything in the range of single
  // precision.
  glm::dmat4 to_clip = proxy.unit_to_clip / proxy.unit_to_clip[3].w;
  // The cube is symmetric, so one more reflection only flips the winding.
  if (proxy.image.mirrored) to_clip[2] = -to_clip[2];
  return glm::mat4(to_clip);
}

void HlodStage::draw_proxy(const BoxProxy& proxy) {
  assert(mode_ == Mode::proxies);
  plain_.set_to_clip(unit_to_clip(proxy));
  const ProxyBuffer::Part& part = proxies_.part(ProxyShape::box);
  gl().DrawElements(GL_TRIANGLES, part.count, GL_UNSIGNED_SHORT, part.pointer());
  ++calls_.boxes;
  ++calls_.box_calls;
}

void HlodStage::mark_boxes(std::span<const MarkedBox> boxes, const Buffer& words) {
  submit();
  set_proxy_state();
  mode_ = Mode::marks;
  marks_->draw(boxes, words);
  calls_.boxes += boxes.size();
  ++calls_.box_calls;
}

std::uint32_t HlodStage::pixels() const {
  return static_cast<std::uint32_t>(screen_.width) * static_cast<std::uint32_t>(screen_.height);
}

}  // namespace occlod::gl
