#include "level_faces.h"

namespace occlod {

LevelFaces::LevelFaces(const CollapseSequence& sequence) : sequence_(sequence) {
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

}  // namespace occlod
