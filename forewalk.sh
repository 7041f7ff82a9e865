#!/usr/bin/env bash
# Sets forewalk up on Debian 12 and runs it; ./forewalk.sh help names the verbs.
#
# Installs what is missing (as root, or through sudo), builds below build/, runs. Doing it again does only
# what is left to do. Takes no question; a step that fails is named, with what to look at.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

# What the build needs. `make` is there for machines without ninja; ninja and ccache are used if present.
PACKAGES=(g++ cmake make
  librecast-dev libsqlite3-dev libopenmesh-dev libtinygltf-dev libglm-dev nlohmann-json3-dev libexpected-dev
  libboost-dev libssl-dev libcgal-dev libcli11-dev libspdlog-dev libfmt-dev libgtest-dev libgmock-dev libbenchmark-dev)
# clang++ compiles the C interface as an engine would, without exceptions and RTTI; curl and nginx talk to daemons;
# abidiff compares the C interface with the last release; Mono compiles and runs the Unity package; the OpenXR layer is
# built, and walked under the loader and the validation layer; Slurm walks an experiment. Only `test all` asks for them.
PACKAGES_ALL=(clang curl nginx-light abigail-tools mono-mcs mono-runtime slurm-wlm
  libopenxr-dev libopenxr-loader1 openxr-layer-corevalidation)
# The inspector is walked through in a browser.
PACKAGES_BROWSER=(chromium)
# What the WebAssembly package is built and tested with: `wasm` and `test all`.
PACKAGES_WASM=(emscripten nodejs node-typescript cmake make libglm-dev nlohmann-json3-dev libexpected-dev libfmt-dev)

help() {
  cat <<'TEXT'
./forewalk.sh demo      walk a bundled building in a 6 x 6 m room; a table here, pictures under out/
./forewalk.sh test      build and run the tests, optimised (minutes)
./forewalk.sh test all  the same, then with ASan and UBSan, then the threaded ones with TSan (longer)
./forewalk.sh bench     build and run the benchmarks
./forewalk.sh compare   every controller against foresight and the ceiling: out/comparison/index.html (20 minutes)
./forewalk.sh wasm      build the package for browsers and node, build/wasm/service/wasm/package
./forewalk.sh inspector build the page that shows it all, and serve it with a bundled building
./forewalk.sh help      this text

Needs Debian 12, root or sudo for packages that are missing, and about 1 GB of disk.
TEXT
}

step=0
steps=0
begin() {  # begin WHAT: announces the next step
  step=$((step + 1))
  what=$1
  printf '\n[%d/%d] %s\n' "$step" "$steps" "$what"
}

fail() {  # fail HINT: ends with the step's name and what to look at
  printf '\nforewalk.sh: step %d of %d failed: %s.\n%s\n' "$step" "$steps" "$what" "$1" >&2
  exit 1
}

npm_package() { command -v npm >/dev/null || echo npm; }  # there are others than Debian's

jobs() { nproc 2>/dev/null || echo 2; }

installed() { [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]; }

