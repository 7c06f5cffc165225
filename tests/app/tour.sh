#!/usr/bin/env bash
# A tour of the window, one run a scene: a body is dragged, representations are switched, an image is dropped, five seconds are
# recorded, the window is resized and closed. No OpenGL errors, nothing left behind, and how every sense kept its deadlines. With
# a build under a sanitizer (script/sanitize-window) its findings fail the run.
#   tour.sh INTAGLIO SOURCE_DIR [SCENE...]
# Models come from INTAGLIO_MODELS (a folder as ~/.cache/intaglio/models), so that nothing is baked meanwhile; INTAGLIO_PRELOAD is a
# library that stays loaded to the end; INTAGLIO_LINGER is how many seconds to wait before closing; with
# INTAGLIO_BAKED a model that is still being made then is a failure.
set -uo pipefail
intaglio=$1
source=$2
shift 2
[ $# -gt 0 ] || set -- "$source"/scenes/*.toml
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0
export XDG_CONFIG_HOME="$work/config" XDG_CACHE_HOME="$work/cache" LP_NUM_THREADS=2
: "${SDL_VIDEODRIVER:=offscreen}"
export SDL_VIDEODRIVER
mkdir -p "$work/cache/intaglio"
[ -z "${INTAGLIO_MODELS:-}" ] || ln -s "$INTAGLIO_MODELS" "$work/cache/intaglio/models"
python3 - "$work/waves.png" <<'PYTHON'
import struct, sys, zlib
chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
rows = b"".join(b"\0" + bytes(255 if (i // 8 + j // 8) % 2 else 60 for i in range(64)) for j in range(64))
open(sys.argv[1], "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 64, 64, 8, 0, 0, 0, 0))
    + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
PYTHON
cat >"$work/tour.events" <<SCRIPT
0.1 set panels 0
0.8 set paused 1
0.9 point 0
1.1 down left
1.2 set paused 0
1.3 move 0.5 0.4
1.8 up left
1.9 set panels 1
2.0 key 1
2.8 key 2
3.6 key 3
4.4 drop $work/waves.png
5.4 key F9
7.0 resize 400 300
10.5 key F9
$(awk "BEGIN { print 10.5 + ${INTAGLIO_LINGER:-0.5} }") quit
SCRIPT

printf '%-10s %-9s %7s %9s %8s %8s %9s %9s %9s %9s\n' scene driver frames p50_ms p99_ms '>33_ms' ticks left_out steps_out underruns
for scene in "$@"; do
  name=$(basename "$scene" .toml)
  timeout 300 env ${INTAGLIO_PRELOAD:+LD_PRELOAD="$INTAGLIO_PRELOAD"} "$intaglio" run "$scene" --fresh --audio null --width 320 --height 180 --script "$work/tour.events" \
    --record-to "$work" --json >"$work/$name.json" 2>"$work/$name.err"
  code=$?
  python3 - "$work/$name.json" "$name" "$code" <<'PYTHON' || { failures=$((failures + 1)); head -c 6000 "$work/$name.err"; }
import json, os, sys
file, name, code = sys.argv[1:]
try:
    r = json.load(open(file))
except ValueError:
    sys.exit(print(f"{name}: FAILED with code {code}, no report") or 1)
f, t = r["frames"], r["touch"]
print(f"{name:10} {r['driver'].split(',')[0]:9} {f['count']:7} {1e3 * f['median_s']:9.1f} {1e3 * f['p99_s']:8.1f} {f['over_33_ms']:8} "
      f"{t['ticks']:9} {t['left_out']:9} {r['dynamics']['left_out']:9} {r['sound']['underruns']:9}")
wrong = [what for what, bad in {
    "exit code " + code: code != "0", "OpenGL errors " + str(r["gl_error_names"]): r["gl_errors"] > 0,
    "nothing was dragged": r["bodies_taken"] < 1, "no frames": f["count"] < 10, "no touch": t["ticks"] < 50,
    "no steps": r["dynamics"]["steps"] < 5, "no sound": r["sound"]["buffers"] < 5,
    "no recording": not any(w.endswith(".mp4") for w in r["written"]),
    "the image was not taken": not any("from waves.png" in m for m in r["messages"]),
    "a model was still being baked": r["was_baking"] and os.environ.get("INTAGLIO_BAKED"),
    "a sanitizer's finding": b"Sanitizer: " in open(file[:-4] + "err", "rb").read()}.items() if bad]
sys.exit(print(f"{name}: FAILED: " + "; ".join(wrong), r["messages"]) or 1 if wrong else 0)
PYTHON
  mv "$work"/*.mp4 "$work/$name.done" 2>/dev/null
done
[ $failures -eq 0 ] && echo "the tour is over, nothing was wrong"
exit $((failures > 0))
