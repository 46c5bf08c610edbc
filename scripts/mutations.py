#!/usr/bin/env python3
"""mutations.py [NAME...]: switches off each guard of the promises of view cells and of conservative occluders in a copy of the sources (build/mutations), one at a time, and builds
and runs the tests that are named for it. All must pass with the guard, and at least one of them must fail without it. Exit 1 where none does, and
where a guard is no longer found in the sources. One line each; --markdown: as a table (docs/benchmarks/view_cells.md)."""
import argparse
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
WORK = ROOT / "build" / "mutations"
BUILD = WORK / "build" / "release"  # as far from the sources as the usual one: ccache has most of it
CELLS, REFINE, SPLITS = "lib/cells/", "lib/refine/", "lib/splits/"
# Tests are of these programs: the folder under tests/ of each.
PROGRAMS = {"queries": "queries", "viewcells": "viewcells", "viewcells_exact": "viewcells", "hierarchy": "hierarchy"}


class Mutation:
    """What `guard` keeps apart, in `file`: `good` is what the sources have, once, and `bad` is without it. `tests`: {program: gtest filter}."""
    def __init__(self, name, guard, file, good, bad, tests):
        self.name, self.guard, self.file, self.good, self.bad = name, guard, file, good, bad
        self.tests = tests if isinstance(tests, dict) else {"viewcells": tests}


