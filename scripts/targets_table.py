#!/usr/bin/env python3
"""targets_table.py FILE [CSV]: one Markdown table of what refinement and building are asked to reach and what a run of scripts/bench_targets.py
measured; and the same as CSV.

Only the targets stand here; every figure comes from FILE. Everything runs on two hardware threads. Rounds go through both versions in changing
order; other programs can only add to a time, so the least of all rounds counts. What the rows mean:

from scratch, frame to frame   `occlod render --path orbit --json` along the armadillo's orbit, 10,000 triangles: the median of all frames but the
                               first, over that of the earlier version. 100,000: 40 frames of the orbit of `planet_full` with a mesh of level 9
1 M triangles                  the same with `subtree` and no occlusion, 12 frames of the orbit of `planet_full` with a mesh of level 10.
                               `planet_full` itself has 524,288 triangles, of which a budget of a million shows all that face the eye
two threads                    this version with `--threads 2` over the same on one thread
whole frame                    refinement, occlusion, showing the picture and drawing from frame to frame, `star`, 10,000 triangles: with an occluder
                               over without, and with pictures over without
building                       `bench_build_peers`: the whole hierarchy against meshoptimizer simplifying to 1 %, in the mesh where that is worst
same bits                      the pinned hashes on every instruction set of this machine; each path on one thread and on two; a built file
depth RMS, visible share       `occlod render --reference` in the default view of the paper's scenes: `star` with and without occlusion and the
                               paper's LOD with it, against the earlier version; the worst of the three
frame to frame against from    `bench_frames --frames 60`: 114 combinations of path, culling and occlusion; shares are means over frames, the error
scratch                        is the largest visible one, each frame's ratio to that from scratch in the same view
shown pictures                 the same paths: the median frame where the backend is shown each frame's picture, over that with an occluder
frames in a row                the same paths: the most frames in a row, but for the first, that take more than twice the median
`auto`                         `bench_effects --frames 1 --search 1`: its time times error over that of the best fixed setting in 11 scenes
the paper's LOD                depth RMS and silhouettes of `star` with software occlusion over those of the paper's LOD

*Answers* compares hashes. *Same*: the triangles are those of the earlier version. *Differ, expected*: a decision has changed them
(CHANGED_ON_PURPOSE). *As one thread*: two threads give the triangles of one. A row that misses a part of what it needs is *undecided* or *not
measured*, and a note says why. docs/benchmarks/refinement.md has the verdicts."""
import collections.abc
import csv
import dataclasses
import io
import json
import pathlib
import re
import statistics
import sys

PAPER_SCENES = ("armadillo", "armadillo_group", "planet_full", "planet_near")
FRAME_SCENES = (*PAPER_SCENES, "sponza", "city")
STATUES = ("armadillo", "armadillo_group")
OURS, PAPERS = "star + software", "paper's LOD"
COMPARED_WAYS = (OURS, "star", "paper's LOD + software")
# How many there are when no mesh is missing.
COMBINATIONS = 114  # paths of all scenes, cullings, without occlusion, with an occluder and with pictures
EFFECT_SCENES = 11
PICTURE_SCENES = 8

# What is timed along paths: key, what, largest ratio to the time before.
SPEED = (
    ("star_software", "star + software from scratch", 1.0),
    ("subtree_software", "subtree + software from scratch", 1.0),
    ("star", "star from scratch", 1.0),
    ("frames", "star + software frame to frame, 10,000 triangles", 0.75),
    ("frames_100000", "star + software frame to frame, 100,000 triangles", 0.75),
    ("million_level_10", "1 M triangles from scratch, planet of level 10", 1.0),
    ("million_planet_full", "budget of 1 M from scratch, planet_full", 1.0))
# How many times as fast two threads should be as one.
THREADS = (("frames", "10,000 triangles frame to frame", 1.5), ("frames_100000", "100,000 triangles frame to frame", 1.8))
# Of these the triangles may differ from those before: refinement visits bands of nodes (docs/internals/decisions.md), and frames start from there. Where the
# budget holds the whole mesh, and in built files, nothing may.
CHANGED_ON_PURPOSE = {"star_software", "subtree_software", "star", "frames", "frames_100000", "million_level_10", "pictures"}


