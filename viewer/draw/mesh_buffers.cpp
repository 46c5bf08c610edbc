#include "mesh_buffers.h"

#include <algorithm>
#include <vector>

#include "mesh_program.h"

namespace occlod::viewer {
namespace {

// Sets an attribute of the bound vertex array.
void attribute(const gl::Functions& gl, const gl::Buffer& buffer, GLuint location, GLint size, GLenum type) {
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer.id());
  gl.EnableVertexAttribArray(location);
  gl.VertexAttribPointer(location, size, type, type == GL_UNSIGNED_BYTE ? GL_TRUE : GL_FALSE, 0, nullptr);
}

template <class T>
void store(const gl::Functions& gl, const gl::Buffer& buffer, std::span<const T> data, GLenum usage) {
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer.id());
  gl::fill(gl, GL_ARRAY_BUFFER, data, usage);
}

// Names the elements [first, end) of a buffer.
struct Run {
  std::size_t first = 0;
  std::size_t end = 0;
};

// Gaps of at most this many elements between runs are uploaded too, which is faster than another call.
constexpr std::size_t small_gap = 16;

// Appends `run`, which lies behind the existing ones.
void append(std::vector<Run>& runs, const Run& run) {
  if (!runs.empty() && run.first <= runs.back().end + small_gap)
    runs.back().end = run.end;
  else
    runs.push_back(run);
}

// Stores runs of `data` in the buffer, which has the same size. Returns how many bytes.
template <class T>
std::size_t store_runs(const gl::Functions& gl, const gl::Buffer& buffer, std::span<const T> data,
                       std::span<const Run> runs) {
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer.id());
  std::size_t bytes = 0;
  for (const Run& run : runs) {
    const std::span<const T> part = data.subspan(run.first, run.end - run.first);
    gl.BufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(run.first * sizeof(T)),
                     static_cast<GLsizeiptr>(part.size_bytes()), part.data());
    bytes += part.size_bytes();
  }
  return bytes;
}

}  // namespace

VertexData vertex_data_of(const ViewMesh& mesh) {
  const HierarchyView& data = mesh.hierarchy->data();
  return {data.positions, mesh.normals, mesh.creases, data.colors, data.texture_coordinates, data.wedge_materials};
}

VertexBuffers::VertexBuffers(const gl::Functions& gl)
    : gl_(&gl),
      array_(gl),
      positions_(gl),
      normals_(gl),
      colors_(gl),
      creases_(gl),
      coordinates_(gl),
      materials_(gl),
      image_coordinates_(gl) {}

std::size_t VertexBuffers::fill(const VertexData& vertices, bool is_static) {
  const GLenum usage = is_static ? GL_STATIC_DRAW : GL_DYNAMIC_DRAW;
  has_normals_ = !vertices.normals.empty();
  has_creases_ = !vertices.creases.empty();
  has_colors_ = !vertices.colors.empty();
  has_coordinates_ = !vertices.texture_coordinates.empty();
  has_materials_ = !vertices.materials.empty();
  has_image_coordinates_ = !vertices.image_coordinates.empty();
  store(*gl_, positions_, vertices.positions, usage);
  if (has_normals_) store(*gl_, normals_, vertices.normals, usage);
  if (has_creases_) store(*gl_, creases_, vertices.creases, usage);
  if (has_colors_) store(*gl_, colors_, vertices.colors, usage);
  if (has_coordinates_) store(*gl_, coordinates_, vertices.texture_coordinates, usage);
  if (has_materials_) store(*gl_, materials_, vertices.materials, usage);
  if (has_image_coordinates_) store(*gl_, image_coordinates_, vertices.image_coordinates, usage);
  gl_->BindVertexArray(array_.id());
  describe(positions_);
  return vertices.positions.size_bytes() + vertices.normals.size_bytes() + vertices.creases.size_bytes() +
         vertices.colors.size_bytes() + vertices.texture_coordinates.size_bytes() + vertices.materials.size_bytes() +
         vertices.image_coordinates.size_bytes();
}

