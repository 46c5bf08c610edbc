"""The one exception of the package."""


class Error(Exception):
    """A bad file, mesh, option or set-up. Its text is one line: "subject: place: problem; remedy"."""

    subject: str  # the file or object, e.g. "bunny.ply"
    place: str  # where in it, e.g. "line 12"; may be empty
    problem: str  # e.g. "x is not a number"
    remedy: str  # e.g. "export the mesh again"; may be empty

    def __init__(self, subject: str, place: str, problem: str, remedy: str = "") -> None:
        super().__init__(subject, place, problem, remedy)
        self.subject, self.place, self.problem, self.remedy = subject, place, problem, remedy

    def __str__(self) -> str:
        where = ": ".join(part for part in (self.subject, self.place, self.problem) if part)
        return f"{where}; {self.remedy}" if self.remedy else where
