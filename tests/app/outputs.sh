#!/usr/bin/env bash
# Results that the command writes: files that belong together are all new or all old, users' files are left alone, links are followed,
# and leftovers of a killed command are removed by the next.   outputs.sh INTAGLIO SOURCE_DIR
. "$(dirname "$0")/begin.sh"
mounted=()
clean_up() {
  for disk in "${mounted[@]}"; do umount "$disk"; done
  rm -rf "$work"
}
trap clean_up EXIT
fault() {
  echo "wrong: $*"
  failures=$((failures + 1))
}

# A small, quick scene with all the files of a render.
mkdir "$work/scene"
ln -s "$source/scenes/models" "$work/scene/models"
sed 's/^width = .*/width = 64/; s/^height = .*/height = 36/; s/^fps = .*/fps = 10/; s/^supersample = .*/supersample = 1/' \
  "$source/scenes/brick.toml" >"$work/scene/brick.toml"
render() { timeout 60 "$intaglio" -q render "$work/scene/brick.toml" -o "$1" --duration "$2" 2>"$work/stderr"; }
sums() { (cd "$1" && sha256sum out.*); }
hidden() { find "$1" -name '.*' -type f; }
files="out.events.csv out.html out.mp4 out.servo.csv out.wav"

# A killed command leaves the old files and nothing but hidden temporaries, which the next removes.
out=$work/killed
render "$out/out.mp4" 0.1 || fault "a render failed: $(cat "$work/stderr")"
[ "$(cd "$out" && echo *)" = "$files" ] || fault "a render wrote $(ls "$out")"
old=$(sums "$out")
left=
for pause in 0 0.2; do
  "$intaglio" -q render "$work/scene/brick.toml" -o "$out/out.mp4" --duration 600 &
  victim=$!
  for _ in $(seq 600); do # until it has those of video, picture, sound and both logs, and has removed those of the one killed before
    [ "$(hidden "$out" | grep -vxF -e "${left:-none}" | wc -l)" -eq 5 ] && break
    sleep 0.02
  done
  sleep $pause
  kill -KILL $victim
  wait $victim 2>/dev/null
  left=$(hidden "$out")
  [ "$(grep -cE '/\.out\.(mp4|mp4\.picture\.mp4|wav|events\.csv|servo\.csv)\.intaglio-[0-9a-f]{12}\.part\.(mp4|wav|csv)$' <<<"$left")" -eq 5 ] &&
    [ "$(wc -l <<<"$left")" -eq 5 ] ||
    fault "left by a killed render: $left"
  [ "$(sums "$out")" = "$old" ] || fault "a killed render changed the files of the one before"
done
touch "$out/.out.mp4.intaglio-000000000000.part.mp4" # of the form, but no name of ours
render "$out/out.mp4" 0.1 || fault "the render after a killed one failed: $(cat "$work/stderr")"
[ "$(hidden "$out")" = "$out/.out.mp4.intaglio-000000000000.part.mp4" ] || fault "left after the next render: $(hidden "$out")"

# Users' files whose names a temporary might have, also as a link or a pipe.
out=$work/own
mkdir "$out"
for name in out.part.mp4 out.silent.mp4 out.recording.wav out.mp4.part; do echo "mine" >"$out/$name"; done
echo "precious" >"$work/victim"
ln -s "$work/victim" "$out/out.part.wav"
mkfifo "$out/out.part.html"
render "$out/out.mp4" 0.1 || fault "a render beside users' files failed: $(cat "$work/stderr")"
for name in out.part.mp4 out.silent.mp4 out.recording.wav out.mp4.part; do
  [ "$(cat "$out/$name" 2>&1)" = "mine" ] || fault "$name is the user's and is gone"
done
[ "$(cat "$work/victim")" = "precious" ] || fault "a link at a temporary's name was followed"
[ -L "$out/out.part.wav" ] && [ -p "$out/out.part.html" ] || fault "a link or a pipe of the user's is gone"