void VertexBuffers::describe(const gl::Buffer& positions) const {
  attribute(*gl_, positions, 0, 3, GL_FLOAT);
  if (has_normals_) attribute(*gl_, normals_, 1, 3, GL_FLOAT);
  if (has_colors_) attribute(*gl_, colors_, 2, 4, GL_UNSIGNED_BYTE);
  if (has_creases_) attribute(*gl_, creases_, 3, 1, GL_UNSIGNED_BYTE);
  if (has_coordinates_) attribute(*gl_, coordinates_, 4, 2, GL_FLOAT);
  if (has_image_coordinates_) attribute(*gl_, image_coordinates_, 6, 2, GL_FLOAT);
  if (!has_materials_) return;
  gl_->BindBuffer(GL_ARRAY_BUFFER, materials_.id());
  gl_->EnableVertexAttribArray(5);
  gl_->VertexAttribIPointer(5, 1, GL_UNSIGNED_SHORT, 0, nullptr);
}

void VertexBuffers::bind() const { gl_->BindVertexArray(array_.id()); }

MorphBuffers::MorphBuffers(const gl::Functions& gl, const VertexBuffers& vertices, std::span<const glm::vec3> positions)
    : gl_(&gl), array_(gl), positions_(gl), morphed_(positions) {
  store(gl, positions_, positions, GL_DYNAMIC_DRAW);
  gl.BindVertexArray(array_.id());
  vertices.describe(positions_);
}

std::size_t MorphBuffers::update(std::span<const Geomorph> geomorphs) {
  morphed_.update(geomorphs);
  std::vector<Run> runs;
  for (const VertexId v : morphed_.moved()) append(runs, {v, std::size_t{v} + 1});
  return store_runs(*gl_, positions_, morphed_.positions(), runs);
}

void MorphBuffers::bind() const { gl_->BindVertexArray(array_.id()); }

TriangleBuffers::TriangleBuffers(const gl::Functions& gl) : gl_(&gl), indices_(gl) {}

std::size_t TriangleBuffers::fill(std::span<const Triangle> triangles) {
  capacity_ = triangles.size() + triangles.size() / 8;
  gl_->BindBuffer(GL_ARRAY_BUFFER, indices_.id());
  gl_->BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(capacity_ * sizeof(Triangle)), nullptr, GL_DYNAMIC_DRAW);
  index_count_ = static_cast<GLsizei>(3 * triangles.size());
  const Run all[] = {{0, triangles.size()}};
  return store_runs(*gl_, indices_, triangles, all);
}

std::size_t TriangleBuffers::change(std::span<const Triangle> triangles, std::span<const TriangleRange> changes) {
  if (triangles.size() > capacity_) return fill(triangles);
  std::vector<Run> runs;
  for (const TriangleRange& range : changes) append(runs, {range.first, std::size_t{range.first} + range.count});
  index_count_ = static_cast<GLsizei>(3 * triangles.size());
  return store_runs(*gl_, indices_, triangles, runs);
}

void TriangleBuffers::draw() const {
  gl_->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  gl_->DrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
}

void TriangleBuffers::draw(const TriangleRange& range) const {
  gl_->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  gl_->DrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * range.count), GL_UNSIGNED_INT,
                    reinterpret_cast<const void*>(range.first * sizeof(Triangle)));
}

TriangleColors::TriangleColors(const gl::Functions& gl) : gl_(&gl), texture_(gl) {
  gl.BindTexture(GL_TEXTURE_2D, texture_.id());
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

std::size_t TriangleColors::fill(std::span<const glm::u8vec4> colors) {
  any_ = !colors.empty();
  if (!any_) return 0;
  constexpr int a_row = MeshProgram::texels_a_row;
  const int full_rows = static_cast<int>(colors.size() / a_row);
  const int rest = static_cast<int>(colors.size() % a_row);
  gl_->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
  gl_->BindTexture(GL_TEXTURE_2D, texture_.id());
  if (full_rows + 1 > rows_) {
    rows_ = full_rows + 1;
    gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, a_row, rows_, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  }
  if (full_rows > 0)
    gl_->TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, a_row, full_rows, GL_RGBA, GL_UNSIGNED_BYTE, colors.data());
  if (rest > 0)
    gl_->TexSubImage2D(GL_TEXTURE_2D, 0, 0, full_rows, rest, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                       colors.data() + static_cast<std::size_t>(full_rows) * a_row);
  return colors.size_bytes();
}

void TriangleColors::bind() const {
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindTexture(GL_TEXTURE_2D, texture_.id());
}

}  // namespace occlod::viewer
