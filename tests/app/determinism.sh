#!/usr/bin/env bash
# The same scene twice, with one thread and with two: the same event log, the same sound, the same pictures.
#   determinism.sh INTAGLIO SOURCE_DIR
set -euo pipefail
intaglio=$1
source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
printf '[video]\nwidth = 64\nheight = 36\n[sound]\nmodes = 20\n[[ball]]\nradius = 0.04\nposition = [-0.3, 0.06, 0.2]\nvelocity = [1, 0, -0.4]\n[pen]\npath = [[0, 0.05, 0.01, 0], [0.3, 0.05, -0.01, 0], [1.0, 0.0, -0.01, 0.05]]\n' >"$work/scene.toml"
for run in 1-1 1-2 2-1; do
  "$intaglio" -q render "$work/scene.toml" -o "$work/$run.mp4" --duration 1 --threads "${run%-*}"
done
for other in 1-2 2-1; do
  for kind in events.csv servo.csv wav mp4; do
    cmp "$work/1-1.$kind" "$work/$other.$kind"
  done
done
# Replaying the pen's log gives the same forces.
"$intaglio" -q replay "$work/1-1.servo.csv" --scene "$work/scene.toml" -o "$work/felt.html" | grep -q "largest force difference 0 N"
grep -q "<svg" "$work/felt.html"
[ "$(wc -l <"$work/1-1.events.csv")" -gt 100 ]
echo "three runs are the same to the bit"
