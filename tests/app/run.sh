#!/usr/bin/env bash
# intaglio run as a user meets it, driven by scripts through SDL's event queue without a screen: every scene, dragging, the pen,
# switching, dropping images, recording, resizing; and what goes wrong: no display, no sound card, a bad scene, a 1 x 1 texture.
#   run.sh INTAGLIO SOURCE_DIR
. "$(dirname "$0")/begin.sh"
export XDG_CONFIG_HOME="$work/config" XDG_CACHE_HOME="$work/cache"
export SDL_VIDEODRIVER=offscreen LP_NUM_THREADS=2

check() {
  local name=$1
  shift
  if "$@"; then echo "$name: ok"; else echo "$name: FAILED"; failures=$((failures + 1)); fi
}
# play NAME ARGUMENTS...: runs a script from standard input to its end; the report is in $work/NAME.json.
play() {
  local name=$1
  shift
  cat >"$work/$name.events"
  timeout 120 "$intaglio" run "$@" --audio null --width 320 --height 180 --script "$work/$name.events" --record-to "$work" --json \
    >"$work/$name.json" 2>"$work/$name.err"
}
# report NAME EXPRESSION: whether a Python expression of the report r holds.
report() {
  python3 -c "
import json, sys
r = json.load(open('$work/$1.json'))
sys.exit(0 if ($2) else print(json.dumps(r, indent=1)[:3000]) or 1)"
}

