"""Plots as SVG: points of error against time, with a Pareto front and marked settings; and lines.

Every mark has its colours as attributes, which any program reads that shows or prints SVG. In pages, style() overrides them for
dark backgrounds."""
import html
import math
import textwrap

# Okabe and Ito's colours, which people tell apart whatever they see, darker or lighter where the background asks for it; every series has a shape
# of its own as well.
LIGHT = {"ink": "#1b1f24", "soft": "#57606a", "grid": "#d9dee4", "paper": "#ffffff", "front": "#b8c0c8", "mark": "#b3261e",
         "s0": "#0072b2", "s1": "#b45f00", "s2": "#00805d", "s3": "#8f3f78", "s4": "#5b5f00", "s5": "#00707a", "s6": "#7a4a2b", "s7": "#6a6f77"}
DARK = {"ink": "#e6edf3", "soft": "#9da7b1", "grid": "#30363d", "paper": "#0d1117", "front": "#59636e", "mark": "#ff8a80",
        "s0": "#56b4e9", "s1": "#e69f00", "s2": "#2ec4a0", "s3": "#e08fc4", "s4": "#d9d04a", "s5": "#4fd0dc", "s6": "#d4a27f", "s7": "#8b949e"}
SHAPES = ["M-5 0A5 5 0 1 0 5 0A5 5 0 1 0 -5 0Z", "M-4.5 -4.5H4.5V4.5H-4.5Z", "M0 -6L5.5 4.5H-5.5Z", "M0 -6L6 0L0 6L-6 0Z", "M0 6L5.5 -4.5H-5.5Z",
          "M-6 -2H-2V-6H2V-2H6V2H2V6H-2V2H-6Z", "M-5 -3L0 -6L5 -3V3L0 6L-5 3Z"]
KNOB_SHAPE = "M-3.5 -3.5L3.5 3.5M-3.5 3.5L3.5 -3.5"
KNOBS = "one knob turned"


# How what CSS selects is painted. Colours are those of the themes; `series`: the colour of the line that it belongs to.
PAINT = {"svg text": {"fill": "ink"}, ".soft": {"fill": "soft"}, ".grid": {"fill": "none", "stroke": "grid"},
         ".point path": {"fill": "series", "stroke": "paper", "stroke-width": 1}, ".point.knob path": {"fill": "none", "stroke": "series", "stroke-width": 1.6},
         ".line": {"fill": "none", "stroke": "series", "stroke-width": 1.4, "stroke-opacity": 0.65},
         ".course": {"fill": "none", "stroke": "series", "stroke-width": 1.5, "stroke-linejoin": "round"}, ".diagonal": {"fill": "none", "stroke": "front", "stroke-width": 3},
         ".front": {"fill": "none", "stroke": "front", "stroke-width": 6, "stroke-linejoin": "round", "stroke-linecap": "round"},
         ".inner": {"fill": "none", "stroke": "mark", "stroke-width": 3, "stroke-dasharray": "7 5", "stroke-opacity": 0.6},
         ".mark": {"fill": "none", "stroke": "mark", "stroke-width": 2.5}, ".halo": {"fill": "none", "stroke": "paper", "stroke-width": 5, "stroke-linejoin": "round"},
         "text.marked": {"fill": "mark", "font-weight": 600}}


def paint(selector, series=""):
    """The attributes of a mark, on white. `series`: s0 to s7."""
    return " ".join(f'{name}="{LIGHT.get(series if value == "series" else value, value)}"' for name, value in PAINT[selector].items())


def style():
    """Colours of both themes as CSS variables, and what paints marks with them."""
    def variables(colours):
        return ";".join(f"--{name}:{colour}" for name, colour in colours.items())

    def css(value):
        return "var(--c)" if value == "series" else f"var(--{value})" if value in LIGHT else value
    series = "".join(f".s{i}{{--c:var(--s{i})}}" for i in range(8))
    rules = "".join(f"{selector}{{{';'.join(f'{name}:{css(value)}' for name, value in properties.items())}}}" for selector, properties in PAINT.items())
    return f":root{{{variables(LIGHT)}}}@media (prefers-color-scheme:dark){{:root{{{variables(DARK)}}}}}svg text{{font:12px system-ui,sans-serif}}{rules}{series}"


TITLE_PX, LINE_PX = 24, 16  # a title and a line of text are so high


def heading_px(title, about):
    return TITLE_PX * bool(title) + LINE_PX * len(about)