install_packages() {  # install_packages PACKAGE...
  local missing=() name
  command -v dpkg-query >/dev/null ||
    fail "There is no dpkg here. On a system other than Debian, install what PACKAGES in forewalk.sh names and run cmake --preset release."
  for name in "$@"; do installed "$name" || missing+=("$name"); done
  if [ ${#missing[@]} -eq 0 ]; then
    echo "all $# packages are there"
    return
  fi
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null ||
      fail "Missing: ${missing[*]}. Run this as root, or install sudo."
    as_root=(sudo)
  fi
  echo "installing ${missing[*]}"
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o Dpkg::Use-Pty=0)
  "${apt[@]}" update </dev/null ||
    fail "apt-get update: is there a network, and do the lines in /etc/apt work?"
  "${apt[@]}" install -y --no-install-recommends "${missing[@]}" </dev/null |
    awk '/^Need to get/ { print "  " $0 }
         /^Unpacking/ && ++unpacked % 20 == 0 { print "  unpacked " unpacked " packages" }
         /^Setting up/ && ++ready % 20 == 0 { print "  set up " ready " packages" }
         { fflush() }' ||
    fail "apt-get install ${missing[*]}: see the lines above. This needs Debian 12 (bookworm) or newer."
}

configure() {  # configure PRESET
  local arguments=(--preset "$1")
  # The generator, the compiler cache and how much is compiled at once are chosen once; a build folder keeps its own.
  if [ ! -f "build/$1/CMakeCache.txt" ]; then
    [ "$1" = wasm ] || arguments+=(-DFOREWALK_UNITY=ON)
    if command -v ninja >/dev/null; then arguments+=(-G Ninja); fi
    if command -v ccache >/dev/null && [ "$1" != wasm ]; then
      arguments+=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
    fi
  fi
  cmake "${arguments[@]}" >"$(log "$1-configure")" 2>&1 || {
    tail -n 30 "$(log "$1-configure")" >&2
    fail "The whole output is in $(log "$1-configure"). If this folder was moved or a compiler replaced, remove build/$1 and run again."
  }
  echo "build/$1 is configured"
}

build() {  # build PRESET TARGET...
  local preset=$1
  shift
  cmake --build "build/$preset" --parallel "$(jobs)" --target "$@" ||
    fail "The compiler's message is above. If memory ran out, run again: what is built stays built."
}

run_tests() {  # run_tests PRESET
  ctest --preset "$1" --parallel "$(jobs)" ||
    fail "The failed tests are listed above. One of them alone: ctest --preset $1 -R NAME"
}

log() {
  mkdir -p build/log
  echo "build/log/$1.log"
}

demo() {
  steps=4
  begin "installing what is missing"
  install_packages "${PACKAGES[@]}"
  begin "configuring"
  configure release
  begin "building the forewalk command"
  build release forewalk
  begin "running the demo"
  build/release/service/forewalk demo --out out "$@" || fail "The line above says why."
  echo
  echo "Pictures, plots, dumps and traces are under $PWD/out"
  echo "To walk through it in a browser, every frame with its ways ahead: ./forewalk.sh inspector"
}

test_preset() {  # test_preset PRESET DESCRIPTION TARGET...
  begin "configuring $1 ($2)"
  configure "$1"
  begin "building $1"
  build "$1" "${@:3}"
  begin "testing $1"
  run_tests "$1"
}

build_wasm() {
  export NODE_PATH=/usr/share/nodejs  # where Debian has what emcc optimises JavaScript with
  begin "configuring wasm (WebAssembly, the frame side)"
  configure wasm
  begin "building wasm"
  build wasm wasm_package
}

wasm() {
  steps=3
  begin "installing what is missing"
  install_packages "${PACKAGES_WASM[@]}"
  build_wasm
  printf '\nThe package is %s\n' "$PWD/build/wasm/service/wasm/package"
}

# The page, build/inspector/page: needs the forewalk command of the release build, and the WebAssembly package.
build_inspector() {
  begin "building the inspector"
  local scene out=build/inspector/buildings
  mkdir -p "$out"
  for scene in assets/scenes/*.obj; do
    build/release/service/forewalk build "$scene" --out "$out/$(basename "$scene" .obj).fwmesh" >/dev/null ||
      fail "The line above says why."
  done
  # Packages are locked by version and hash; npm ci takes no others.
  if ! cmp -s service/inspector/package-lock.json service/inspector/node_modules/.forewalk-lock.json; then
    npm ci --prefix service/inspector --ignore-scripts --no-audit --no-fund >"$(log npm)" 2>&1 || {
      tail -n 20 "$(log npm)" >&2
      fail "npm ci: is there a network? The whole output is in $(log npm)."
    }
    cp service/inspector/package-lock.json service/inspector/node_modules/.forewalk-lock.json
  fi
  npm run --silent --prefix service/inspector check || fail "The compiler's message is above."
  FOREWALK_BUILD="$PWD/build" npm run --silent --prefix service/inspector build -- --logLevel warn ||
    fail "The message is above."
  echo "build/inspector/page/index.html is there"
}

inspector() {
  steps=6
  begin "installing what is missing"
  install_packages "${PACKAGES[@]}" "${PACKAGES_WASM[@]}" $(npm_package)
  build_wasm
  begin "configuring and building the forewalk command"
  configure release
  build release forewalk
  build_inspector
  begin "serving ${*:-the museum}"
  echo "open http://127.0.0.1:7878/ in a browser; Ctrl-C ends it"
  exec build/release/service/forewalk serve "${@:-assets/scenes/museum.obj}" --inspector build/inspector/page
}

run_all_tests() {
  case "${1:-}" in
    "") steps=4 ;;
    all) steps=13 ;;
    *)
      help >&2
      exit 2
      ;;
  esac
  begin "installing what is missing"
  if [ "${1:-}" = all ]; then
    install_packages "${PACKAGES[@]}" "${PACKAGES_ALL[@]}" "${PACKAGES_WASM[@]}" "${PACKAGES_BROWSER[@]}" $(npm_package)
  else
    install_packages "${PACKAGES[@]}"
  fi
  if [ "${1:-}" = all ]; then build_wasm; fi
  # Benchmarks are built only where all is asked for, so that they do not rot.
  if [ "${1:-}" = all ]; then
    begin "configuring release (optimised)"
    configure release
    begin "building release"
    build release all benchmarks
    build_inspector
    begin "testing release"
    run_tests release
  else
    test_preset release "optimised" all
  fi
  if [ "${1:-}" = all ]; then
    test_preset dev "Debug, ASan, UBSan" all
    test_preset tsan "Debug, ThreadSanitizer, the tests that start threads" tests
  fi
  printf '\nAll tests passed.\n'
}

bench() {
  local programs
  mapfile -t programs < <(sed -n 's/^forewalk_bench(\([a-z0-9_]*\).*/\1/p' bench/CMakeLists.txt)
  steps=$((3 + ${#programs[@]}))
  begin "installing what is missing"
  install_packages "${PACKAGES[@]}"
  begin "configuring"
  configure release
  begin "building ${programs[*]}"
  build release "${programs[@]}"
  local program
  for program in "${programs[@]}"; do
    begin "running $program"
    "build/release/bench/$program" "$@" || fail "build/release/bench/$program ended with an error, see above."
  done
}

# One plan for all recorded walks: a variant each, its scene where it has one.
recorded_walks_plan() {  # recorded_walks_plan FOLDER
  local folder scene walker separator=""
  printf '{"format": "forewalk.experiment/1", "name": "recorded walks", "traces": "none",\n'
  printf ' "walk": {"rate_hz": 30, "horizon_m": 10, "predict_always": false},\n "rooms": ['
  printf '{"name": "4 x 4 m", "rectangle": [4, 4]}, {"name": "6 x 6 m", "rectangle": [6, 6]}, '
  printf '{"name": "10 x 10 m", "rectangle": [10, 10]}],\n'
  sed -n '/"controllers"/,/\]/p' assets/experiments/plane.json
  printf ' "limits": ["toolkit", "steinicke"], "variants": [\n'
  for folder in "$1"/*/; do
    scene=""
    [ -f "${folder}scene.obj" ] && scene="\"scene\": \"${folder}scene.obj\", "
    while read -r walker; do
      printf '%s  {"name": "%s %s", %s"user": {"kind": "recorded", "walks": "%swalks.csv", "walker": "%s"}}' \
        "$separator" "$(basename "$folder")" "$walker" "$scene" "$folder" "$walker"
      separator=$',\n'
    done < <(awk -F, 'NR > 1 && !seen[$1]++ { print $1 }' "${folder}walks.csv")
  done
  printf ']}\n'
}

compare() {
  local out=out/comparison walks=${FOREWALK_SHARED_DATA:-../shared/data}/walks plan name
  local plans=(assets/experiments/plane.json assets/experiments/buildings.json) sets=()
  mkdir -p "$out"
  if [ -d "$walks" ]; then
    recorded_walks_plan "$(cd "$walks" && pwd)" >"$out/walks.json"
    plans=("$out/walks.json" "${plans[@]}")
  else
    echo "no recorded walks at $walks: compared without them (FOREWALK_SHARED_DATA says where they are)"
  fi
  steps=$((4 + ${#plans[@]}))
  begin "installing what is missing"
  install_packages "${PACKAGES[@]}"
  begin "configuring"
  configure release
  begin "building the forewalk command and steering_comparison"
  build release forewalk steering_comparison
  for plan in "${plans[@]}"; do
    name=$(basename "$plan" .json)
    begin "walking $plan"
    build/release/service/forewalk experiment "$plan" --out "$out/$name" "$@" ||
      fail "The line above says why. The same command goes on from here."
    # A page of every recorded walk for itself would say little.
    [ "$name" = walks ] || build/release/service/forewalk report "$out/$name" || fail "The line above says why."
    sets+=("$plan=$out/$name")
  done
  begin "finding the ceiling"
  build/release/bench/steering_comparison "${sets[@]}" --out "$out" || fail "The line above says why."
  echo
  echo "The page: $PWD/$out/index.html"
}

verb=${1:-help}
[ $# -gt 0 ] && shift
case "$verb" in
  demo) demo "$@" ;;
  test) run_all_tests "$@" ;;
  bench) bench "$@" ;;
  compare) compare "$@" ;;
  wasm) wasm ;;
  inspector) inspector "$@" ;;
  help | -h | --help) help ;;
  *)
    printf 'forewalk.sh: there is no "%s".\n\n' "$verb" >&2
    help >&2
    exit 2
    ;;
esac
