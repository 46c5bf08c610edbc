#!/usr/bin/env bash
# Sets up, builds, and refines the four scenes of Birkholz & Rahn to 10,000 triangles: with the culling of the paper and with ours, without
# occlusion, with the software backend and with OpenGL queries. Prints one table; pictures and reports go to out/demo/.
set -euo pipefail
cd "$(dirname "$0")/.."

budget=10000
repeat=3
scenes=(armadillo armadillo_group planet_full planet_near)
cullings=(subtree star)
backends=(none software gl-query)
out=out/demo

scripts/setup.sh
scripts/build.sh demo
scripts/get_demo_meshes.sh || echo "demo: going on with the meshes that are there" >&2

rm -rf "$out"
mkdir -p "$out"
failed=0
for scene in "${scenes[@]}"; do
  for culling in "${cullings[@]}"; do
    for backend in "${backends[@]}"; do
      name=$out/${scene}_${culling}_${backend}
      options=()
      [ "$culling" = star ] || options=(--paper)
      echo "$scene, $culling culling, $backend" >&2
      if ! build/demo/tools/occlod render "meshes/scenes/$scene.json" --json --budget "$budget" --threads 1 --repeat "$repeat" --reference \
          "${options[@]}" --occlusion "$backend" --png "${name}.png" --birdseye "${name}_birdseye.png" >"$name.json"; then
        rm -f "$name.json"
        # A machine without any OpenGL can still show everything else.
        [ "$backend" = gl-query ] || failed=1
      fi
    done
  done
done

python3 scripts/demo_table.py "$out"
echo "Pictures and reports: $PWD/$out/SCENE_CULLING_BACKEND{.png,_birdseye.png,.json}"
exit $failed
