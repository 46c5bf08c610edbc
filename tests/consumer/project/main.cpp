// Every layer that needs no GL, once: a generated planet, its hierarchy on disk and back, a refined view, a picture of
// it.
#include <occlod/build_hierarchy.h>
#include <occlod/generate.h>
#include <occlod/picture.h>
#include <occlod/refiner.h>
#include <occlod/scene.h>
#include <occlod/visibility.h>

#include <cstdio>

namespace {

constexpr std::size_t budget = 1000;

bool check(bool holds, const char* what) {
  if (!holds) std::fprintf(stderr, "consumer: %s\n", what);
  return holds;
}

}  // namespace

int main() {
  const occlod::TriangleMesh mesh = occlod::generate("rough-planet", {{"level", 5}});
  const char* file = "consumer.olod";
  occlod::write_olod(file, occlod::build_hierarchy(mesh), {});
  const occlod::Hierarchy hierarchy = occlod::read_olod(file).hierarchy;

  const occlod::RefineObject objects[] = {{.hierarchy = &hierarchy}};
  occlod::Refiner refiner(objects);
  const occlod::View view{occlod::Camera{}};
  const auto visibility = occlod::make_software_occlusion();
  const occlod::Refinement& refined = refiner.refine(view, {.budget = budget}, *visibility);

  const std::vector<occlod::Triangle>& triangles = refined.objects[0].triangles;
  occlod::ItemBuffer items;
  items.reset(view.width(), view.height());
  const occlod::DrawObject drawn[] = {{.positions = hierarchy.positions(), .colors = {}, .triangles = triangles}};
  occlod::draw_items(items, drawn, view);
  const std::size_t visible = occlod::count_visible_items(items, triangles.size());

  std::printf("%zu triangles, %zu visible\n", triangles.size(), visible);
  const bool valid =
      check(occlod::restores(hierarchy, mesh), "full refinement is not the input") &
      check(triangles.size() <= budget, "over budget") &
      // A split on a closed surface adds two triangles, so that a used-up budget is missed by a few at most.
      check(triangles.size() > budget * 9 / 10, "budget not used up") &
      check(visible > triangles.size() / 4, "hardly anything is visible") &
      check(occlod::find_mesh("no such mesh", "").empty(), "found a mesh that is not there");
  return valid ? 0 : 1;
}
