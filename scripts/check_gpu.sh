#!/usr/bin/env bash
# check_gpu.sh: measures what needs a GPU or many cores, on a machine that has nothing but its driver: programs and scenes
# are packed here and run there, in less than eight minutes.
#   check_gpu.sh pack FOLDER        builds build/gpu and puts programs, their libraries, Mesa's OSMesa to compare with, scenes
#                                   and this script into FOLDER: at most 60 MiB, x86-64
#   check_gpu.sh run FOLDER OUT [--any-renderer] [PART...]
#                                   measures all parts or those named, and writes tables (CSV), machine.txt and log.txt
#                                   to OUT. Needs libEGL (libglvnd) and the driver. A part that gets a renderer on the
#                                   processor instead of a GPU fails; with --any-renderer it goes on, to try the script.
# Parts: device, occlusion, refinement, costs, strategies (on the GPU); software (device and occlusion by llvmpipe);
# build, hlod, cells, scratch, frames (by number of threads); tests (of lib/gl, on the GPU).
set -euo pipefail

parts=(device occlusion refinement costs strategies software build hlod cells scratch frames tests)
# Seconds: together less than eight minutes.
declare -A limits=([device]=35 [occlusion]=30 [refinement]=25 [costs]=10 [strategies]=60 [software]=65
                   [build]=45 [hlod]=45 [cells]=50 [scratch]=20 [frames]=45 [tests]=45)
programs=(tools/occlod bench/bench_gl_device bench/bench_gl_occlusion bench/bench_scratch
          bench/papers/bench_hlod_compare tests/gl/test_gl tests/gl/test_gl_device)
max_pack_mib=60
rounds=3
size=1024x768

say() { echo "check_gpu: $*" >&2; }
refuse() { say "$*"; exit 2; }

# ---- pack

build_programs() {
  if command -v ccache >/dev/null; then
    export CMAKE_CXX_COMPILER_LAUNCHER=ccache
    export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros}
  fi
  cmake --preset bench -B build/gpu -DOCCLOD_WITH_CGAL=OFF -DOCCLOD_BUILD_TESTS=ON >&2
  cmake --build build/gpu --target "${programs[@]##*/}" >&2
}

# Of the programs or libraries named after the folder; without what every system has, and has newer.
copy_libraries() {
  local folder=$1 file
  shift
  mkdir -p "$folder"
  ldd "$@" | awk '$2 == "=>" && $3 ~ /^\// { print $3 }' | sort -u |
    grep -vE '/(libc|libm|libgcc_s|libstdc\+\+|libpthread|libdl|librt)\.so' |
    while read -r file; do cp -L "$file" "$folder"; done
}

