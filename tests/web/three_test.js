// The package @occlod/three.
import assert from "node:assert/strict";
import test from "node:test";

test("the package @occlod/three is found", async () => {
  assert.ok(await import("@occlod/three"));
});
