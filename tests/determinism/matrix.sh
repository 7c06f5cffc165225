#!/usr/bin/env bash
# The hashes of every sense by compiler and optimisation, by what glibc and Highway take of the processor, by processor (under
# qemu-user) and by threads: one line each, all equal to those kept in hashes.txt. Some minutes a compiler and level; what is
# built is kept in build/determinism/.
#   tests/determinism/matrix.sh [FOLDER OF BUILDS]
set -uo pipefail
cd "$(dirname "$0")/../.."
builds=${1:-build/determinism}
kept=tests/determinism/hashes.txt
failed=0
mkdir -p "$builds"

line() {  # NAME COMMAND...
  local name=$1 out
  shift
  if out=$("$@" 2>&1); then verdict=equal; else verdict=DIFFERS; failed=1; fi
  printf '%-44s %s\n' "$name" "$verdict"
  [ "$verdict" = equal ] || grep -E 'DIFFERS|differ|rror' <<<"$out"
}

for compiler in g++-12 clang++-14; do
  command -v "$compiler" >/dev/null || { echo "$compiler is not installed: left out"; continue; }
  for level in -O1 -O2 -O3; do
    build=$builds/$compiler$level
    cmake -S tests/determinism -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$compiler" \
      -DCMAKE_CXX_FLAGS_RELEASE="$level" >"$build.log" 2>&1 && cmake --build "$build" >>"$build.log" 2>&1 ||
      { echo "$compiler $level does not build: $build.log"; failed=1; continue; }
    line "$compiler $level" "$build/determinism_probe" --expect $kept
  done
done

for probe in "$builds"/*-O3/determinism_probe; do
  of=$(basename "$(dirname "$probe")")
  line "$of, glibc without AVX2 and FMA" tests/determinism/without_fma.sh "$probe" $kept
  line "$of, every kernel of Highway" "$probe" --all-kernels
  line "$of, 4 threads at once" "$probe" --threads 4
done

# Whole processors: also what Embree, Highway and glibc take of them. qemu has no AVX-512; the processor itself may.
if command -v qemu-x86_64 >/dev/null; then
  probe=$(ls "$builds"/g++-12-O3/determinism_probe)
  for cpu in qemu64 Nehalem SandyBridge Haswell; do
    line "g++-12-O3 on qemu's $cpu" qemu-x86_64 -cpu $cpu "$probe" --expect $kept
  done
fi
exit $failed