MUTATIONS = [
    # Conservative occluders.
    Mutation("occluder_motion", "faces are grown by how far they have moved", REFINE + "occluder.cpp",
             "MovedFace face{t, motion.moved(ref)};", "MovedFace face{t, 0.0F * motion.moved(ref)};", {"queries": "ConservativeOccluder.*"}),
    Mutation("occluder_marks", "edges whose ends are marked are borders", REFINE + "occluder.cpp",
             "if ((faces_[a.face].marked & both) != both) {", "if (both != 0) {", {"queries": "ConservativeOccluder.*"}),
    Mutation("occluder_erosion", "borders and faces are grown on the screen", REFINE + "occluder.cpp",
             "return slack_px + focal_length_px_ * moved * stretch_", "return 0.0 * moved * stretch_", {"queries": "ConservativeOccluder.*"}),
    # The hull test.
    Mutation("near", "what the near plane may clip hides nothing", CELLS + "hull_test.cpp",
             "grown(cell_, margin + near_reach_)", "grown(cell_, margin)", "HullTest.WhatIsClippedHidesNothing"),
    Mutation("cell_motion", "a surface keeps its motion's distance from the cell", CELLS + "hull_test.cpp",
             "grown(cell_, margin + near_reach_)", "grown(cell_, near_reach_)", "HullTest.MotionKeepsItsDistance"),
    Mutation("box_motion", "and from the box", CELLS + "hull_test.cpp",
             "triangle_meets(a, b, c, grown(what, margin))", "triangle_meets(a, b, c, what)", "HullTest.MotionKeepsItsDistance"),
    Mutation("ends", "no triangle of a flood touches cell or box", CELLS + "hull_test.cpp",
             "if (must_avoid(t, what)) return false;", "static_cast<void>(what);",
             "HullGuards.WhatReaches*"),
    Mutation("border", "a border in the hull is a failure", CELLS + "hull_test.cpp",
             "if (surface_.is_border(edge)) return false;", "", "HullGuards.AWindowThatNoSegmentPassesShowsWhatIsBehindIt"),
    Mutation("border_parity", "an edge of three is a border", CELLS + "cell_surface.cpp",
             "(last - first) % 2 == 1", "last - first == 1", "HullGuards.AFramedWindowShowsWhatIsBehindIt"),
    Mutation("flood", "a flood goes on across edges in the hull", CELLS + "hull_test.cpp",
             "      if (!reach(other / 3)) return false;", "      static_cast<void>(other);", "HullTest.*"),
    Mutation("hull_motion", "the hull is grown by the motion of an edge", CELLS + "hull_test.cpp",
             "surface_.corner(t, k == 2 ? 0 : static_cast<int>(k) + 1), largest)", "surface_.corner(t, k == 2 ? 0 : static_cast<int>(k) + 1), 0.0 * largest)",
             "HullTest.MotionGrowsTheHull"),
    Mutation("edge_motion", "an edge has moved as far as the farther triangle", CELLS + "hull_test.cpp",
             "largest = std::max(largest, growth(other / 3));", ";", "HullGuards.AnEdgeHasMovedAsFarAsTheFartherOfItsTriangles"),
    Mutation("flood_limit", "a flood that is cut off does not hide", CELLS + "hull_test.cpp",
             "if (reached_count_ == max_triangles) return false;", "if (reached_count_ == max_triangles) return true;", "HullGuards.AFloodThatIsCutOffHidesNothing"),
    Mutation("flood_failed", "where an earlier flood failed, so does this one", CELLS + "hull_test.cpp",
             "return reached_by_[t] == flood_;", "return true;", "HullTest.*:HullGuards.*:CellOccluders.*"),
    Mutation("crossing", "a segment crosses the flood", CELLS + "hull_test.cpp",
             "if (!is_crossed(what)) return false;", "", "HullTest.*:HullGuards.*:CellOccluders.*"),
    Mutation("crossing_parity", "an odd number of times", CELLS + "hull_test.cpp",
             "odd = odd != *crossed;", "odd = odd || *crossed;", "HullGuards.ATunnelIsOpen"),
    Mutation("crossing_rounding", "a segment too close to an edge decides nothing", CELLS + "hull.cpp",
             "if (ab == 0 || bc == 0 || ca == 0) return std::nullopt;", "", "HullTest.ASquareHidesIffItHoldsTheSection"),
    # The hull.
    Mutation("hull_planes", "the hull is no smaller than it is", CELLS + "hull.cpp",
             "const double reach = plane.reach + plane.growth * margin;", "const double reach = 0.999 * plane.reach + plane.growth * margin;",
             {"viewcells_exact": "HullExact.*"}),
    Mutation("hull_growth", "its slanted planes move by the margin of both axes", CELLS + "hull.cpp",
             "std::abs(along.x) + std::abs(along.y)}", "std::max(std::abs(along.x), std::abs(along.y))}", {"viewcells_exact": "HullExact.AMarginGrowsBothBoxes"}),
    Mutation("triangle_box", "triangles are held against boxes on the right side", CELLS + "hull.cpp",
             "const double reach = glm::dot(glm::abs(axis), half);", "const double reach = 0.999 * glm::dot(glm::abs(axis), half);",
             {"viewcells_exact": "HullExact.NoTriangleThatMeetsABoxIsMissed"}),
    # Occluders.
    Mutation("motion", "occluders know how far they have moved", CELLS + "cell_surface.cpp",
             "add(object, cut->second, stretch);", "add(object, cut->second, 0.0 * stretch);", "CellOccluders.SheetWithWindows"),
    Mutation("motion_scale", "in world units", CELLS + "cell_surface.cpp",
             "add(object, cut->second, stretch);", "add(object, cut->second, 1.0);", "OccluderGuards.MotionsAreWorldUnitsAndRoundedUp"),
    Mutation("motion_rounding", "rounded up", CELLS + "cell_surface.cpp",
             "moved > 0.0 ? std::nextafter(static_cast<float>(moved), std::numeric_limits<float>::infinity())", "moved > 0.0 ? static_cast<float>(moved)",
             "OccluderGuards.MotionsAreWorldUnitsAndRoundedUp"),
    Mutation("topology_cut", "as no collapse that would close them is repeated", SPLITS + "surface_motion.cpp",
             "if (!keeps) return false;", "static_cast<void>(keeps);", {"viewcells": "CellOccluders.SheetWithWindowsThatMayClose", "hierarchy": "MotionCut.TopologyStays"}),
    Mutation("motion_limit", "what has moved too far stays", SPLITS + "surface_motion.cpp",
             "if (!(after <= max_motion_)) return false;", "", {"viewcells": "CellOccluders.*:HullTest.*", "hierarchy": "MotionCut.*"}),
    Mutation("motion_sum", "motions of one collapse after another add up", SPLITS + "surface_motion.cpp",
             "static_cast<double>(before) + now", "0.0 * static_cast<double>(before) + now", {"viewcells": "CellOccluders.*", "hierarchy": "MotionCut.*"}),
    # Boxes inside solids.
    Mutation("box_cell", "a part that touches the cell hides nothing", CELLS + "hull_test.cpp",
             "if (at_cell_[part]) return false;", "", "InnerBoxes.*"),
    Mutation("box_near", "nor one that the near plane may clip", CELLS + "hull_test.cpp",
             "grown(cell_, near_reach_ + surface_.moved(t) + rounding)", "grown(cell_, surface_.moved(t) + rounding)", "InnerBoxes.WhatIsAtTheCellHidesNothing"),
    Mutation("box_border", "nor one that is open in the hull", CELLS + "hull_test.cpp",
             "      return State::seen;\n  }\n  for", "      static_cast<void>(hull);\n  }\n  for", "BoxGuards.ABlockThatIsOpenInPartHidesNothing"),
    Mutation("box_crossing", "the box is behind an odd number of its triangles", CELLS + "hull_test.cpp",
             "if (odd) return *odd ? State::hidden : State::seen;", "if (odd) return State::hidden;", "InnerBoxes.*"),
    Mutation("box_between", "all segments meet the box", CELLS + "hull_test.cpp",
             "    for (std::size_t j = 0; j < 8; ++j)\n", "    for (std::size_t j = 0; j < 4; ++j)\n", "InnerBoxes.*"),
    Mutation("box_motion", "triangles are farther from a box than they have moved", CELLS + "inner_boxes.cpp",
             "glm::max(a, glm::max(b, c))}, surface.moved(t));", "glm::max(a, glm::max(b, c))}, 0.0 * surface.moved(t));", "InnerBoxes.*"),
    # Cuts.
    Mutation("g", "boxes are grown by g", CELLS + "cell_refinement.cpp",
             "double growth = static_cast<double>(error);", "double growth = 0.0 * static_cast<double>(error);", "CellPromise.HoldsBesideAWall"),
    Mutation("g_faces", "and the boxes of faces to draw", CELLS + "cell_refinement.cpp",
             "const CellBox box = grown_box(view, bounding_box(std::array{a, b, c}), error);", "const CellBox box = grown_box(view, bounding_box(std::array{a, b, c}), 0.0F * error);",
             "CellPromise.HoldsBesideAWall"),
    Mutation("near_cut", "the near plane reaches the hull test", CELLS + "cell_refinement.cpp",
             "const double near_reach = options_.eyes.near / options_.eyes.cos_corner_angle;", "const double near_reach = 0.0;", "CellPromise.HoldsBehindWhatIsClipped"),
    Mutation("near_corner", "in the corners of an image it is farther away", CELLS + "cell_refinement.cpp",
             "options_.eyes.near / options_.eyes.cos_corner_angle", "options_.eyes.near", "CellGuards.TheNearPlaneIsFartherInTheCorners"),
    Mutation("two_sided", "backs of two-sided objects are drawn", CELLS + "cell_refinement.cpp",
             "if (!objects_[object].two_sided && view.faces_away(a, b, c)) return;", "if (view.faces_away(a, b, c)) return;", "CellPromise.*:HardCells.*"),
    # Questions about all eyes of a cell.
    Mutation("corner", "all eight corners of the cell count", CELLS + "cell_builder.cpp",
             "return std::all_of(corners_.begin(), corners_.end(),", "return std::all_of(corners_.begin(), corners_.end() - 1,", "CellFacing.EachCornerCounts"),
    Mutation("corner_cone", "for normal cones as well", CELLS + "cell_builder.cpp",
             "return std::all_of(rounded_corners_.begin(), rounded_corners_.end(),", "return std::all_of(rounded_corners_.begin(), rounded_corners_.end() - 1,",
             "CellFacing.EachCornerCounts"),
    Mutation("facing_rounding", "what rounding decides faces the cell", CELLS + "cell_builder.cpp",
             "return glm::dot(normal, to_eye) < -slack;", "return glm::dot(normal, to_eye) < 0.0 * slack;", {"viewcells_exact": "FacingExact.*"}),
    Mutation("scale_angle", "the corners of an image are magnified twice", CELLS + "cell_builder.cpp",
             "(nearest * cos_angle * cos_angle)", "(nearest * cos_angle)", {"viewcells": "CellScale.*", "viewcells_exact": "ScaleExact.*"}),
    Mutation("scale_distance", "the nearest point of bounds counts", CELLS + "cell_builder.cpp",
             " - static_cast<double>(sphere.radius) * largest_stretch_", "", "CellScale.*"),
    Mutation("scale_stretch", "pixels of an object's unit", CELLS + "cell_builder.cpp",
             "std::min(scale_at_near_px_, eyes_.focal_length_px * largest_stretch_ /", "std::min(scale_at_near_px_, eyes_.focal_length_px /",
             {"viewcells": "CellScale.*", "viewcells_exact": "ScaleExact.*"}),
    Mutation("box_turned", "boxes of turned objects are as wide as they are", CELLS + "cell_builder.cpp",
             "reach += glm::abs(object_to_world_[axis]) * half[axis];", "reach[axis] += glm::abs(object_to_world_[axis])[axis] * half[axis];", "CellView.WorldBoxHoldsTheBox"),
]


