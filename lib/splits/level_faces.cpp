#include "splits/level_faces.h"

namespace occlod {

LevelFaces::LevelFaces(const CollapseSequence& sequence) : sequence_(sequence) {
  list_ended();
  find_makers();
  // Counting sort by maker; afterwards first_made_[c + 1] has moved up to where the next one's faces begin.
  first_made_.assign(collapse_count() + 2, 0);
  for (FaceId f = 0; f < face_count(); ++f)
    if (const CollapseIndex c = maker(f); c != no_id) ++first_made_[c + 2];
  for (std::size_t c = 2; c < first_made_.size(); ++c) first_made_[c] += first_made_[c - 1];
  made_.resize(first_made_.back());
  for (FaceId f = 0; f < face_count(); ++f)
    if (const CollapseIndex c = maker(f); c != no_id) made_[first_made_[c + 1]++] = f;
  first_made_.pop_back();
}

void LevelFaces::list_ended() {
  for (const Collapse* collapse : sequence_.collapses) {
    first_ended_.push_back(face_count());
    for (std::uint32_t slot = 0; slot < collapse->ended_count(); ++slot)
      faces_.push_back({collapse->ended(slot), no_id});
  }
  first_ended_.push_back(face_count());
  for (const LevelFace& face : sequence_.base) faces_.push_back({face.corners, sequence_.place(face.made_by)});
}

void LevelFaces::find_makers() {
  for (CollapseIndex c = 0; c < collapse_count(); ++c)
    for (std::uint32_t slot = 0; collapse(c).is_fan() && slot < collapse(c).ended_count(); ++slot)
      if (const Collapse::EndedFace face = collapse(c).successor(slot); face.ended_by != no_id)
        faces_[first_ended_[sequence_.place(face.ended_by)] + face.slot].made_by = c;
  for (const MisplacedFace& face : sequence_.misplaced)
    faces_[first_ended_[sequence_.place(face.ended_by)] + face.slot].made_by = sequence_.place(face.made_by);
}

}  // namespace occlod
