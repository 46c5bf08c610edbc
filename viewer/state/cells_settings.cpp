// Lists the settings of the walk through view cells, and of what it shows.
#include "setting_kinds.h"

namespace occlod::viewer {

std::span<const Setting> cells_settings() {
  static const std::vector<Setting> settings = {
      toggle(
          {"walk_cells", "Walk", "Draw what the cell of the eye has to draw, instead of refining"},
          [](auto& s) -> auto& { return s.cells.walk; }),
      toggle(
          {"cells_prefetch", "Prefetch", "Load cells before the eye is in them"},
          [](auto& s) -> auto& { return s.cells.prefetch; }),
      number(
          {"cells_memory", "Memory", "Most that cells may take in memory"}, {0.01, 16384.0, true, "MB"},
          [](auto& s) -> auto& { return s.cells.memory_mb; }),
      number(
          {"cells_disk", "Disk",
           "Simulate a disk of this speed, while a picture lasts a sixtieth of a second; 0: reading takes no time"},
          {0.0, 2000.0, true, "MB/s"}, [](auto& s) -> auto& { return s.cells.disk_mb_s; }),
      number(
          {"cells_latency", "Latency", "What each read takes on the simulated disk, besides its bytes"},
          {0.0, 200.0, false, "ms"}, [](auto& s) -> auto& { return s.cells.latency_ms; }),
      choice(
          {"cells_color_by", "Colour by",
           "kept: seen in this picture, drawn but unseen in it, or left out since it faces away from all of the cell "
           "or "
           "is hidden from it"},
          {"plain", "vertices", "level", "error", "kept"}, [](auto& s) -> auto& { return s.cells.color_by; }),
      toggle(
          {"cells_left_out", "What is left out", "Draw the faces too that are left out for the cell"},
          [](auto& s) -> auto& { return s.cells.left_out; }),
      choice(
          {"cell_boxes", "Boxes",
           "The cell of the eye; or those near it, by their triangles, error, the bytes that a jump there reads, or "
           "whether they were late"},
          {"none", "cell", "triangles", "error", "bytes", "late"}, [](auto& s) -> auto& { return s.cells.boxes; }),
  };
  return settings;
}

}  // namespace occlod::viewer