def run(*command):
    return subprocess.run([*map(str, command)], cwd=WORK, capture_output=True, text=True)


def copy_sources():
    """What git knows, and what is new: only what has changed is written, so that little is built again."""
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split("\n")
    for name in filter(None, listed):
        source, target = ROOT / name, WORK / name
        if not source.is_file() or (target.exists() and target.read_bytes() == source.read_bytes()):
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, target)


def build(programs):
    """The compiler's first complaint, or nothing."""
    done = run("cmake", "--build", BUILD, "-j", "2", "--target", *[f"test_{program}" for program in programs])
    return "" if done.returncode == 0 else next((line for line in done.stdout.split("\n") if "error:" in line), done.stdout[-500:])


def failed_tests(tests):
    """Names of those that fail; one that ends the program counts as well."""
    failed = []
    for program, wanted in tests.items():
        done = run(BUILD / "tests" / PROGRAMS[program] / f"test_{program}", f"--gtest_filter={wanted}", "--gtest_brief=1")
        names = re.findall(r"^\[  FAILED  \] (\S+?)(?:,.*)? \(\d+ ms\)$", done.stdout, re.M)
        failed += names if names or done.returncode == 0 else [f"{program} was ended"]
        if "[==========] 0 tests" in done.stdout:
            sys.exit(f"mutations: no test of {program} is called {wanted}")
    return failed


