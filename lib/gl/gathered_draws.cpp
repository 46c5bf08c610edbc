#include "gl/gathered_draws.h"

#include <algorithm>
#include <cassert>

#include "gl/node_program.h"

namespace occlod::gl {

DrawKind& GatheredDraws::kind_of(std::uint32_t object, GLuint array) {
  for (DrawKind& kind : std::span(kinds_).first(used_))
    if (kind.object == object && kind.array == array) return kind;
  if (used_ == kinds_.size()) kinds_.emplace_back();
  DrawKind& kind = kinds_[used_++];
  kind.object = object;
  kind.array = array;
  kind.commands.clear();
  kind.morphs.clear();
  return kind;
}

void GatheredDraws::add(std::uint32_t object, const ArenaPlace& place, std::span<const hlod::DrawRange> ranges) {
  DrawKind& kind = kind_of(object, place.array);
  const auto first = static_cast<GLuint>(place.first_index / sizeof(std::uint16_t));
  const std::size_t first_command = kind.commands.size();
  std::uint32_t end = 0;
  for (const hlod::DrawRange& range : ranges) {
    const bool goes_on =
        kind.commands.size() > first_command && range.first_index == end && range.morph == kind.morphs.back();
    end = range.first_index + range.index_count;
    if (goes_on) {
      kind.commands.back().count += range.index_count;
      continue;
    }
    const auto instance = static_cast<GLuint>(kind.commands.size());
    kind.commands.push_back({range.index_count, 1, first + range.first_index, place.base_vertex, instance});
    kind.morphs.push_back(range.morph);
  }
}

void GatheredDraws::draw(const DrawKind& kind) {
  assert(!kind.commands.empty());
  gl_->BindVertexArray(kind.array);
  set_morphs(kind.morphs);
  gl_->BindBuffer(GL_DRAW_INDIRECT_BUFFER, commands_.id());
  fill(*gl_, GL_DRAW_INDIRECT_BUFFER, std::span<const DrawCommand>(kind.commands), GL_STREAM_DRAW);
  gl_->MultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_SHORT, nullptr, static_cast<GLsizei>(kind.commands.size()),
                                 0);
  gl_->DisableVertexAttribArray(NodeProgram::morph_location);
}

// As an array only where they differ: single draws from the same vertex array have one factor for all vertices.
void GatheredDraws::set_morphs(std::span<const GLfloat> morphs) {
  if (std::all_of(morphs.begin(), morphs.end(), [&](GLfloat morph) { return morph == morphs.front(); }))
    return gl_->VertexAttrib1f(NodeProgram::morph_location, morphs.front());
  gl_->BindBuffer(GL_ARRAY_BUFFER, morphs_.id());
  fill(*gl_, GL_ARRAY_BUFFER, morphs, GL_STREAM_DRAW);
  gl_->EnableVertexAttribArray(NodeProgram::morph_location);
  gl_->VertexAttribPointer(NodeProgram::morph_location, 1, GL_FLOAT, GL_FALSE, 0, nullptr);
  gl_->VertexAttribDivisor(NodeProgram::morph_location, 1);
}

}  // namespace occlod::gl
