// Explains the numbers of the strip at the bottom.
#include <array>
#include <utility>

#include "controls.h"

namespace occlod::viewer {
namespace {

using Help = std::pair<std::string_view, const char*>;

constexpr std::array<Help, 11> of_meshes = {
    {{"triangles", "Triangles of the mesh that is drawn, of all objects"},
     {"splits", "Vertex splits that have been applied to the base meshes"},
     {"visible", "Triangles that own at least one pixel, and their share"},
     {"forced", "Splits of the last mesh that were made only because others depend on them"},
     {"largest error",
      "Largest error left on visible surface: the quadric error, about the root mean square distance to the full mesh"},
     {"its bound", "No point of the visible surface is farther off: a guarantee, often many times the true error"},
     {"queries", "Occlusion queries of the last mesh: boxes that were asked about"},
     {"memory", "Memory of this program"},
     {"hidden", "Of the queries, those answered that nothing is visible"},
     {"split, merged", "What the last mesh changed from the one before; pending: a limit has left work over"},
     {"changed", "Triangles that the last mesh changed from the one before"}}};

constexpr std::array<Help, 8> of_hlods = {
    {{"nodes (DN)", "Nodes that are drawn"},
     {"drawn twice", "RARN: nodes that were drawn, and refined in the same frame"},
     {"delayed (D)", "Nodes that were drawn only when the answer to their query came"},
     {"wasted", "Queries that were answered \"visible\" and decided nothing"},
     {"node error", "Largest error of a node that is drawn, by its nearest point; visibility does not reduce it here"},
     {"blocked", "Nodes that were drawn since one of their parents was not refined"},
     {"front", "Hash of what is drawn: the same nodes have the same"},
     {"stall", "Time for which the processor waited for answers to queries"}}};

constexpr std::array<Help, 7> of_cells = {{{"cell", "The view cell in which the eye is"},
                                           {"late frames", "Pictures whose cell had not been loaded in time"},
                                           {"error bound", "Nothing seen from the cell is farther from what is drawn"},
                                           {"crossings", "How often the eye went into another cell"},
                                           {"of cells", "Memory of the cells that are loaded"},
                                           {"read", "Bytes read of the file of cells"},
                                           {"loads", "Cells that have been loaded"}}};

constexpr std::array<Help, 5> of_times = {{{"refine", "Time to refine the mesh, without occlusion queries"},
                                           {"frame", "Time of the frame on the device that draws HLODs"},
                                           {"occlusion", "Time of occluders and occlusion queries"},
                                           {"upload", "Time to upload what has changed"},
                                           {"draw", "Time in which OpenGL drew the picture"}}};

}  // namespace

const char* help_of_number(std::string_view name) {
  const auto find = [&](const auto& helps) -> const char* {
    for (const auto& [known, help] : helps)
      if (known == name) return help;
    return nullptr;
  };
  for (const char* help : {find(of_meshes), find(of_hlods), find(of_cells), find(of_times)})
    if (help != nullptr) return help;
  return "";
}

}  // namespace occlod::viewer