def try_out(mutation):
    """The tests that fail without the guard."""
    path = WORK / mutation.file
    text = path.read_text()
    if text.count(mutation.good) != 1:
        sys.exit(f"mutations: {mutation.name}: {mutation.file} has {text.count(mutation.good)} times: {mutation.good}")
    try:
        path.write_text(text.replace(mutation.good, mutation.bad))
        error = build(mutation.tests)
        if error:
            sys.exit(f"mutations: {mutation.name} does not compile: {error}")
        return failed_tests(mutation.tests)
    finally:
        path.write_text(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--markdown", action="store_true")
    options = parser.parse_args()
    unknown = set(options.names) - {mutation.name for mutation in MUTATIONS}
    if unknown:
        sys.exit(f"mutations: there is no {', '.join(sorted(unknown))}")
    chosen = [mutation for mutation in MUTATIONS if not options.names or mutation.name in options.names]
    copy_sources()
    flags = ["-DOCCLOD_BUILD_TESTS=ON", "-DOCCLOD_WARNINGS_AS_ERRORS=ON", "-DOCCLOD_TEST_PCH=ON"]  # as scripts/test.sh
    configured = run("cmake", "--preset", "release", *flags)
    if configured.returncode != 0:
        sys.exit(configured.stderr)
    tests = {}
    for mutation in chosen:
        for program, wanted in mutation.tests.items():
            tests.setdefault(program, []).append(wanted)
    error = build(tests)
    if error:
        sys.exit(f"mutations: {error}")
    failed = failed_tests({program: ":".join(wanted) for program, wanted in tests.items()})
    if failed:
        sys.exit(f"mutations: with all guards these fail: {', '.join(failed)}")
    survived = 0
    if options.markdown:
        print("| guard | switched off in | fails |\n|---|---|---|")
    for mutation in chosen:
        failed = try_out(mutation)
        survived += not failed
        told = ", ".join(f"`{name}`" for name in failed[:2]) + (f" and {len(failed) - 2} more" if len(failed) > 2 else "")
        if options.markdown:
            print(f"| {mutation.guard} | `{pathlib.Path(mutation.file).name}` | {told or '**nothing**'} |", flush=True)
        else:
            print(f"{mutation.name}: {told or 'NOTHING FAILS'}", flush=True)
    if survived:
        sys.exit(f"mutations: without {survived} of {len(chosen)} guards every test passes")


if __name__ == "__main__":
    main()
