"""Tests `gl-query` on the command line, with EGL and OSMesa as far as the machine has them."""
import os
import unittest

from tool_case import ToolTest


class GlTest(ToolTest):
    def setUp(self):
        super().setUp()
        self.make_hierarchy()

    def arguments(self, *options):
        return ["render", "--budget", 1000, "--size", "320x240", "planet.olod", *options]

    def render(self, *options):
        return self.json_of(*self.arguments(*options))

    def platforms(self):
        found = [name for name in ("egl", "osmesa")
                 if self.run_tool(*self.arguments("--occlusion", "gl-query", "--device", name)).returncode == 0]
        if not found:
            self.skipTest("no OpenGL context")
        return found


class GlBackends(GlTest):
    def test_report(self):
        for platform in self.platforms():
            result = self.render("--occlusion", "gl-query", "--device", platform)
            self.assertEqual(result["occlusion"], "gl-query")
            self.assertTrue(result["gl"]["platform"].startswith(platform), result["gl"])
            self.assert_has_keys(result["gl"], "platform renderer version flight")
            # The planet hides its far side, so what is refined is not what is refined without.
            self.assertGreater(result["queries"], 0)
            self.assertNotEqual(result["hash"], self.render("--occlusion", "none")["hash"])

    def test_is_reproducible(self):
        """Whatever the measured window, which depends on the machine's mood."""
        for platform in self.platforms():
            hashes = {self.render("--occlusion", "gl-query", "--device", platform)["hash"]
                      for _ in range(3)}
            self.assertEqual(len(hashes), 1)


class GlFaults(GlTest):
    """Machines with old drivers or none, as Mesa and GLVND play them."""

    def fail_with(self, variable, value, *options):
        self.environment.update({variable: value, "EGL_LOG_LEVEL": "fatal"})
        line = self.failure_of(*self.arguments(*options))
        del self.environment[variable]
        return line

    def test_driver_too_old(self):
        for platform in self.platforms():
            for version in ("2.1", "3.0"):
                line = self.fail_with("MESA_GL_VERSION_OVERRIDE", version, "--occlusion", "gl-query", "--device", platform)
                self.assertIn("no OpenGL 3.3 core context", line)

    def test_no_driver(self):
        if "egl" not in self.platforms():
            self.skipTest("no EGL")
        for variable, value in (("__EGL_VENDOR_LIBRARY_FILENAMES", "/dev/null"), ("LIBGL_DRIVERS_PATH", "/nonexistent")):
            line = self.fail_with(variable, value, "--occlusion", "gl-query", "--device", "egl")
            self.assertIn("EGL: no OpenGL context", line)
            self.assertIn("install a driver", line)

    def test_software_needs_no_driver(self):
        self.environment.update(__EGL_VENDOR_LIBRARY_FILENAMES="/dev/null", LIBGL_DRIVERS_PATH="/nonexistent")
        self.assertGreater(self.render("--occlusion", "software")["queries"], 0)

    def preload_losing_driver(self, **variables):
        """See tests/support/losing_driver.cpp."""
        self.environment.update(variables, LD_PRELOAD=os.environ["LOSING_DRIVER"])
        if self.run_tool("--version").returncode != 0:
            self.skipTest("SKIPPED: nothing can be preloaded (sanitizers do not allow it)")

    def test_context_lost_while_used(self):
        """Whenever the driver tells it, from the first time that it is asked until it is never asked so often: one line, and without a loss the
        result of every run. It is asked for batches, not for each query: a driver may go into the kernel to answer."""
        whole = {platform: self.render("--occlusion", "gl-query", "--device", platform)
                 for platform in self.platforms()}
        for platform, result in whole.items():
            self.preload_losing_driver(LOSE_CONTEXT_AT="0")
            arguments = self.arguments("--occlusion", "gl-query", "--device", platform)
            lost, kept = -1, 0  # at the last loss that was noticed, and at one that came too late
            while self.run_tool(*arguments).returncode != 0:
                line = self.failure_of(*arguments)
                self.assertIn("occlod: error: OpenGL: ", line)
                self.assertIn("the context is lost: this program has made the GPU reset; run again, or use the software backend", line)
                lost, kept = kept, 2 * kept + 1
                self.environment["LOSE_CONTEXT_AT"] = str(kept)
            self.assertEqual(self.json_of(*arguments)["hash"], result["hash"])
            while kept - lost > 1:
                middle = (lost + kept) // 2
                self.environment["LOSE_CONTEXT_AT"] = str(middle)
                if self.run_tool(*arguments).returncode != 0:
                    lost = middle
                else:
                    kept = middle
            self.assertGreater(kept, 7)
            self.assertLess(kept, result["queries"] / 8)

    def test_driver_without_contexts_that_are_lost(self):
        if "egl" not in self.platforms():
            self.skipTest("no EGL")
        arguments = self.arguments("--occlusion", "gl-query", "--device", "egl")
        whole = self.json_of(*arguments)
        self.preload_losing_driver(REFUSE_LOSING_CONTEXTS="1")
        self.assertEqual(self.json_of(*arguments)["hash"], whole["hash"])


if __name__ == "__main__":
    unittest.main(verbosity=1)