def heading(title, about):
    """What is shown, and of which scenes: above the plot."""
    if title:
        yield f'<text class="title" x="14" y="22" font-size="15" font-weight="600" {paint("svg text")}>{html.escape(title)}</text>'
    for i, line in enumerate(about):
        yield f'<text class="soft" x="14" y="{heading_px(title, about[:i + 1]) + 2}" {paint(".soft")}>{html.escape(line)}</text>'


def whole_svg(parts, attributes, size, standalone):
    """Standalone ones are files of their own, on white."""
    name = 'xmlns="http://www.w3.org/2000/svg" ' if standalone else ""
    ground = f'<rect width="{size[0]}" height="{size[1]}" fill="{LIGHT["paper"]}"/>' if standalone else ""
    return (f'<svg {name}class="plot" role="img" {attributes} viewBox="0 0 {size[0]} {size[1]}" width="{size[0]}" height="{size[1]}" font-family="Helvetica,Arial,DejaVu Sans,sans-serif" font-size="12">'
            f'{ground}{"".join(parts)}</svg>')


def short(value):
    """Three digits, without an exponent."""
    if value == 0:
        return "0"
    digits = max(0, 2 - math.floor(math.log10(abs(value))))
    return f"{value:,.{digits}f}"


FLOOR = 0.01  # of logarithmic axes: what is less, as errors of pictures that equal the full mesh are, is drawn there


class Axis:
    """Maps values to pixels; logarithmic where asked for and there is anything above the floor."""

    def __init__(self, values, first_px, last_px, logarithmic):
        self.logarithmic = logarithmic and max(values) > FLOOR
        self.first_px, self.last_px = first_px, last_px
        low, high = (self.scaled(min(values)), self.scaled(max(values)))
        margin = 0.06 * (high - low) or (0.3 if self.logarithmic else 1.0)
        self.low, self.high = low - margin, high + margin

    def scaled(self, value):
        return math.log10(max(value, FLOOR)) if self.logarithmic else value

    def px(self, value):
        return self.first_px + (self.scaled(value) - self.low) / (self.high - self.low) * (self.last_px - self.first_px)

    def ticks(self):
        if self.logarithmic:
            decades = range(math.floor(self.low), math.ceil(self.high) + 1)
            for steps in ((1,), (1, 3), (1, 2, 5), (1, 1.5, 2, 3, 4, 5, 6, 8), [1 + i / 10 for i in range(90)]):
                ticks = [m * 10.0**d for d in decades for m in steps
                         if max(self.low, math.log10(FLOOR)) <= math.log10(m * 10.0**d) <= self.high]
                if len(ticks) >= 4:
                    break
            return ticks
        step = 10.0 ** math.floor(math.log10((self.high - self.low) / 3))
        step *= next(m for m in (1, 2, 5, 10) if (self.high - self.low) / (step * m) <= 6)
        return [i * step for i in range(math.ceil(self.low / step), math.floor(self.high / step) + 1)]


def grid(across, up, x_label, y_label):
    left, right, top, bottom = across.first_px, across.last_px, up.last_px, up.first_px
    for tick in across.ticks():
        x = across.px(tick)
        yield f'<path class="grid" data-axis="0" data-at="{tick!r}" d="M{x:.2f} {top}V{bottom}" {paint(".grid")}/>'
        yield f'<text class="soft" x="{x:.1f}" y="{bottom + 16}" text-anchor="middle" {paint(".soft")}>{tick:g}</text>'
    for tick in up.ticks():
        y = up.px(tick)
        yield f'<path class="grid" data-axis="1" data-at="{tick!r}" d="M{left} {y:.2f}H{right}" {paint(".grid")}/>'
        yield f'<text class="soft" x="{left - 6}" y="{y + 4:.1f}" text-anchor="end" {paint(".soft")}>{tick:g}</text>'
    yield f'<text class="axis" x="{(left + right) / 2}" y="{bottom + 36}" text-anchor="middle" {paint("svg text")}>{html.escape(x_label)}</text>'
    yield f'<text class="axis" transform="translate(14 {(top + bottom) / 2}) rotate(-90)" text-anchor="middle" {paint("svg text")}>{html.escape(y_label)}</text>'