# programs.tar.xz: the programs, stripped, and their libraries.
pack_programs() {
  local temporary program
  temporary=$(mktemp -d)
  mkdir "$temporary/programs"
  for program in "${programs[@]}"; do strip -o "$temporary/programs/${program##*/}" "build/gpu/$program"; done
  copy_libraries "$temporary/libraries" "$temporary"/programs/*
  tar -C "$temporary" -cf - . | xz -6 -T0 >"$1/programs.tar.xz"
  rm -r "$temporary"
}

# software.tar.xz: OSMesa with its LLVM. Made once: that takes longest.
pack_software_driver() {
  local osmesa temporary
  osmesa=$(ldconfig -p | awk '/libOSMesa\.so\.8 .*x86-64/ { print $NF; exit }')
  [ -n "$osmesa" ] || { say "no OSMesa (libosmesa6) here: nothing will be compared with llvmpipe"; return 0; }
  temporary=$(mktemp -d)
  copy_libraries "$temporary" "$osmesa"
  cp -L "$osmesa" "$temporary"
  tar -C "$temporary" -cf - . | xz -6 -T0 >"$1/software.tar.xz"
  rm -r "$temporary"
}

copy_inputs() {
  mkdir -p "$1/scenes" "$1/meshes"
  cp meshes/scenes/{city,planet_near,planet_full}.json bench/scenes/{cells_street,plant_rooms}.json "$1/scenes"
  scripts/get_demo_meshes.sh >&2 && cp "${XDG_DATA_HOME:-$HOME/.local/share}/occlod/meshes/armadillo.off" "$1/meshes" ||
    say "no mesh of a scan here: only generated ones are measured"
}

pack() {
  local folder
  folder=$(realpath -m "$1")
  cd "$(dirname "$0")/.."
  [ "$(uname -m)" = x86_64 ] || refuse "the pack is for x86-64, and this is $(uname -m)"
  build_programs
  mkdir -p "$folder"
  pack_programs "$folder"
  [ -s "$folder/software.tar.xz" ] || pack_software_driver "$folder"
  copy_inputs "$folder"
  git describe --always --dirty >"$folder/version"
  cp scripts/check_gpu.sh "$folder"
  local mib
  mib=$(du -sm "$folder" | cut -f1)
  [ "$mib" -le $max_pack_mib ] || { say "$folder has $mib MiB, more than $max_pack_mib"; exit 1; }
  say "$folder has $mib MiB"
}

# ---- what parts use

occlod() { "$work/programs/occlod" "$@"; }

# value KEY: its first in JSON of one key a line.
value() {
  awk -v key="\"$1\":" '$1 == key && !found { found = 1; sub(/^ *"[^"]*": *"?/, ""); sub(/"?,?$/, ""); print }'
}

# Of the numbers of standard input, one a line.
median() { sort -g | awk '{ a[NR] = $1 } END { if (NR) print NR % 2 ? a[(NR + 1) / 2] : (a[NR / 2] + a[NR / 2 + 1]) / 2 }'; }
rounded() { awk '{ printf "%.4g\n", $1 }'; }
least() { sort -g | head -n 1; }

hash_of() { sha256sum "$@" | sha256sum | cut -c1-16; }

is_software() { case $1 in *llvmpipe* | *softpipe* | *swrast* | *SwiftShader* | '') return 0 ;; *) return 1 ;; esac; }

# GL_RENDERER that a program gets now.
current_renderer() { occlod hlod render "$work/ball.ohlod" --device "$1" --json | value renderer; }

# Prints GL_RENDERER, and fails unless it is what the part is to measure.
require_renderer() {
  local found
  found=$(current_renderer gl)
  if is_software "$found" && [ "$any_renderer" = 0 ]; then
    say "NO GPU: programs get '${found:-no context}'; nothing is measured"
    return 1
  fi
  echo "$found"
}

# The header of a table, unless a part that shares it has begun it.
begin_table() { [ -s "$out/$1.csv" ] || echo "$2" >"$out/$1.csv"; }

thread_counts() {
  local n
  for n in 1 2 4 8 16; do [ "$n" -le "$(nproc)" ] && echo "$n"; done
}

# add_times TABLE_ROW_HEAD FILE HASHES: of the times in FILE, and the hashes of all results, which have to be one.
add_times() {
  local hashes
  hashes=$(sort -u <"$3")
  [ "$(wc -l <<<"$hashes")" = 1 ] || say "DIFFERENT RESULTS: $1: $(tr '\n' ' ' <<<"$hashes")"
  echo "$1,$(median <"$2" | rounded),$(least <"$2" | rounded),$(tr '\n' ' ' <<<"$hashes" | sed 's/ $//')" >>"$out/threads.csv"
}

begin_threads() { begin_table threads what,input,threads,median_ms,min_ms,hash; }

# by_threads WHAT INPUT COMMAND...: the command, given a number of threads, prints milliseconds and a hash.
by_threads() {
  local what=$1 input=$2 threads i ms hash
  shift 2
  begin_threads
  for threads in $(thread_counts); do
    : >"$work/times"
    : >"$work/hashes"
    for ((i = 0; i < rounds; ++i)); do
      read -r ms hash < <("$@" "$threads")
      echo "$ms" >>"$work/times"
      echo "$hash" >>"$work/hashes"
    done
    add_times "$what,$input,$threads" "$work/times" "$work/hashes"
  done
}

# ---- parts

# bench_device REPETITIONS gpu|software SECONDS: bench_gl_device as rows, medians and minima of repetitions.
bench_device() {
  local renderer
  "$work/programs/bench_gl_device" --benchmark_min_time="$3" --benchmark_repetitions="$1" \
    --benchmark_enable_random_interleaving=true --benchmark_report_aggregates_only=true --benchmark_format=csv \
    >"$work/device.csv" 2>"$work/device.log" || { cat "$work/device.log" >&2; return 1; }
  renderer=$(sed -n 's/^renderer: *//p' "$work/device.log")
  if is_software "$renderer" && [ "$2" = gpu ] && [ "$any_renderer" = 0 ]; then
    say "NO GPU: bench_gl_device got '$renderer'"
    return 1
  fi
  begin_table gpu_device renderer,threads,what,setting,median_ms,min_ms,processor_ms,calls,pixels,min_wait_us
  awk -F, -v head="\"$renderer\",${LP_NUM_THREADS:-}" '
    function value(key) { return key in column ? $column[key] : "" }
    $1 == "name" { for (i = 1; i <= NF; ++i) { k = $i; gsub(/"/, "", k); column[k] = i } next }
    { name = $1; gsub(/"/, "", name); kind = name; sub(/.*_/, "", kind); sub(/_[a-z]*$/, "", name); sub(/\/real_time$/, "", name) }
    kind == "min" { least[name] = $column["real_time"] }
    kind == "median" {
      order[++count] = name; ms[name] = $column["real_time"]; cpu[name] = $column["cpu_time"]
      calls[name] = value("calls"); pixels[name] = value("pixels"); wait[name] = value("min_wait")
    }
    END {
      for (i = 1; i <= count; ++i) {
        name = order[i]; what = name; sub(/\/[a-z]*:.*/, "", what); setting = substr(name, length(what) + 2)
        gsub(/[:]/, " ", setting); gsub(/\//, " ", setting)
        printf "%s,%s,%s,%s,%s,%s,%s,%s,%s\n", head, what, setting, ms[name], least[name], cpu[name], calls[name], pixels[name], wait[name] == "" ? "" : 1e6 * wait[name]
      }
    }' "$work/device.csv" | sort >>"$out/gpu_device.csv"
}

# bench_gl_occlusion as rows.
bench_occlusion() {
  local renderer
  "$work/programs/bench_gl_occlusion" "$@" >"$work/occlusion.txt"
  renderer=$(sed -n '1s/^[a-z-]*, \(.*\), OpenGL .*/\1/p' "$work/occlusion.txt")
  if is_software "$renderer" && [ "$1 $2" = "--platform egl" ] && [ "$any_renderer" = 0 ]; then
    say "NO GPU: bench_gl_occlusion got '$renderer'"
    return 1
  fi
  begin_table gpu_occlusion renderer,backend,settings,occluder_ms,box_ms,sphere_ms,cylinder_ms,box_hidden_pct,sphere_hidden_pct,cylinder_hidden_pct
  awk -F' *\\| *' -v renderer="$renderer" '
    /^\|/ && $2 != "backend" && $2 !~ /^-/ { printf "\"%s\",%s,\"%s\",%s,%s,%s,%s,%s,%s,%s\n", renderer, $2, $3, $4, $5, $6, $7, $8, $9, $10 }' \
    "$work/occlusion.txt" >>"$out/gpu_occlusion.csv"
}

part_device() { require_renderer >/dev/null && bench_device 7 gpu 0.02; }

part_occlusion() { require_renderer >/dev/null && bench_occlusion --platform egl --repeat 9; }

# Refinement from scratch to 10,000 triangles.
part_refinement() {
  local renderer scene backend json
  renderer=$(require_renderer)
  begin_table gpu_refinement renderer,scene,backend,visible,queries,occlusion_ms,refine_ms,hash
  for scene in planet_full planet_near city; do
    for backend in software gl-query; do
      json=$(occlod render "$pack/scenes/$scene.json" --occlusion "$backend" --threads 1 --repeat 7 --json)
      echo "\"$renderer\",$scene,$backend,$(value visible_triangles <<<"$json"),$(value queries <<<"$json"),$(value occlusion_ms <<<"$json" | rounded),$(value refine_ms <<<"$json" | rounded),$(value hash <<<"$json")" >>"$out/gpu_refinement.csv"
    done
  done
}

cost_keys=(draw_ns triangle_ns fragment_ns query_ns query_fragment_ns wrapped_query_ns readback_ns batch_ns batch_item_ns submit_ns visit_ns)

# What a device's commands cost: the seven times of Guthe, Balazs and Klein 2006, and what else measure_costs() tells.
add_costs() {
  local renderer=$1 device=$2 i json key row
  for ((i = 1; i <= 5; ++i)); do
    json=$(occlod hlod render "$work/ball.ohlod" --strategy nohc --device "$device" --json)
    row="\"$renderer\",$device,$i"
    for key in "${cost_keys[@]}"; do row+=",$(value "$key" <<<"$json" | rounded)"; done
    echo "$row" >>"$out/gpu_costs.csv"
  done
}

part_costs() {
  local renderer
  renderer=$(require_renderer)
  begin_table gpu_costs "renderer,device,run,$(IFS=,; echo "${cost_keys[*]}")"
  add_costs "$renderer" gl
  add_costs "" software
}

# Means over the frames of each run, medians of the runs' means.
add_strategies() {
  awk -F, -v head="$1" '
    function middle(list, n,   i, j, t) {
      for (i = 2; i <= n; ++i) for (j = i; j > 1 && list[j] < list[j - 1]; --j) { t = list[j]; list[j] = list[j - 1]; list[j - 1] = t }
      return n % 2 ? list[(n + 1) / 2] : (list[n / 2] + list[n / 2 + 1]) / 2
    }
    FNR == 1 { ++files; for (i = 1; i <= NF; ++i) column[$i] = i; next }
    {
      s = $column["strategy"]
      if (!(s in seen)) { seen[s] = 1; order[++strategies] = s }
      ++frames[s, files]
      for (k = 1; k <= keys; ++k) sum[s, files, k] += $column[key[k]]
      if ($column["frame_ms"] > largest[s, files]) largest[s, files] = $column["frame_ms"]
    }
    BEGIN { keys = split("frame_ms cpu_ms gpu_ms stall_ms starve_ms drawn_nodes drawn_triangles queries", key, " ") }
    END {
      for (o = 1; o <= strategies; ++o) {
        s = order[o]; row = head "," s "," frames[s, 1]
        for (k = 1; k <= keys; ++k) {
          for (f = 1; f <= files; ++f) list[f] = sum[s, f, k] / frames[s, f]
          row = row sprintf(",%.4f", middle(list, files))
        }
        for (f = 1; f <= files; ++f) list[f] = largest[s, f]
        print row sprintf(",%.4f", middle(list, files))
      }
    }' "$work"/strategies_*.csv >>"$out/gpu_strategies.csv"
}

# compare_strategies RENDERER SCENE PATH TOLERANCE [OPTION...]
compare_strategies() {
  local renderer=$1 scene=$2 path=$3 tolerance=$4 i
  shift 4
  rm -f "$work"/strategies_*.csv
  for ((i = 1; i <= rounds; ++i)); do
    "$work/programs/bench_hlod_compare" "$work/$scene.ohlod" --scene "$pack/scenes/$scene.json" --path "$path" --size $size --bias none \
      --tolerance "$tolerance" --strategies vfc,bool,coh,chc++,nohc,two-pass,batch,auto --device gl "$@" \
      --csv "$work/strategies_$i.csv" >>"$work/strategies.log"
  done
  add_strategies "\"$renderer\",$scene,$path,$tolerance"
}

# With nodes of at most 1,000 triangles, as in Guthe, Balazs and Klein 2006.
build_nodes() {
  occlod hlod build "$pack/scenes/$1.json" -o "$work/$1.ohlod" --grouping nested --borders free --node-triangles 1000 >/dev/null
}

part_strategies() {
  local renderer
  renderer=$(require_renderer)
  begin_table gpu_strategies renderer,scene,path,tolerance_px,strategy,frames,frame_ms,cpu_ms,gpu_ms,stall_ms,starve_ms,drawn_nodes,drawn_triangles,queries,max_frame_ms
  build_nodes city && compare_strategies "$renderer" city walk 1
  build_nodes planet_near && compare_strategies "$renderer" planet_near low_flight 1
  compare_strategies "$renderer" city walk 0
  build_nodes plant_rooms && compare_strategies "$renderer" plant_rooms run 1
}

# llvmpipe, drawing on the calling thread and on several.
part_software() {
  [ -s "$pack/software.tar.xz" ] || { say "no OSMesa in the pack"; return 1; }
  mkdir -p "$work/software"
  tar -C "$work/software" -xJf "$pack/software.tar.xz"
  export LD_LIBRARY_PATH=$LD_LIBRARY_PATH:$work/software
  # No vendor: EGL offers nothing, so any context is OSMesa's.
  export __EGL_VENDOR_LIBRARY_FILENAMES=/dev/null
  local threads renderer
  renderer=$(current_renderer osmesa)
  for threads in 0 "$(nproc)"; do LP_NUM_THREADS=$threads bench_device 3 software 0.001; done
  bench_occlusion --platform osmesa --repeat 3
  begin_table gpu_costs "renderer,device,run,$(IFS=,; echo "${cost_keys[*]}")"
  LP_NUM_THREADS=$(nproc) add_costs "$renderer" osmesa
}

build_once() {
  local json
  json=$(occlod build "$1" -o "$work/built.olod" --threads "$2" --json)
  echo "$(value build_ms <<<"$json") $(hash_of <"$work/built.olod")"
}

part_build() {
  local level
  for level in 8 9; do
    occlod generate rough-planet level=$level -o "$work/planet.ply" >/dev/null
    by_threads "build" "planet $level" build_once "$work/planet.ply"
  done
  [ ! -e "$pack/meshes/armadillo.off" ] || by_threads "build" armadillo build_once "$pack/meshes/armadillo.off"
}

hlod_once() {
  local json
  json=$(occlod hlod build "$1" -o "$work/built.ohlod" --threads "$2" --json)
  echo "$(value build_ms <<<"$json") $(hash_of <"$work/built.ohlod")"
}

part_hlod() {
  by_threads "hlod build" city hlod_once "$pack/scenes/city.json"
  by_threads "hlod build" planet_full hlod_once "$pack/scenes/planet_full.json"
}

cells_once() {
  local json
  json=$(occlod cells build "$1" -o "$work/built.vlod" --root-cell 4 --region 220,236,1,260,244,2.5 --threads "$2" --json)
  echo "$(value build_ms <<<"$json") $(hash_of <"$work/built.vlod")"
}

part_cells() { by_threads "cells build" cells_street cells_once "$pack/scenes/cells_street.json"; }

# Refinement from scratch, of each frame the least of nine rounds; the hash is of all triangles.
part_scratch() {
  local scene path
  begin_threads
  while read -r scene path; do
    # shellcheck disable=SC2046  # words
    "$work/programs/bench_scratch" --scenes "$pack/scenes" --scene "$scene" --path "$path" --frames 12 --repeat 5 \
      --ways subtree star+software --threads $(thread_counts) >"$work/scratch.txt"
    awk -F' *\\| *' '$2 != "scene" && $2 !~ /^-/ && NF > 12 {
        threads = $5; way = $5; sub(/,.*/, "", way); if (!sub(/.*, /, "", threads)) threads = 1; sub(/ threads/, "", threads)
        printf "refine %s,%s,%s,%s,%s,%s\n", way, $2, threads, $11, $9, $13 }' "$work/scratch.txt" >>"$out/threads.csv"
  done <<<"planet_near low_flight
city walk"
}

# Refiner::update(): the mean of all frames but the first, which is from scratch; the hash is of all frames.
frames_once() {
  occlod render "$pack/scenes/$1.json" --path "$2" --frame-to-frame --threads "$3" --json >"$work/frames.json"
  awk '$1 == "\"refine_ms\":" || $1 == "\"occlusion_ms\":" { if (frame > 0) sum += $2 } $1 == "\"hash\":" { ++frame }
       END { printf "%.4f ", sum / (frame - 1) }' "$work/frames.json"
  grep '"hash":' "$work/frames.json" | hash_of
}

part_frames() {
  local rounds=1  # of 160 and 240 frames
  by_threads "update" planet_near frames_once planet_near low_flight
  by_threads "update" city frames_once city walk
}

# Counts in machine.txt, what failed in log.txt.
part_tests() {
  local program failed=0 filter
  require_renderer >/dev/null
  for program in test_gl test_gl_device; do
    filter='*'
    # Slow by design: lost contexts at every call, and waits of ten seconds.
    [ "$program" = test_gl ] && filter='-*AtAnyCallIsOneError*:*AfterTenSeconds*'
    timeout 35 "$work/programs/$program" --gtest_filter="$filter" --gtest_brief=1 >"$work/$program.txt" 2>&1 || failed=1
    grep -vE 'Skipped|SKIPPED|^no context' "$work/$program.txt"
    sed -n "s/^\[  \(PASSED\|FAILED\|SKIPPED\) *\] *\([0-9].*\)/$program: \1 \2/p" "$work/$program.txt" >>"$out/machine.txt"
  done
  return $failed
}

# ---- run

describe_machine() {
  {
    echo "version: $(cat "$pack/version")"
    echo "GPU: $(nvidia-smi --query-gpu=name,driver_version,memory.total --format=csv,noheader 2>/dev/null || echo 'nvidia-smi does not answer')"
    echo "GL_RENDERER: $(current_renderer gl || true)"
    echo "GL_VERSION: $(occlod hlod render "$work/ball.ohlod" --device gl --json | value version || true)"
    echo "platform: $(occlod hlod render "$work/ball.ohlod" --device gl --json | value platform || true)"
    echo "processor: $(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -n 1)"
    echo "cores: $(nproc)"
    echo "memory: $(awk '/MemTotal/ { printf "%.0f GiB", $2 / 1048576 }' /proc/meminfo)"
    echo "system: $(sed -n 's/^PRETTY_NAME=//p' /etc/os-release | tr -d '"'), $(uname -r)"
  } >"$out/machine.txt"
  cat "$out/machine.txt" >&2
}

prepare() {
  tar -C "$work" -xJf "$pack/programs.tar.xz"
  occlod generate rough-planet level=3 -o "$work/ball.ply" >/dev/null
  occlod hlod build "$work/ball.ply" -o "$work/ball.ohlod" >/dev/null
}

# In a process of its own: it ends with its children when its time is over.
run_part() {
  local start=$SECONDS status=0
  timeout -k 5 "${limits[$1]}" "$0" part "$1" >>"$out/log.txt" 2>&1 || status=$?
  case $status in
    0) say "$1: done in $((SECONDS - start)) s" ;;
    124 | 137) say "$1: STOPPED after ${limits[$1]} s: what it has measured is kept" ;;
    *) say "$1: FAILED: $(tail -n 1 "$out/log.txt")" ;;
  esac
  return $status
}

run() {
  [ $# -ge 2 ] || refuse "run needs two folders; see the head of $0"
  pack=$(realpath "$1")
  out=$(realpath -m "$2")
  shift 2
  any_renderer=0
  [ "${1:-}" != --any-renderer ] || { any_renderer=1; shift; }
  local chosen=("$@") failed=() part
  [ ${#chosen[@]} -gt 0 ] || chosen=("${parts[@]}")
  mkdir -p "$out"
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
  export pack out work any_renderer
  export LD_LIBRARY_PATH=$work/libraries${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH} OCCLOD_MESHES=$pack/meshes XDG_CACHE_HOME=$work/cache
  prepare
  describe_machine
  : >"$out/log.txt"
  for part in "${chosen[@]}"; do
    [ -n "${limits[$part]:-}" ] || refuse "there is no part $part"
    run_part "$part" || failed+=("$part")
  done
  [ ${#failed[@]} -eq 0 ] || { say "${#failed[@]} of ${#chosen[@]} parts FAILED: ${failed[*]}; see $out/log.txt"; exit 1; }
}

case ${1:-} in
  pack) [ $# -eq 2 ] || refuse "pack needs a folder; see the head of $0"; pack "$2" ;;
  run) shift; run "$@" ;;
  part) "part_$2" ;;  # run_part's
  *) refuse "pack or run? See the head of $0" ;;
esac
