"""JSON values that know where they are: whatever is asked of one and is not so ends in Wrong, which names the file and the place in it."""
import json
import math


class Wrong(Exception):
    """One line: FILE: PLACE: what is wrong there."""


def quoted(text):
    """As in JSON, with escapes for all but ASCII and without what makes a line too long."""
    return json.dumps(text if len(text) <= 60 else text[:57] + "...")


class Place:
    """A value of a JSON file and the way to it, such as root.children[3].content; the file as it is named in messages."""

    def __init__(self, value, file, way=""):
        self.value, self.file, self.way = value, file, way

    def fail(self, problem):
        file = self.file if self.file.isprintable() else quoted(self.file)
        raise Wrong(f"{file}: {self.way}{': ' if self.way else ''}{problem}")

    def require(self, condition, problem):
        if not condition:
            self.fail(problem)

    def object(self, required=(), allowed=None):
        """Itself, an object with the required keys; with others only where they are allowed, or None is."""
        self.require(isinstance(self.value, dict), "is no object")
        for key in required:
            self.require(key in self.value, f"has no {key}")
        for key in self.value if allowed is not None else ():
            self.require(key in required or key in allowed, f"has an unknown key {quoted(key)}")
        return self

    def __contains__(self, key):
        return key in self.object().value

    def __getitem__(self, key):
        """A member, which has to be there."""
        self.object([key])
        return Place(self.value[key], self.file, f"{self.way}{'.' if self.way else ''}{key}")

    def list(self):
        self.require(isinstance(self.value, list), "is no list")
        return [Place(item, self.file, f"{self.way}[{k}]") for k, item in enumerate(self.value)]

    def number(self):
        """As a float, finite."""
        try:
            number = float(self.value) if type(self.value) in (int, float) else math.nan
        except OverflowError:
            number = math.inf
        self.require(math.isfinite(number), "is no finite number")
        return number

    def numbers(self, count):
        self.require(isinstance(self.value, list) and len(self.value) == count, f"is not {count} numbers")
        return [item.number() for item in self.list()]

    def integer(self, least=0):
        self.require(type(self.value) is int and self.value >= least, f"is no integer of at least {least}")
        return self.value

    def index_in(self, items, what):
        """The item that it is the index of."""
        self.require(self.integer() < len(items), f"names {what} that is not there")
        return items[self.value]

    def text(self):
        self.require(isinstance(self.value, str) and self.value, "is no text, or an empty one")
        return self.value


def parse(data, file):
    """The bytes of a JSON file, or of a part of it, as a Place."""
    whole = Place(None, file)

    def members(pairs):
        keys = set()
        for key, _ in pairs:
            whole.require(key not in keys, f"has the key {quoted(key)} twice in one object")
            keys.add(key)
        return dict(pairs)

    try:
        whole.value = json.loads(data.decode("utf-8"), object_pairs_hook=members, parse_constant=lambda text: whole.fail(f"is no JSON: {text} is no number"))
    except RecursionError:
        whole.fail("is nested too deeply")
    except ValueError as error:  # of the decoder, of UTF-8, and of integers with thousands of digits
        whole.fail(f"is no JSON: {error}")
    return whole
