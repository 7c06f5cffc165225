#!/usr/bin/env bash
# Models and textures heard from the command line, on a machine that may have no sound card.   sound.sh INTAGLIO SOURCE_DIR
set -euo pipefail
intaglio=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fails() { # PATTERN COMMAND...: one line on standard error that matches, exit code 1
  local pattern=$1 code=0
  shift
  "$@" >/dev/null 2>"$work/err" || code=$?
  if [ $code -ne 1 ] || [ "$(wc -l <"$work/err")" -ne 1 ] || ! grep -qE "$pattern" "$work/err"; then
    echo "expected one line like /$pattern/, got code $code:"; cat "$work/err"; exit 1
  fi
}
size() { stat -c %s "$1"; }

"$intaglio" sound devices | grep -q "^null"
"$intaglio" -q bake box:x=0.2,y=0.02,z=0.1 --material wood --modes 20 --elements 2000 -o "$work/box.modes"
"$intaglio" sound strike "$work/box.modes" -o "$work/a.wav" | grep -q "dB SPL"
"$intaglio" -q sound strike "$work/box.modes" -o "$work/b.wav"
cmp "$work/a.wav" "$work/b.wav" # deterministic
"$intaglio" -q sound strike "$work/box.modes" --at 0.1,0.01,0.05 --direction 0,-1,0 --mallet steel --scale 2 -o "$work/c.wav"
! cmp -s "$work/a.wav" "$work/c.wav"
[ "$(size "$work/a.wav")" -gt 10000 ]
"$intaglio" sound strike "$work/box.modes" --live --device null | grep -q "underruns"
fails 'no output given' "$intaglio" sound strike "$work/box.modes"
fails 'no such file' "$intaglio" sound strike "$work/none.modes" -o "$work/x.wav"
fails 'has no vertex' "$intaglio" sound strike "$work/box.modes" --vertex 1000000 -o "$work/x.wav"
fails 'did you mean "steel"' "$intaglio" sound strike "$work/box.modes" --mallet steal -o "$work/x.wav"
fails 'no audio device' "$intaglio" sound strike "$work/box.modes" --live --device "no such card"
fails 'did you mean' "$intaglio" sound scrape brick_runing -o "$work/x.wav"
[ ! -e "$work/x.wav" ]
"$intaglio" -q sound page metal_mesh -o "$work/page"
[ "$(find "$work/page" -type f | wc -l)" -eq 7 ]
grep -q 'metal_mesh_roll.mp3' "$work/page/index.html"
echo "models and textures are heard"