for scene in "$source"/scenes/*.toml; do
  name=$(basename "$scene" .toml)
  printf '0.2 screenshot %s/%s.png\n0.4 quit\n' "$work" "$name" | play "$name" "$scene" --fresh
  check "$name opens and closes" [ $? -eq 0 ]
  check "$name: no OpenGL errors, every sense ticks" \
    report "$name" "r['gl_errors'] == 0 and r['frames']['count'] > 0 and r['touch']['ticks'] > 50 and r['dynamics']['steps'] > 5 and r['sound']['buffers'] > 5"
  check "$name: a picture" [ -s "$work/$name.png" ]
done

python3 - "$work" <<'PYTHON'
import struct, sys, zlib
def png(name, width, height, pixel):
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    raw = b"".join(b"\0" + bytes(pixel(i, j) for i in range(width)) for j in range(height))
    open(f"{sys.argv[1]}/{name}", "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
        + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))
png("waves.png", 64, 64, lambda i, j: 255 if (i // 8 + j // 8) % 2 else 60)
png("dot.png", 1, 1, lambda i, j: 128)
open(f"{sys.argv[1]}/broken.png", "w").write("not an image")
open(f"{sys.argv[1]}/broken.toml", "w").write("[surface]\ndepht = 1\n")
PYTHON

play hands --fresh <<SCRIPT
0.1 move 0.5 0.45
0.2 down left
0.3 move 0.55 0.3
0.6 up left
0.7 set pen 1
0.8 move 0.6 0.6
0.9 down left
1.3 move 0.65 0.6
1.6 up left
1.7 wheel 3
1.8 down right
1.9 move 0.5 0.5
2.0 up right
2.1 hold W
2.3 release W
2.4 key Space
2.5 key N
2.6 key Space
2.7 key B
2.8 key R
2.9 key Tab
3.0 key Tab
3.1 key M
3.2 key H
3.4 quit
SCRIPT
check "mouse and keys" report hands "r['gl_errors'] == 0 and r['frames']['count'] > 10"

play switching --fresh <<SCRIPT
0.1 key 1
0.5 key 2
0.9 key 3
1.3 set papers_method 1
1.7 set papers_method 0
1.8 set depth 0.005
2.2 set moves 0
2.4 set feels 0
2.6 set hears 0
2.8 set sees 0
3.6 quit
SCRIPT
check "representations, methods, depth, senses" report switching "r['gl_errors'] == 0"

play lies "$source/scenes/training.toml" --fault sound-delay=60ms,picture=off --fresh <<SCRIPT
0.3 set touch_delay 60
1.3 set picture_on 1
2.3 set ball_motion_shift -20
2.3 set touch_on 0
4.0 quit
SCRIPT
check "cues of every kind, live" report lies "r['gl_errors'] == 0 and any('cues: picture off, sound late by 60 ms' in m for m in r['messages']) and 'touch off, touch late by 60 ms' in r['messages'][-1] and 'motion shifted by -20 mm along u' in r['messages'][-1]"

play dropping --fresh <<SCRIPT
0.1 drop $work/waves.png
1.5 drop $work/dot.png
2.5 drop $work/broken.png
3.5 drop $work/broken.toml
4.5 drop $work/none.png
6.0 quit
SCRIPT
check "dropped images: good ones are the floor, bad ones are said and the window goes on" \
  report dropping "r['gl_errors'] == 0 and any('broken.png' in m for m in r['messages']) and any('none.png' in m for m in r['messages'])"

play switched --fresh <<SCRIPT
1.5 key 1
2.5 key 3
3.0 quit
SCRIPT
check "steps and ticks are counted from the start, not from the last switch" report switched \
  "r['dynamics']['steps'] + r['dynamics']['left_out'] > 0.6 * 480 * (r['seconds'] - r['start_seconds']) and r['touch']['ticks'] + r['touch']['left_out'] > 0.6 * 1000 * (r['seconds'] - r['start_seconds'])"

# A recording whose window is killed leaves hidden temporaries, of which the next start makes a video.
hidden() { find "$work" -maxdepth 1 -name '.*.intaglio-*.part.*'; }
printf '0.1 key F9\n100 quit\n' >"$work/killed.events"
"$intaglio" run --fresh --audio null --width 320 --height 180 --script "$work/killed.events" --record-to "$work" >"$work/killed.txt" 2>&1 &
killed=$!
for _ in $(seq 300); do
  [ "$(hidden | wc -l)" -lt 3 ] || break
  sleep 0.1
done
sleep 3
kill -KILL $killed
wait $killed 2>/dev/null
check "a killed recording leaves temporaries only" [ "$(hidden | wc -l)" -eq 3 -a -z "$(ls "$work" | grep mp4)" ]
printf '4.0 quit\n' | play recovering --fresh
check "a killed recording is recovered" report recovering "any(m.startswith('recovered') for m in r['messages']) and len(r['written']) == 1"
video=$(ls "$work"/*.mp4 2>/dev/null | head -1)
streams() { ffprobe -v error -show_entries stream=codec_name,channels -of csv=p=0 "$video" 2>/dev/null | sort | tr '\n' ' '; }
check "all but its last second" python3 -c "import sys; sys.exit(not 2 <= float(sys.argv[1] or 0) < 6)" \
  "$(ffprobe -v error -show_entries format=duration -of csv=p=0 "$video" 2>/dev/null)"
check "the recovered video has picture and sound" [ "$(streams)" = "aac,2 h264 " ]
check "no temporaries after the recovery" [ -z "$(hidden)" ]
rm -f "$work"/*.mp4

play recording --fresh <<SCRIPT
0.1 key F9
1.0 resize 400 300
2.5 key F9
3.5 key F12
3.6 quit
SCRIPT
check "a recording through a resize" report recording "r['gl_errors'] == 0 and any(w.endswith('.mp4') for w in r['written'])"
video=$(ls "$work"/*.mp4 2>/dev/null | head -1)
check "the video has picture and sound in stereo" [ "$(streams)" = "aac,2 h264 " ]
check "no leftovers of the recording" [ -z "$(ls -A "$work" | grep -E '[.]part[.]|recording.wav|tmp')" ]

if [ -w /dev/full ]; then
  mkdir "$work/bin"
  printf '#!/bin/sh\ncat >/dev/full\n' >"$work/bin/ffmpeg"; chmod +x "$work/bin/ffmpeg"
  printf '0.1 key F9\n2.0 quit\n' | PATH="$work/bin:$PATH" play full --fresh 2>/dev/null
  check "a full disk while recording is said, and the window goes on" report full "any('disk full' in m for m in r['messages']) and r['seconds'] > 1.5"
else
  skipped "no /dev/full" "app_run: a full disk while recording"
fi

# Hot reload: a scene that changes is read again, one that is broken is not.
cp "$source/scenes/brick.toml" "$work/hot.toml"
(sleep 6; printf 'broken' >"$work/hot.toml") &
printf '12 quit\n' | play hot "$work/hot.toml" --fresh
check "a scene that breaks while it is shown is said" report hot "any('hot.toml' in m for m in r['messages'])"
wait

# Shaders that are worked on, and the ways to draw relief.
cp -r "$source/src/render/shaders" "$work/shaders"
(sleep 4; echo broken >>"$work/shaders/lighting.glsl") &
printf '0.3 set mesh 64\n0.8 set mesh 0\n1.0 set classic 1\n1.5 set classic 0\n7 quit\n' | play shaders --fresh --shaders "$work/shaders"
check "meshes and steps in place of the exact trace; a shader that breaks is said with file and line" \
  report shaders "r['gl_errors'] == 0 and any('lighting.glsl:' in m for m in r['messages'])"
wait

# The pen changes hands while the window is open: our own VRPN server's, one that is not there, the mouse again.
"$intaglio" devices serve --port 0 >"$work/server.log" 2>&1 &
server=$!
for _ in $(seq 200); do grep -q '^serving' "$work/server.log" && break; sleep 0.05; done
port=$(sed -n 's/^serving Phantom0 on 127.0.0.1:\([0-9]*\);.*/\1/p' "$work/server.log")
play pens --fresh <<SCRIPT
0.2 device Phantom0@127.0.0.1:$port
2.5 device Nobody0@127.0.0.1:1
6.5 device mouse
8.0 quit
SCRIPT
check "a VRPN pen is taken, one that does not answer is said, and the mouse is the pen again" report pens \
  "r['gl_errors'] == 0 and [m for m in r['messages'] if 'pen:' in m][0].startswith('pen: Phantom0') and any('pens.events:2' in m and 'does not answer' in m for m in r['messages']) and any('pen: mouse' in m for m in r['messages'])"
