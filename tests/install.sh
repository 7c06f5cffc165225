#!/usr/bin/env bash
# The installed library as others use it: for each component a CMake project of ten lines, outside the source tree, against a prefix that
# was installed just now; built without a warning, and run, as many at a time as there are processors. Then pkg-config, and what must
# not be linked. (That public headers compile alone is tested by tools/check_headers.)
#   tests/install.sh BUILD_DIR [PREFIX]     with PREFIX nothing is installed: "" /usr tests the packages
set -euo pipefail
cd "$(dirname "$0")/.."
source=$PWD
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
prefix=${2:-$work/prefix}
[ -n "${2:-}" ] || cmake --install "$build" --prefix "$prefix" >"$work/install.log" || { tail -5 "$work/install.log" >&2; exit 1; }
check() { # WHAT COMMAND...
  local what=$1 log
  log=$(mktemp -p "$work")
  shift
  if "$@" >"$log" 2>&1; then
    echo "$what: ok"
  else
    printf '%s: FAILED\n%s\n' "$what" "$(tail -15 "$log")"
    touch "$work/failed"
  fi
}

consumer() { # COMPONENTS EXAMPLE [ARGUMENTS]
  local folder=$work/$2
  mkdir "$folder"
  cp "$source/examples/$2.cpp" "$folder/main.cpp"
  cat >"$folder/CMakeLists.txt" <<CMAKE
cmake_minimum_required(VERSION 3.24)
project(consumer LANGUAGES CXX)
find_package(Intaglio 0.1 REQUIRED COMPONENTS $1)
add_executable(consumer main.cpp)
target_compile_options(consumer PRIVATE -Wall -Wextra -Wpedantic -Werror)
target_link_libraries(consumer PRIVATE intaglio::${1// / intaglio::})
CMAKE
  [[ $2 != bullet_* ]] || echo "target_link_libraries(consumer PRIVATE PkgConfig::bullet)" >>"$folder/CMakeLists.txt"
  # As a project of the outside: no compiler cache's folders, no flags of ours.
  cmake -S "$folder" -B "$folder/build" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_BUILD_TYPE=Release && cmake --build "$folder/build" || return 1
  shift 2
  (cd "$folder" && timeout 120 build/consumer "$@")
}
model=$(find "$source/scenes/models" -name '*.modes' -size -200k | sort | head -1)
# COMPONENTS|EXAMPLE|ARGUMENTS
cases=("core|materials" "surface|texture_report" "mesh|curved_surface" "contact|other_engine" "dynamics|bullet_floor" "dynamics|ball_on_brick"
  "dynamics haptics|touch_a_wall" "vrpn|vrpn_pen" "sound|struck_ball|$model" "dynamics audio bake|live_sound" "bake|bake_ball"
  "render|picture" "scene|scene_info|$source/scenes/brick.toml" "session report|simulate_scene")
for case in "${cases[@]}"; do
  IFS='|' read -r components example arguments <<<"$case"
  while [ "$(jobs -pr | wc -l)" -ge "$(nproc)" ]; do wait -n || true; done
  check "find_package(Intaglio COMPONENTS $components): examples/$example.cpp" consumer "$components" "$example" ${arguments:+"$arguments"} &
done
wait

# With pkg-config, where shared libraries were installed or static ones.
with_pkg_config() { # COMPONENT EXAMPLE
  export PKG_CONFIG_PATH=$prefix/lib/pkgconfig:$(echo "$prefix"/lib/*/pkgconfig)
  local static=--static
  ls "$prefix"/lib/libintaglio-core.so "$prefix"/lib/*/libintaglio-core.so >/dev/null 2>&1 && static=
  # shellcheck disable=SC2046
  g++ -std=c++20 "$source/examples/$2.cpp" -o "$work/$2.bin" $(pkg-config $static --cflags --libs "intaglio-$1") &&
    "$work/$2.bin" "${@:3}"
}
check "pkg-config intaglio-surface" with_pkg_config surface texture_report
check "pkg-config intaglio-sound" with_pkg_config sound struck_ball "$model"

# A program that plays sound links nothing that bakes it, and no sound card.
lean() { ! ldd "$work/struck_ball/build/consumer" | grep -E 'mumps|metis|blas|lapack|rtaudio|sndfile|Bullet|GL'; }
check "a program that plays sound links no MUMPS, METIS, BLAS, RtAudio, libsndfile, Bullet or OpenGL" lean
count=$(find "$prefix/include/intaglio" -name '*.h' | wc -l)
check "at most 60 installed headers ($count)" test "$count" -le 60
[ ! -e "$work/failed" ]