@dataclasses.dataclass
class Figure:
    """What a row shows of a measurement."""
    now: str
    met: bool | None  # None: a part of what decides is missing; `note` says which
    ratio: str = "-"
    before: str = "-"
    answers: str = "-"
    note: str = ""


@dataclasses.dataclass
class Target:
    what: str
    asked: str
    measure: collections.abc.Callable  # returns a Figure, or raises Missing


class Missing(Exception):
    """Why a row was not measured."""


def part(data, *keys):
    """A part of what was measured."""
    for key in keys:
        if not isinstance(data, dict) or key not in data:
            raise Missing("the earlier version is not there" if key == "reference" else "left out of this run")
        data = data[key]
        if isinstance(data, dict) and "failed" in data:
            raise Missing(data["failed"])
    return data


def least(rounds):
    """Of each frame the least of all rounds: other programs can only add to a time."""
    return [min(times) for times in zip(*rounds)]


def typical(rounds):
    """The median over the frames; not the first, which touches memory."""
    return statistics.median(least(rounds)[1:])


def longest_run_above(times, factor):
    """The most frames in a row, not counting the first, that took more than so many medians."""
    limit, run, longest = factor * statistics.median(times[1:]), 0, 0
    for time in times[1:]:
        run = run + 1 if time > limit else 0
        longest = max(longest, run)
    return longest


def percentile_95(values):
    """Of all but the first frame; None is a ratio without a limit."""
    ordered = sorted(float("inf") if value is None else value for value in values[1:])
    return ordered[int(0.95 * (len(ordered) - 1))]


def of_all(values, most, count, things):
    """(met, "N of M", note) of values that must all be small enough, of which there should be so many."""
    good = sum(value <= most for value in values)
    met = False if good < len(values) else True if len(values) == count else None
    return met, f"{good} of {len(values)}", "" if len(values) == count else f"{len(values)} of {count} {things} were measured"


def compared(before, now, may_change):
    if before == now:
        return "same"
    return "differ, expected" if may_change else "**differ**"


def on_two_threads(one, two):
    return "as one thread" if one == two else "**not as one thread**"


def speed(data, key, most):
    ways = part(data, "paths", key)
    now = typical(part(ways, "present", "rounds"))
    figure = Figure(f"{now:.3g} ms, {ways['present']['triangles']:,} triangles", None)
    if "reference" not in ways:
        figure.note = "the earlier version is not there"
        return figure
    before = typical(ways["reference"]["rounds"])
    figure.before, figure.ratio, figure.met = f"{before:.3g} ms", f"{now / before:.3f}", now <= most * before
    figure.answers = compared(ways["reference"]["hash"], ways["present"]["hash"], key in CHANGED_ON_PURPOSE)
    return figure


def two_threads(data, key, least):
    ways = part(data, "paths", key)
    if "present, 2 threads" not in ways:
        raise Missing("there is one core")
    one, two = (typical(ways[way]["rounds"]) for way in ("present", "present, 2 threads"))
    return Figure(f"{two:.3g} ms", one >= least * two, f"{one / two:.3f}", f"{one:.3g} ms",
                  on_two_threads(ways["present"]["hash"], ways["present, 2 threads"]["hash"]))


def whole_frame(data, scene, way, most):
    versions = part(data, "whole_frame", scene)
    times = {name: (typical(ways[way]), typical(ways["none"])) for name, ways in versions.items() if way in ways}
    ratios = {name: occluded / none for name, (occluded, none) in times.items()}
    occluded, none = times["present"]
    return Figure(f"{occluded:.3g} / {none:.3g} ms", ratios["present"] <= most, f"{ratios['present']:.3f}",
                  f"{ratios['reference']:.3f}" if "reference" in ratios else "-")


