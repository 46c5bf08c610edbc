"""rooms_test.py LIB: the rooms of the library use only those above them in lib/CMakeLists.txt, in headers too, and every
public header belongs to one of them."""
import pathlib
import re
import sys
import unittest

LIB = pathlib.Path(sys.argv[1])
ROOMS = re.findall(r"^\s*add_subdirectory\((\w+)\)", (LIB / "CMakeLists.txt").read_text(), re.M)
UMBRELLA = "occlod/occlod.h"


def room_headers(room):
    """Names of the public headers that the room's CMakeLists.txt lists."""
    module = re.search(r"occlod_module\(\w+\s+HEADERS\s+(.*?)\s+SOURCES", (LIB / room / "CMakeLists.txt").read_text(), re.S)
    return [f"occlod/{name}" for name in module[1].split()]


ROOM_OF_HEADER = {header: room for room in ROOMS for header in room_headers(room)}


def included(path):
    """Of the project: Highway wants its own in quotes."""
    names = re.findall(r'^\s*#\s*include\s*"([^"]+)"', path.read_text(encoding="utf-8"), re.M)
    return [name for name in names if not name.startswith("hwy/")]


def room_of(include):
    return ROOM_OF_HEADER.get(include) or include.split("/")[0]


def files_by_room():
    for room in ROOMS:
        for path in [LIB / "include" / header for header in room_headers(room)] + sorted((LIB / room).rglob("*.*")):
            if path.suffix in (".h", ".cpp"):
                yield room, path


class Rooms(unittest.TestCase):
    def test_use_only_those_above_them(self):
        wrong = [f"{path.relative_to(LIB)} includes {name}" for room, path in files_by_room() for name in included(path)
                 if room_of(name) not in ROOMS or ROOMS.index(room_of(name)) > ROOMS.index(room)]
        self.assertEqual(wrong, [])

    def test_every_public_header_has_one(self):
        listed = [header for room in ROOMS for header in room_headers(room)]
        there = [path.relative_to(LIB / "include").as_posix() for path in (LIB / "include").rglob("*.h")]
        self.assertEqual(sorted([*listed, UMBRELLA]), sorted(there))

    def test_a_wrong_include_is_noticed(self):
        self.assertEqual(room_of("occlod/scene.h"), "scene")
        self.assertGreater(ROOMS.index(room_of("occlod/scene.h")), ROOMS.index(room_of("base/text.h")))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
