#!/usr/bin/env python3
"""count_tests.py BUILD_DIR JUNIT [--failed N] [--skipped LINE...]: what became of the single tests of a run of ctest, JUNIT being the file that its --output-junit
wrote. Prints which tests were skipped and why, grouped by the reason, then "N passed, N failed, N skipped".
--failed and --skipped bring in what is checked beside tests, one count each; the lines are printed among those that were skipped.

An entry of ctest is a program. GoogleTest says in BUILD_DIR/Testing/gtest/ENTRY.xml, and Python's unittest in the last lines of its
output, what became of each test in it; a program that says nothing counts as one test. One that failed without a failed
test (it crashed, or ran out of time) counts as one more that failed."""
import argparse
import collections
import pathlib
import re
import xml.etree.ElementTree as ElementTree

RAN = re.compile(r"^Ran (\d+) tests? in ", re.M)
FAILURES = re.compile(r"^FAILED \((.*)\)$", re.M)
SKIPS = re.compile(r"^(?:OK|FAILED) \(.*?skipped=(\d+)", re.M)
REASON = re.compile(r"""\.\.\. skipped ['"](.*)['"]$|^SKIPPED: (.*)$""", re.M)


class Counts:
    def __init__(self):
        self.passed = self.failed = 0
        self.skipped = collections.defaultdict(list)  # the tests' names by reason

    def skip(self, reason, name):
        self.skipped[re.sub(r"^SKIPPED:? *", "", reason.strip().splitlines()[0] if reason.strip() else "no reason given")].append(name)

    def count_skipped(self):
        return sum(map(len, self.skipped.values()))


def count_gtest(path, failed_entry, counts):
    before = counts.failed
    for case in ElementTree.parse(path).iter("testcase"):
        skipped = case.find("skipped")
        if case.get("status") == "notrun":
            continue  # not part of this entry
        if case.find("failure") is not None:
            counts.failed += 1
        elif skipped is not None:
            # "FILE:LINE\nreason"
            counts.skip((skipped.get("message") or "").split("\n", 1)[-1], f"{case.get('classname')}.{case.get('name')}")
        else:
            counts.passed += 1
    if failed_entry and counts.failed == before:
        counts.failed += 1


def count_unittest(name, output, failed_entry, counts):
    ran = int(RAN.findall(output)[-1])
    wrong = FAILURES.findall(output)
    failed = sum(int(number) for number in re.findall(r"(?:failures|errors)=(\d+)", wrong[-1])) if wrong else 0
    skips = SKIPS.findall(output)
    skipped = int(skips[-1]) if skips else 0
    reasons = [one or other for one, other in REASON.findall(output)]
    for at in range(skipped):
        counts.skip(reasons[at] if at < len(reasons) else f"see the output of {name}", name)
    counts.failed += max(failed, int(failed_entry))
    counts.passed += ran - failed - skipped


def count(build_dir, junit):
    counts = Counts()
    for entry in ElementTree.parse(junit).iter("testcase"):
        name, status = entry.get("name"), entry.get("status")
        output = entry.findtext("system-out") or ""
        results = build_dir / "Testing" / "gtest" / f"{name}.xml"
        if status == "notrun" or entry.find("skipped") is not None:
            reasons = [one or other for one, other in REASON.findall(output)]
            counts.skip(reasons[0] if reasons else entry.find("skipped").get("message", ""), name)
        elif results.exists():
            count_gtest(results, status == "fail", counts)
        elif RAN.search(output):
            count_unittest(name, output, status == "fail", counts)
        elif status == "fail":
            counts.failed += 1
        else:
            counts.passed += 1
    return counts


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("build_dir", type=pathlib.Path)
    parser.add_argument("junit", type=pathlib.Path)
    parser.add_argument("--failed", type=int, default=0)
    parser.add_argument("--skipped", nargs="*", default=[])
    arguments = parser.parse_args()
    counts = Counts()
    if arguments.junit.exists():
        counts = count(arguments.build_dir, arguments.junit)
    else:
        print(f"count_tests: {arguments.junit} is missing: no test ran")
        counts.failed += 1
    for reason, names in sorted(counts.skipped.items()):
        print(f"SKIPPED: {len(names)} {'test' if len(names) == 1 else 'tests'} ({', '.join(sorted(set(names))[:3])}"
              f"{', ...' if len(set(names)) > 3 else ''}): {reason}")
    print(*arguments.skipped, sep="\n", end="\n" if arguments.skipped else "")
    all_failed, all_skipped = counts.failed + arguments.failed, counts.count_skipped() + len(arguments.skipped)
    print(f"{counts.passed} passed, {all_failed} failed" + (f", {all_skipped} skipped" if all_skipped else ""))


if __name__ == "__main__":
    main()