def build_times(data):
    """By mesh and tool: the least ms of building, or of simplifying to 1 %. Building on all cores, which are two, is the tool "2 threads"."""
    times = {}
    for row in part(data, "programs", "building"):
        if row["target_triangles"] == max(row["input_triangles"] // 100, 4):
            tool = re.sub(r"^occlod, (\d+ threads)$", r"\1", row["tool"])
            times.setdefault(row["mesh"], {})[tool] = min(row["milliseconds"])
    return times


def building(data, tool, over, asked):
    """How many times as quick as another tool, in the mesh where that is least."""
    times = build_times(data)
    paces = {mesh: tools[over] / tools[tool] for mesh, tools in times.items() if over in tools and tool in tools}
    if not paces:
        raise Missing(f"{tool} or {over} was not there")
    mesh = min(paces, key=paces.get)
    return Figure(f"{times[mesh][tool]:.0f} against {times[mesh][over]:.0f} ms ({mesh}, the least of {len(paces)} meshes)", paces[mesh] >= asked,
                  f"{paces[mesh]:.3f}")


def same_on_every_machine(data):
    """Pinned hashes, which are tested on every instruction set of this machine; and one thread beside two."""
    pinned, files = part(data, "hashes", "pinned"), part(data, "hashes", "built", "present")
    runs = {key: ways["present, 2 threads"]["hash"] == ways["present"]["hash"] for key, ways in data.get("paths", {}).items()
            if "present, 2 threads" in ways}
    runs["built files"] = files["1"] == files["2"]
    wrong = [name for name, passed in (pinned | runs).items() if not passed]
    return Figure(f"{sum(pinned.values())} of {len(pinned)} tests of pinned hashes, {sum(runs.values())} of {len(runs)} runs on two threads", not wrong,
                  answers="same" if not wrong else "**differ**", note=", ".join(wrong))


def unchanged(data):
    """What no decision has changed."""
    files = part(data, "hashes", "built")
    same = {"built files": part(files, "reference", "1") == part(files, "present", "1")}
    for key, ways in data.get("paths", {}).items():
        if key not in CHANGED_ON_PURPOSE and "reference" in ways:
            same[key] = ways["reference"]["hash"] == ways["present"]["hash"]
    wrong = [name for name, passed in same.items() if not passed]
    return Figure(f"{sum(same.values())} of {len(same)} ({', '.join(same)})", not wrong,
                  answers="same" if not wrong else "**differ**", note=", ".join(wrong))


def pictures_of(data, scene):
    return part(data, "pictures", scene, "reference"), part(data, "pictures", scene, "present")


def depth_error(data, scene, most):
    """In the way in which it has grown most."""
    before, now = pictures_of(data, scene)
    ratios = {way: now[way]["depth_rms_px"] / before[way]["depth_rms_px"] for way in COMPARED_WAYS}
    way = max(ratios, key=ratios.get)
    return Figure(f"{now[way]['depth_rms_px']:.3f} px ({way}, the worst of {len(ratios)} ways)", ratios[way] <= most, f"{ratios[way]:.3f}",
                  f"{before[way]['depth_rms_px']:.3f} px", compared(before[way]["hash"], now[way]["hash"], "pictures" in CHANGED_ON_PURPOSE))


def visible_share(data, scene, most):
    before, now = pictures_of(data, scene)
    gains = {way: 100 * (now[way]["visible_share"] - before[way]["visible_share"]) for way in COMPARED_WAYS}
    way = min(gains, key=gains.get)
    return Figure(f"{100 * now[way]['visible_share']:.2f} % ({way}, the worst of {len(gains)} ways)", -gains[way] <= most, f"{gains[way]:+.2f} points",
                  f"{100 * before[way]['visible_share']:.2f} %", compared(before[way]["hash"], now[way]["hash"], "pictures" in CHANGED_ON_PURPOSE))


def name_of(row):
    return f"{row['scene']} {row['path']}, {row['culling']} + {row['occlusion']}"


def shares(row):
    """Percent from frame to frame and from scratch, means over the frames."""
    return [100 * statistics.fmean(row[key]) for key in ("frame_shares", "scratch_shares")]


def share_on_orbit(data, most):
    for row in part(data, "programs", "frames"):
        if name_of(row) == f"armadillo orbit, {OURS}":
            frames, scratch = shares(row)
            return Figure(f"{frames:.1f} against {scratch:.1f} %", scratch - frames <= most, f"{frames - scratch:+.1f} points")
    raise Missing("the scene armadillo was not there")


def worst_combination(data, figure_of, most, text):
    figures = {name_of(row): figure_of(row) for row in part(data, "programs", "frames")}
    if not figures:
        raise Missing("no path could be measured")
    name = max(figures, key=figures.get)
    met, counted, note = of_all(figures.values(), most, COMBINATIONS, "combinations")
    return Figure(f"{counted}; worst: {name}", met, text(figures[name]), note=note)


def frame_ms(row):
    """The median frame but the first, of each frame the least of all rounds."""
    return statistics.median([min(frame) for frame in zip(*row["frame_cpu_ms"])][1:])


def shown_pictures(data, scene, most):
    """In the path of the scene that gains least."""
    of = {(row["path"], row["occlusion"]): row for row in part(data, "programs", "frames") if row["scene"] == scene and row["culling"] == "star"}
    ratios = {path: frame_ms(row) / frame_ms(of[path, "software"]) for (path, occlusion), row in of.items() if occlusion == "picture"}
    if not ratios:
        raise Missing(f"the scene {scene} was not there")
    path = max(ratios, key=ratios.get)
    row = of[path, "picture"]
    lost = shares(of[path, "software"])[0] - shares(row)[0]
    return Figure(f"{frame_ms(row):.2f} ms on {path}, {lost:.1f} points less share", ratios[path] <= most, f"{ratios[path]:.2f}",
                  f"{frame_ms(of[path, 'software']):.2f} ms")


def share_loss(row):
    frames, scratch = shares(row)
    return scratch - frames


def auto(data, column, most):
    ratios = {row["scene"]: float(row[column]) for row in part(data, "programs", "effects")}
    if not ratios:
        raise Missing("no scene could be measured")
    scene = max(ratios, key=ratios.get)
    met, counted, note = of_all(ratios.values(), most, EFFECT_SCENES, "scenes")
    return Figure(f"{counted}; worst: {scene}", met, f"{ratios[scene]:.3f}", note=note)


def beside_the_papers(data, scene, most):
    pictures = part(data, "pictures", scene, "present")
    ours, papers = (pictures[way]["depth_rms_px"] for way in (OURS, PAPERS))
    return Figure(f"{ours:.3f} against {papers:.3f} px", ours <= most * papers, f"{ours / papers:.3f}")


def silhouettes(data):
    """Percent of the silhouettes' pixels, ours and the paper's, in the scene where ours are worst by comparison."""
    figures = {}
    for scene, versions in part(data, "pictures").items():
        if "present" in versions:
            figures[scene] = [versions["present"][way]["silhouette_mismatch"] for way in (OURS, PAPERS)]
    if not figures:
        raise Missing("no scene could be measured")
    excess = {scene: ours - papers for scene, (ours, papers) in figures.items()}
    scene = max(excess, key=excess.get)
    met, counted, note = of_all(excess.values(), 0.0, PICTURE_SCENES, "scenes")
    ours, papers = figures[scene]
    return Figure(f"{counted}; worst: {scene}, {ours:.3f} against {papers:.3f} %", met, f"{ours / papers:.3f}" if papers else "-", note=note)


def targets():
    """Targets of the data that their functions are given."""
    def target(what, asked, function, *arguments):
        return Target(what, asked, lambda data: function(data, *arguments))
    yield from (target(what, f"<= {most} x", speed, key, most) for key, what, most in SPEED)
    yield from (target(f"two threads over one, {what}", f">= {least} x", two_threads, key, least) for key, what, least in THREADS)
    for scene in PAPER_SCENES:
        yield target(f"whole frame with an occluder over without, {scene}", "<= 1.3", whole_frame, scene, "software", 1.3)
        yield target(f"whole frame with pictures over without, {scene}", "<= 1.15", whole_frame, scene, "picture", 1.15)
    yield from (target(f"frame with a picture over one with an occluder, {scene}", "<= 0.8", shown_pictures, scene, 0.8) for scene in FRAME_SCENES)
    yield target("building over meshoptimizer, one thread", ">= 0.65 x", building, "occlod", "meshoptimizer", 0.65)
    yield target("building over meshoptimizer, two threads", ">= 0.65 x", building, "2 threads", "meshoptimizer", 0.65)
    yield target("building on two threads over one", ">= 1.7 x", building, "2 threads", "occlod", 1.7)
    yield target("the same bits for any number of threads and instruction set", "all", same_on_every_machine)
    yield target("the same bits as before where no decision has changed them", "all", unchanged)
    for scene in PAPER_SCENES:
        yield target(f"depth RMS, {scene}", "<= 1.005 x", depth_error, scene, 1.005)
        yield target(f"visible share, {scene}", ">= -0.3 points", visible_share, scene, 0.3)
    yield target("visible share, frame to frame against from scratch, armadillo's orbit", ">= -2 points", share_on_orbit, 2.0)
    yield target("visible share, frame to frame against from scratch, all combinations", ">= -2 points", worst_combination, share_loss, 2.0,
                 lambda loss: f"{-loss:+.1f} points")
    yield target("largest visible error, frame to frame over from scratch, 95th percentile, all combinations", "<= 1.1",
                 worst_combination, lambda row: percentile_95(row["error_ratios"]), 1.1, lambda ratio: f"{ratio:.3f}")
    yield target("frames in a row above twice the median time, all combinations", "<= 1", worst_combination,
                 lambda row: longest_run_above(least(row["frame_cpu_ms"]), 2.0), 1, str)
    yield target("auto over the best fixed setting, settled, all scenes", "<= 1.05", auto, "auto_to_best", 1.05)
    yield target("auto over the best fixed setting, jumping, all scenes", "<= 1.15", auto, "jumping_to_best", 1.15)
    yield from (target(f"depth RMS over the paper's LOD's, {scene}", "<= 0.45", beside_the_papers, scene, 0.45) for scene in STATUES)
    yield target("silhouettes against the paper's LOD's, all scenes", "<= 1 x", silhouettes)


def judge(data):
    """(target, figure) for every target, also for those that were not measured."""
    for target in targets():
        try:
            yield target, target.measure(data)
        except Missing as missing:
            yield target, Figure("-", None, note=str(missing))


def verdict(figure):
    if figure.met is None:
        return "not measured" if figure.now == "-" else "undecided"
    return "met" if figure.met else "**missed**"


HEADINGS = ("what", "asked", "before", "now", "ratio", "verdict", "answers")


def cells(target, figure):
    return target.what, target.asked, figure.before, figure.now, figure.ratio, verdict(figure), figure.answers


def markdown(data):
    about, judged = data["about"], list(judge(data))
    lines = [f"{about['commit']}, {about['date']}: {about['processor']}, {about['cores']} cores, load {about['load_before']:.1f} before and "
             f"{about['load_after']:.1f} after, {about['seconds'] / 60:.0f} minutes{', --quick' if about['quick'] else ''}.", ""]
    lines += [f"| {' | '.join(HEADINGS)} |", "|---" * len(HEADINGS) + "|", *(f"| {' | '.join(cells(*pair))} |" for pair in judged), ""]
    notes = [f"- {target.what}: {figure.note}" for target, figure in judged if figure.note]
    lines += [*notes, ""] if notes else []
    met, missed, open_ = (sum(figure.met is value for _, figure in judged) for value in (True, False, None))
    return "\n".join([*lines, f"{met} met, {missed} missed, {open_} not measured or undecided."])


def as_csv(data):
    """The same rows; what is not there is empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEADINGS)
    writer.writerows(["" if cell == "-" else cell.replace("**", "") for cell in cells(*pair)] for pair in judge(data))
    return text.getvalue()


def main(arguments):
    if len(arguments) not in (1, 2):
        sys.exit("targets_table.py: give it the file that scripts/bench_targets.py has written, and where CSV is to go if it is wanted")
    try:
        data = json.loads(pathlib.Path(arguments[0]).read_text())
    except (OSError, ValueError) as error:
        sys.exit(f"targets_table.py: {arguments[0]}: {error}: run scripts/bench_targets.sh")
    print(markdown(data))
    if len(arguments) == 2:
        pathlib.Path(arguments[1]).write_text(as_csv(data))


if __name__ == "__main__":
    main(sys.argv[1:])