kill "$server"
wait "$server" 2>/dev/null

printf '0.1 set volume -12\n0.3 quit\n' | play kept
check "settings are kept" grep -q '^volume = -12' "$work/config/intaglio/window.toml"

# One line on standard error that matches, and an exit code.
refused() {
  local pattern=$1
  shift
  "$@" >"$work/out" 2>"$work/err"
  local code=$?
  [ $code -eq 1 ] && [ "$(wc -l <"$work/err")" -eq 1 ] && grep -qE "$pattern" "$work/err" && return
  echo "exit code $code:"; cat "$work/err"; return 1
}
check "no display" refused 'no display.*intaglio render' env -u SDL_VIDEODRIVER -u DISPLAY -u WAYLAND_DISPLAY "$intaglio" run
check "a display that is not there" refused 'display' env -u SDL_VIDEODRIVER -u WAYLAND_DISPLAY DISPLAY=:9931 "$intaglio" run
check "a bad scene" refused 'broken\.toml:2' "$intaglio" run "$work/broken.toml"
printf '1 jump\n' >"$work/bad.events"
check "a bad script" refused 'bad\.events:1' "$intaglio" run --script "$work/bad.events"
for line in 'point -1' 'resize 0 0' 'set depth -5' 'set nosuch 1' 'device nowhere' 'key Spase' 'screenshot x.jpg'; do
  printf '0 wheel 1\n1 %s\n' "$line" >"$work/bad.events"
  check "script: $line" refused 'bad\.events:2: ' "$intaglio" run --script "$work/bad.events"
done
play asked --fresh <<SCRIPT
0.2 point 99
0.3 device Nobody0@127.0.0.1:1
0.5 quit
SCRIPT
check "a body that is not there and a device that has not answered are said with the script's lines" report asked \
  "any('asked.events:1: there is no body 99' in m for m in r['messages']) and any('asked.events:2: Nobody0@127.0.0.1:1' in m for m in r['messages'])"
check "recordings into a file" refused 'dot\.png: is a file; --record-to takes a folder' "$intaglio" run --record-to "$work/dot.png"
check "recordings below a file" refused 'dot\.png/x: has a file as parent' "$intaglio" run --record-to "$work/dot.png/x"
check "no such sound card" refused 'no audio device|nobody' "$intaglio" run --audio nobody
check "no such pen" refused 'Nobody' "$intaglio" run --audio null --device Nobody0@127.0.0.1:1
check "a texture that is not there" refused 'none\.png' "$intaglio" run --audio null --surface "$work/none.png" --fresh

[ $failures -eq 0 ] && echo "the window does what it should"
exit $((failures > 0))
