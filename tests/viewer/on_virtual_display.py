#!/usr/bin/env python3
"""on_virtual_display.py COMMAND...: runs a command on a display of its own, drawn by the CPU. Exit 77, and a line that says
so, where there is no Xvfb."""
import os
import shutil
import subprocess
import sys

SKIPPED = 77


class VirtualDisplay:
    """Xvfb picks a free display and tells its number: no two of them race for one."""

    def __init__(self, *options):
        self.options = options

    def __enter__(self):
        read, write = os.pipe()
        self.server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", "1920x1200x24", "-nolisten", "tcp", "-noreset",
             *self.options],
            pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as numbers:
            number = numbers.readline().strip()
        if not number:
            raise RuntimeError("Xvfb has not started")
        return dict(os.environ, DISPLAY=f":{number}", LIBGL_ALWAYS_SOFTWARE="1", GALLIUM_DRIVER="llvmpipe")

    def __exit__(self, *_):
        self.server.terminate()
        self.server.wait()


def is_available():
    if shutil.which("Xvfb"):
        return True
    print("SKIPPED: Xvfb is not installed (Debian, Ubuntu: xvfb); nothing of the window has been tested")
    return False


if __name__ == "__main__":
    if not is_available():
        sys.exit(SKIPPED)
    with VirtualDisplay() as environment:
        result = subprocess.run(sys.argv[1:], env=environment, check=False)
    sys.exit(result.returncode)
