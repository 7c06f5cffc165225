#!/usr/bin/env bash
# The same sound whatever computes the linear algebra: what bakes and what plays what was baked, under every kernel of OpenBLAS that
# this processor can run, and with the reference BLAS where it is installed (package libblas3).
#   tests/kernels.sh BUILD_DIR          some bodies and the tests that bake, a minute
#   tests/kernels.sh BUILD_DIR --whole  all bodies and the whole test programs bake, sound and session, a quarter of an hour
# Ends with a table: of each kernel the tests, and the worst difference from the first of frequencies (asked: 1e-10, relative) and of
# the audio of bodies struck at their default place (asked: -80 dB, and 0.01 dB of level).
set -euo pipefail
cd "$(dirname "$0")/.."
build=$1
whole=${2:-}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
kernels=(Haswell Zen Prescott)
[ -n "$whole" ] && kernels+=(Sandybridge Nehalem)
grep -qw avx512bw /proc/cpuinfo && kernels+=(SkylakeX)
reference=$(ls -d /usr/lib/*/blas 2>/dev/null | head -1 || true)
[ -n "$reference" ] && kernels+=(reference)

under() { # KERNEL COMMAND...
  local kernel=$1
  shift
  if [ "$kernel" = reference ]; then
    env -u OPENBLAS_CORETYPE LD_LIBRARY_PATH="$reference" "$@"
  else
    env OPENBLAS_CORETYPE="$kernel" "$@"
  fi
}
# A name that OpenBLAS does not know, or another BLAS, would compare a kernel with itself.
for kernel in "${kernels[@]}"; do
  if [ "$kernel" = reference ]; then
    ran=$(LD_BIND_NOW=1 LD_DEBUG=bindings under reference "$build/intaglio" --version 2>&1 | sed -nE "s|.*intaglio \\[0\\] to (.*/blas/)libblas.*dgemm_'.*|\\1|p" | head -1)
    wanted=$reference/
  else
    ran=$(OPENBLAS_VERBOSE=2 under "$kernel" "$build/intaglio" --version 2>&1 | sed -n 's/^Core: //p' | head -1)
    wanted=$kernel
  fi
  [ "$ran" = "$wanted" ] || { echo "kernel $kernel: what runs is \"$ran\"" >&2; exit 1; }
done
python3 - "$work" <<'PY'
import math, sys
for sides in range(3, 9):
    with open(f"{sys.argv[1]}/prism{sides}.obj", "w") as f:
        for y in (-0.075, 0.075):
            for k in range(sides):
                a = 2 * math.pi * k / sides
                f.write(f"v {0.05 * math.cos(a):.9f} {y} {-0.05 * math.sin(a):.9f}\n")
        for k in range(sides):
            a, b = k + 1, (k + 1) % sides + 1
            f.write(f"f {a} {b} {b + sides}\nf {a} {b + sides} {a + sides}\n")
        for k in range(1, sides - 1):
            f.write(f"f 1 {k + 2} {k + 1}\nf {sides + 1} {sides + k + 1} {sides + k + 2}\n")
PY
bodies=("sphere:r=0.15 ceramic" "plate:a=0.3,t=0.01 ceramic" "box:x=0.1,y=0.1,z=0.1 steel" "cylinder:r=0.03,h=0.2 steel" "$work/prism3.obj glass")
[ -n "$whole" ] && for n in 4 5 6 7 8; do bodies+=("$work/prism$n.obj glass"); done

try_kernel() { # KERNEL: bakes and plays the bodies, runs the tests
  local kernel=$1 out=$work/$1 n=0 body mesh material suite
  mkdir "$out"
  for body in "${bodies[@]}"; do
    read -r mesh material <<<"$body"
    under "$kernel" "$build/intaglio" bake "$mesh" --material "$material" --json -o "$out/$n.modes" >"$out/$n.json" 2>"$out/$n.log" ||
      cat "$out/$n.log"
    # Played under one kernel: what differs is the model.
    "$build/intaglio" -q sound strike "$out/$n.modes" -o "$out/$n.wav"
    n=$((n + 1))
  done
  local bake=() sound=() session=()
  if [ -z "$whole" ]; then
    bake=(-tse=statistics "-sf=*canonical*,*merge*,*test_mod*,*radiation*,*sample_s*,*thin_plate*")
    sound=(-tse=statistics "-sf=*test_mod*,*strike*,*scaled*")
    session=("-tc=each onset*")
  fi
  for suite in bake sound session; do
    local -n filter=$suite
    echo passed >"$out/$suite"
    under "$kernel" "$build/tests/test_$suite" "${filter[@]}" >"$out/$suite.log" 2>&1 || {
      echo FAILED >"$out/$suite"
      grep -B6 -A3 "ERROR" "$out/$suite.log" | head -40
    }
  done
}
for kernel in "${kernels[@]}"; do # two at a time
  try_kernel "$kernel" &
  [ "$(jobs -rp | wc -l)" -lt 2 ] || wait -n
done
wait

python3 - "$work" "${#bodies[@]}" "${kernels[@]}" <<'PY'
import json, math, sys, wave
work, count, kernels = sys.argv[1], int(sys.argv[2]), sys.argv[3:]
def audio(path):
    with wave.open(path) as w:
        raw, size = w.readframes(w.getnframes()), w.getsampwidth()
    return [int.from_bytes(raw[k:k + size], "little", signed=True) for k in range(0, len(raw), size)]
bad = False
print(f"{'kernel':12} {'bake':8} {'sound':8} {'session':8} {'frequencies':>12} {'audio, dB':>10} {'level, dB':>10}")
for kernel in kernels:
    frequency, difference, level = 0.0, -math.inf, 0.0
    for n in range(count):
        of = [json.load(open(f"{work}/{k}/{n}.json"))["frequencies"] for k in (kernels[0], kernel)]
        if len(of[0]) != len(of[1]): frequency = math.inf
        else: frequency = max([frequency] + [abs(b / a - 1) for a, b in zip(*of)])
        a, b = (audio(f"{work}/{k}/{n}.wav") for k in (kernels[0], kernel))
        size = max(len(a), len(b))
        a, b = a + [0] * (size - len(a)), b + [0] * (size - len(b))
        power, other = sum(x * x for x in a), sum(x * x for x in b)
        apart = sum((x - y) ** 2 for x, y in zip(a, b))
        if apart: difference = max(difference, 10 * math.log10(apart / power))
        level = max(level, abs(10 * math.log10(other / power)))
    bad |= frequency > 1e-10 or difference > -80 or level > 0.01
    states = [open(f"{work}/{kernel}/{suite}").read().strip() for suite in ("bake", "sound", "session")]
    bad |= states != ["passed"] * 3
    print(f"{kernel:12} {states[0]:8} {states[1]:8} {states[2]:8} {frequency:12.1e} {'equal' if difference == -math.inf else f'{difference:.1f}':>10} {level:10.5f}")
sys.exit(bad)
PY
