#!/usr/bin/env bash
# Bad input to the command, as a user would give it: one line that names the file, an exit code that is not 0, and nothing left
# behind.   bad_input.sh INTAGLIO SOURCE_DIR
set -uo pipefail
intaglio=$1
source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0

# expect NAME PATTERN COMMAND...: the command fails with one line on standard error that matches PATTERN.
expect() {
  local name=$1 pattern=$2
  shift 2
  rm -rf "$work/out"
  "$@" >"$work/stdout" 2>"$work/stderr"
  local code=$?
  local lines
  lines=$(wc -l <"$work/stderr")
  if [ $code -eq 0 ] || [ $code -ge 128 ]; then
    echo "$name: exit code $code"; failures=$((failures + 1))
  elif [ "$lines" -ne 1 ] || ! grep -qE "$pattern" "$work/stderr"; then
    echo "$name: expected one line like /$pattern/, got:"; cat "$work/stderr"; failures=$((failures + 1))
  elif [ -n "$(find "$work/out" -type f 2>/dev/null)" ]; then
    echo "$name: left behind: $(find "$work/out" -type f)"; failures=$((failures + 1))
  else
    echo "$name: ok: $(cat "$work/stderr")"
  fi
}
render() { "$intaglio" -q render "$@" -o "$work/out/x.mp4" --duration 0.2; }

scene=$source/scenes/brick.toml
printf 'title = "x"\n[[ball]]\nradius = nan\n' >"$work/nan.toml"
printf '[[body]]\nmass = 1e300\n' >"$work/dense.toml"
printf '[[ball]]\nposition = [1e200, 0, 0]\n' >"$work/far.toml"
printf '[camera]\neye = [1, 1, 1]\ntarget = [1, 1, 1]\n' >"$work/camera.toml"
printf '[[ball]]\nradius = 0.1\nmass = -2\n' >"$work/mass.toml"
printf '[surface]\ndepht = 0.1\n' >"$work/key.toml"
: >"$work/empty.png"
head -c 50 "$source/fuzz/seeds/image_png/rgb8.png" >"$work/cut.png"
head -c 300 "$source/fuzz/seeds/image_jpeg/rgb.jpg" >"$work/cut.jpg"
echo "not an image" >"$work/text.png"
mkdir "$work/nothing"

expect "missing scene" 'brik\.toml: no such file; did you mean .*brick\.toml' render "$source/scenes/brik.toml"
expect "missing image" 'no_such\.png: no such file' render "$scene" --surface "$work/no_such.png"
expect "empty image" 'empty\.png: .*0 bytes' render "$scene" --surface "$work/empty.png"
expect "truncated PNG" 'cut\.png: .*broken PNG' render "$scene" --surface "$work/cut.png"
expect "truncated JPEG" 'cut\.jpg: .*broken JPEG' render "$scene" --surface "$work/cut.jpg"
expect "not an image" 'text\.png: ' render "$scene" --surface "$work/text.png"
expect "folder without images" 'nothing: ' render "$scene" --surface "$work/nothing"
expect "NaN in a scene" 'nan\.toml:3: .*finite' render "$work/nan.toml"
expect "NaN on the command line" 'nan: a number must be finite' render "$scene" --duration nan
expect "NaN in a list" 'nan,0,0: a number must be finite' "$intaglio" -q sound strike "$work/any.modes" --at=nan,0,0
expect "a mass no body has" 'dense\.toml:2: .*kg/m3' render "$work/dense.toml"
expect "a ball too far" 'far\.toml:2: .*10000' render "$work/far.toml"
expect "a camera without direction" 'camera\.toml:2: .*two places' render "$work/camera.toml"
expect "negative mass" 'mass\.toml:3: .*greater than 0' render "$work/mass.toml"
expect "unknown key" 'key\.toml:2: .*did you mean "depth"' render "$work/key.toml"
expect "unwritable output" 'cannot' "$intaglio" -q render "$scene" -o "$work/empty.png/under/x.mp4"
expect "not an mp4" 'avi: ' "$intaglio" -q render "$scene" -o "$work/out/x.avi"
expect "no ffmpeg" 'ffmpeg: not found' env PATH=/nonexistent "$intaglio" -q render "$scene" -o "$work/out/x.mp4" --duration 0.2
printf '#!/bin/sh\nexit 3\n' >"$work/ffmpeg"; chmod +x "$work/ffmpeg"
expect "an ffmpeg that fails" 'encoder' env PATH="$work" "$intaglio" -q render "$scene" -o "$work/out/x.mp4" --duration 0.2

bake() { "$intaglio" -q bake "$@" -o "$work/out/x.modes"; }
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0.5\nf 1 2 3\nf 2 4 3\n' >"$work/sheet.obj"
printf 'solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0' >"$work/cut.stl"
printf 'density = 7850\n' >"$work/partial.toml"
printf 'name = "steel"\npoisson_ratio = 0.7\n' >"$work/poisson.toml"
expect "missing mesh" 'no_such\.obj: no such file' bake "$work/no_such.obj" --material steel
expect "surface without volume" 'sheet\.obj: .*(no volume|is open).*' bake "$work/sheet.obj" --material steel
expect "truncated STL" 'cut\.stl:5: .*vertex' bake "$work/cut.stl" --material steel
expect "not a mesh" 'text\.png: .*use \.obj, \.stl' bake "$work/text.png" --material steel
expect "no such shape size" 'r=-1.* is no size' bake sphere:r=-1 --material steel
expect "no such material" 'did you mean "steel"' bake sphere:r=0.05 --material steal
expect "partial material" 'partial\.toml: youngs_modulus is missing' bake sphere:r=0.05 --material "$work/partial.toml"
expect "impossible material" 'poisson\.toml:2: .*Poisson' bake sphere:r=0.05 --material "$work/poisson.toml"
expect "nothing to hear" 'no mode rings' bake sphere:r=0.01 --material steel

[ $failures -eq 0 ] && echo "all bad input is refused in one line"
exit $((failures > 0))