class Plot:
    """`points`: dictionaries with setting, series (empty for a turned knob) and the keys x and y."""

    def __init__(self, points, x, y, x_label, y_label, size=(460, 320), log_y=True, legend_px=0, title="", about=()):
        self.points = [p for p in points if p[x] is not None and p[y] is not None]
        self.missing = len(points) - len(self.points)
        self.x, self.y, self.x_label, self.y_label, self.log_y = x, y, x_label, y_label, log_y
        self.title, self.about = title, about  # above the plot; `about`: lines
        self.top = heading_px(title, about)
        self.width, self.height = size[0], size[1] + self.top
        self.legend_px = legend_px  # on the right, where one is drawn in the plot itself
        self.fronts, self.front_names, self.marked, self.series = {}, {}, {}, []  # fronts and their names by class: front, inner
        self.note = ""  # on the marked settings, below the legend

    def svg(self, standalone=False):
        if not self.points:
            return f"<p>{html.escape(self.y_label)}: nothing was measured.</p>"
        across = Axis([p[self.x] for p in self.points], 58, self.width - self.legend_px - 14, True)
        up = Axis([p[self.y] for p in self.points], self.height - 46, self.top + 14, self.log_y)
        place = {p["setting"]: (across.px(p[self.x]), up.px(p[self.y])) for p in self.points}
        parts = [*heading(self.title, self.about), *grid(across, up, self.x_label, self.y_label)]
        for layer in (self.front_lines, self.lines, self.marks, self.dots, self.labels):
            parts += layer(place)
        parts += self.legend() if self.legend_px else []
        log = f"{int(across.logarithmic)}{int(up.logarithmic)}"
        about = f'aria-label="{html.escape(self.y_label)} against {html.escape(self.x_label)}" data-log="{log}" data-floor="{FLOOR}" data-x="{self.x}" data-y="{self.y}"'
        return whole_svg(parts, about, (self.width, self.height), standalone)

    def front_lines(self, place):
        for kind, names in self.fronts.items():
            corners = [place[name] for name in names if name in place]
            if len(corners) > 1:
                yield f'<path class="{kind}" d="M' + "L".join(f"{x:.1f} {y:.1f}" for x, y in corners) + f'" {paint("." + kind)}/>'

    def lines(self, place):
        for name in self.series:
            line = [place[p["setting"]] for p in self.points if p["series"] == name]
            if len(line) > 1:
                series = f"s{self.series.index(name)}"
                yield f'<path class="line {series}" d="M' + "L".join(f"{x:.1f} {y:.1f}" for x, y in line) + f'" {paint(".line", series)}/>'

    def dots(self, place):
        for p in sorted(self.points, key=lambda p: p["series"] != ""):
            x, y = place[p["setting"]]
            kind, drawing = mark_of(self.series.index(p["series"]) if p["series"] else None)
            tip = html.escape(f"{p['setting']}\n{self.x_label}: {short(p[self.x])}\n{self.y_label}: {short(p[self.y])}")
            yield (f'<g class="point {kind}" data-setting="{html.escape(p["setting"])}" data-x="{p[self.x]!r}" data-y="{p[self.y]!r}" '
                   f'transform="translate({x:.2f} {y:.2f})"><title>{tip}</title>{drawing}</g>')

    def legend(self):
        left, below = self.width - self.legend_px, self.top + 20
        for drawing, name in legend_rows(self.series, self.front_names):
            yield f'<g transform="translate({left} {below})">{drawing}<text x="30" y="12" {paint("svg text")}>{html.escape(name)}</text></g>'
            below += 22
        for line in textwrap.wrap(self.note, self.legend_px // 7):
            yield f'<text class="note" x="{left}" y="{below + 18}" {paint("svg text")}>{html.escape(line)}</text>'
            below += LINE_PX

    def marks(self, place):
        return [f'<circle class="mark" data-marked="{html.escape(name)}" cx="{place[name][0]:.2f}" cy="{place[name][1]:.2f}" r="11" {paint(".mark")}/>'
                for name in self.marked if name in place]

    def labels(self, place):
        """Beside their rings, on the side with more room, on a ground of their own: not every program paints the stroke of a text below its fill."""
        for name, text in self.marked.items():
            if name not in place or not text:
                continue
            x, y = place[name]
            side, anchor = (-16, "end") if x > (self.width - self.legend_px) * 0.6 else (16, "start")
            where = f'x="{x + side:.1f}" y="{y - 10:.1f}" text-anchor="{anchor}"'
            yield f'<text class="halo" {where} font-weight="600" {paint(".halo")}>{html.escape(text)}</text>'
            yield f'<text class="marked" {where} {paint("text.marked")}>{html.escape(text)}</text>'


def mark_of(series):
    """Class and drawing of a point; None: of a turned knob."""
    if series is None:
        return "knob s7", f'<path d="{KNOB_SHAPE}" {paint(".point.knob path", "s7")}/>'
    return f"s{series % 8}", f'<path d="{SHAPES[series % len(SHAPES)]}" {paint(".point path", f"s{series % 8}")}/>'


def legend_rows(series, fronts):
    """The drawing in a box of 24 x 16 pixels around (12, 8), and its name."""
    for i, name in [*enumerate(series), (None, KNOBS)]:
        kind, drawing = mark_of(i)
        yield f'<g class="point {kind}" transform="translate(12 8)">{drawing}</g>', name
    for kind, name in fronts.items():
        yield f'<path class="{kind}" d="M2 8H22" {paint("." + kind)}/>', name


def legend_html(series, fronts):
    items = (f'<span><svg viewBox="0 0 24 16" width="24" height="16">{drawing}</svg> {html.escape(name)}</span>' for drawing, name in legend_rows(series, fronts))
    return f'<p class="legend">{"".join(items)}</p>'


DASHES = ["none", "7 3", "2 3", "9 3 2 3", "5 5", "12 4", "1 4"]


class Lines:
    """Lines over a common axis, such as what strategies take frame by frame. `lines`: by name, points (x, y) in order of x. Both axes are linear, that of y
    from 0, unless told otherwise."""

    def __init__(self, lines, x_label, y_label, size=(460, 300), dots=False, from_zero=True, legend_px=0, log_y=False, title="", about=()):
        self.lines = {name: points for name, points in lines.items() if points}
        self.x_label, self.y_label, self.dots, self.from_zero, self.log_y = x_label, y_label, dots, from_zero and not log_y, log_y
        self.title, self.about = title, about  # above the plot; `about`: lines
        self.top = heading_px(title, about)
        self.width, self.height = size[0], size[1] + self.top
        self.legend_px = legend_px  # on the right, where one is drawn in the plot itself
        self.diagonal = False  # where both axes show the same

    def svg(self, standalone=False):
        """There has to be a line."""
        points = [point for line in self.lines.values() for point in line]
        across = Axis([x for x, _ in points], 66, self.width - self.legend_px - 14, False)
        up = Axis([0.0] * self.from_zero + [y for _, y in points], self.height - 46, self.top + 14, self.log_y)
        if self.from_zero:
            up.low = 0.0
        parts = [*heading(self.title, self.about), *grid(across, up, self.x_label, self.y_label)]
        if self.diagonal:
            low, high = max(across.low, up.low), min(across.high, up.high)
            parts.append(f'<path class="diagonal" d="M{across.px(low):.1f} {up.px(low):.1f}L{across.px(high):.1f} {up.px(high):.1f}" {paint(".diagonal")}/>')
        for i, (name, line) in enumerate(self.lines.items()):
            parts += self.line(i, name, [(across.px(x), up.px(y)) for x, y in line], line)
        for i, (drawing, name) in enumerate(self.legend_rows() if self.legend_px else ()):
            parts.append(f'<g transform="translate({self.width - self.legend_px + 6} {self.top + 20 + 22 * i})">{drawing}<text x="40" y="12" {paint("svg text")}>'
                         f'{html.escape(name)}</text></g>')
        about = f'aria-label="{html.escape(self.y_label)} over {html.escape(self.x_label)}" data-y="{html.escape(self.y_label)}"'
        return whole_svg(parts, about, (self.width, self.height), standalone)

    def line(self, i, name, placed, line):
        path = "L".join(f"{x:.1f} {y:.1f}" for x, y in placed)
        mean = sum(y for _, y in line) / len(line)
        yield (f'<path class="course s{i % 8}" stroke-dasharray="{DASHES[i % len(DASHES)]}" data-line="{html.escape(name)}" data-points="{len(line)}" data-mean="{mean!r}" '
               f'd="M{path}" {paint(".course", f"s{i % 8}")}><title>{html.escape(name)}: mean {short(mean)}</title></path>')
        if self.dots:
            for (x, y), (value_x, value_y) in zip(placed, line):
                tip = html.escape(f"{name}\n{self.x_label}: {short(value_x)}\n{self.y_label}: {short(value_y)}")
                yield f'<g class="point s{i % 8}" transform="translate({x:.2f} {y:.2f})"><title>{tip}</title>{mark_of(i)[1]}</g>'

    def legend_rows(self):
        """The drawing in a box of 34 x 16 pixels, and its name."""
        for i, name in enumerate(self.lines):
            dot = f'<g class="point s{i % 8}" transform="translate(17 8)">{mark_of(i)[1]}</g>' if self.dots else ""
            yield f'<path class="course s{i % 8}" stroke-dasharray="{DASHES[i % len(DASHES)]}" d="M2 8H32" {paint(".course", f"s{i % 8}")}/>{dot}', name

    def legend(self):
        """As HTML, below the plot."""
        items = (f'<span><svg viewBox="0 0 34 16" width="34" height="16">{drawing}</svg> {html.escape(name)}</span>' for drawing, name in self.legend_rows())
        return f'<p class="legend">{"".join(items)}</p>'