# A result that is a link goes to the file that the link names, and keeps that file's permissions.
out=$work/linked
mkdir -p "$out/elsewhere"
echo "old" >"$out/elsewhere/video.mp4"
chmod 640 "$out/elsewhere/video.mp4"
ln -s elsewhere/video.mp4 "$out/out.mp4"
ln -s elsewhere/sound.wav "$out/out.wav"
render "$out/out.mp4" 0.1 || fault "a render to a link failed: $(cat "$work/stderr")"
[ -L "$out/out.mp4" ] && [ -L "$out/out.wav" ] || fault "a link was replaced"
[ "$(head -c 8 "$out/elsewhere/video.mp4" | tail -c 4)" = "ftyp" ] || fault "the video is not where its link leads"
[ "$(head -c 4 "$out/elsewhere/sound.wav")" = "RIFF" ] || fault "the sound is not where its link leads"
[ "$(stat -c %a "$out/elsewhere/video.mp4")" = 640 ] || fault "the permissions of the video have changed"
[ -z "$(hidden "$out")" ] || fault "left beside a link: $(hidden "$out")"
ln -sf out.mp4 "$out/out.wav"
render "$out/out.mp4" 0.1 && fault "one file was written twice"
grep -q 'out\.wav: is the same file as .*out\.mp4' "$work/stderr" || fault "one file for two results: $(cat "$work/stderr")"

# all_or_nothing NAME STEP_KB STEPS FIRST SECOND: FIRST writes into the folder $disk; then SECOND does at more and more free space, until
# it succeeds. As long as it fails, every file is the first one's. With INTAGLIO_SLOW=1 at every page of the disk that there is.
all_or_nothing() {
  local name=$1 step=$2 steps=$3 first=$4 second=$5 failed=0 old k
  [ -z "${INTAGLIO_SLOW:-}" ] || { steps=$((steps * step / 4)); step=4; }
  disk=$work/$name
  mkdir "$disk"
  if ! mount -t tmpfs -o size=8m tmpfs "$disk" 2>/dev/null; then
    skipped "no right to mount a small disk" "app_outputs: $name on a full disk"
    return
  fi
  mounted+=("$disk")
  $first || fault "$name: the first one failed: $(cat "$work/stderr")"
  old=$(sums "$disk")
  for k in $(seq 0 "$steps"); do
    # All that is free, less k steps.
    rm -f "$disk/fill"
    head -c $((($(stat -f -c '%a * %S' "$disk") - k * step * 1024))) /dev/zero >"$disk/fill"
    if $second; then
      [ "$(sums "$disk" | sort)" != "$old" ] && [ "$(comm -12 <(sums "$disk" | sort) <(sort <<<"$old") | wc -l)" -eq 0 ] ||
        fault "$name: not all files are new with $((k * step)) kB free"
      break
    fi
    failed=$((failed + 1))
    [ "$(sums "$disk")" = "$old" ] || fault "$name: the old files have changed with $((k * step)) kB free"
    grep -qi 'disk.*full' "$work/stderr" && [ "$(wc -l <"$work/stderr")" -eq 1 ] ||
      fault "$name: with $((k * step)) kB free it said $(cat "$work/stderr")"
    [ -z "$(hidden "$disk")" ] || fault "$name: left with $((k * step)) kB free: $(hidden "$disk")"
  done
  [ "$failed" -gt 1 ] && [ "$failed" -le "$steps" ] || fault "$name: failed at $failed of $steps sizes"
  echo "$name: the old files stand after $failed failures on a full disk"
}
first_render() { render "$disk/out.mp4" 0.1; }
second_render() { render "$disk/out.mp4" 0.2; }
all_or_nothing render 48 14 first_render second_render
import() {
  timeout 60 "$intaglio" -q import "$1" --size 64 -o "$disk/textures" >/dev/null 2>"$work/stderr"
  local code=$?
  # sums() looks for out.*
  for file in relief color; do ln -sf "textures/$file.png" "$disk/out.$file"; done
  return $code
}
first_import() { import brick; }
second_import() { import pebbles; }
all_or_nothing import 8 14 first_import second_import

[ $failures -eq 0 ] && echo "outputs are whole"
exit $((failures > 0))
