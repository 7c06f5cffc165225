#!/usr/bin/env bash
# Bad input to the command, as a user would give it: one line that names the file, an exit code that is not 0, and nothing left
# behind.   bad_input.sh INTAGLIO SOURCE_DIR
. "$(dirname "$0")/begin.sh"

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
  elif [ "$lines" -ne 1 ] || ! grep -qE -e "$pattern" "$work/stderr"; then
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

# A wrong fault is a wrong command line: exit code 2, and a line more that names --help.
refuse() {
  render "$scene" --fault "$1" 2>"$work/stderr"
  local code=$?
  if [ $code -eq 2 ] && grep -qF -e "--fault: $1: $2" "$work/stderr" && [ ! -e "$work/out/x.mp4" ]; then
    echo "fault $1: ok"
  else
    echo "fault $1: exit code $code"; cat "$work/stderr"; failures=$((failures + 1))
  fi
}
refuse sond-delay=60ms 'there is no cue "sond"; did you mean sound?'
refuse sound-delay=-60ms 'a delay is negative: no sense can be early'
expect "no texture of a cue" 'touch=nowhere\.png: nowhere\.png: no such file' render "$scene" --fault touch=nowhere.png
expect "missing scene" 'brik\.toml: no such file; did you mean .*brick\.toml' render "$source/scenes/brik.toml"
expect "missing image" 'no_such\.png: no such file' render "$scene" --surface "$work/no_such.png"
expect "empty image" 'empty\.png: .*0 bytes' render "$scene" --surface "$work/empty.png"
expect "truncated PNG" 'cut\.png: .*broken PNG' render "$scene" --surface "$work/cut.png"
expect "truncated JPEG" 'cut\.jpg: .*broken JPEG' render "$scene" --surface "$work/cut.jpg"
expect "not an image" 'text\.png: ' render "$scene" --surface "$work/text.png"
expect "folder without images" 'nothing: ' render "$scene" --surface "$work/nothing"
expect "NaN in a scene" 'nan\.toml:3: .*finite' render "$work/nan.toml"
expect "NaN on the command line" 'nan: not a finite number' render "$scene" --duration nan
expect "NaN in a list" 'nan,0,0: not a finite number' "$intaglio" -q sound strike "$work/any.modes" --at=nan,0,0
expect "a mass no body has" 'dense\.toml:2: .*kg/m3' render "$work/dense.toml"
expect "a ball too far" 'far\.toml:2: .*10000' render "$work/far.toml"
expect "a camera without direction" 'camera\.toml:2: .*different points' render "$work/camera.toml"
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
expect "no such shape size" 'r=-1.* is not a valid size' bake sphere:r=-1 --material steel
expect "no such material" 'did you mean "steel"' bake sphere:r=0.05 --material steal
expect "partial material" 'partial\.toml: youngs_modulus is missing' bake sphere:r=0.05 --material "$work/partial.toml"
expect "impossible material" 'poisson\.toml:2: .*Poisson' bake sphere:r=0.05 --material "$work/poisson.toml"
printf 'name = "steel"\ndensity = 1e-3\n' >"$work/light.toml"
expect "a density no body has" 'light\.toml:2: density is 0.001; .*between 1 and 100000' bake sphere:r=0.05 --material "$work/light.toml"
printf 'name = "steel"\nyoungs_modulus = 1e4\ndensity = 1e5\n' >"$work/soft.toml"
expect "a sound too slow" 'soft\.toml:2: the speed of sound would be .* m/s' bake sphere:r=0.05 --material "$work/soft.toml"
printf 'name = "steel"\nrayleigh_alpha = 0\nrayleigh_beta = 0\n' >"$work/undamped.toml"
expect "a body without damping" 'undamped\.toml:2: the material has no damping' bake sphere:r=0.05 --material "$work/undamped.toml"
printf '[[body]]\nsize = [10, 0.001, 10]\nmaterial = { name = "steel", youngs_modulus = 1e6 }\n' >"$work/sheet.toml"
expect "a sheet too soft" 'sheet\.toml: modal analysis of the box 1 of steel failed: .*stiffer' render "$work/sheet.toml"
expect "a device for a scene" 'pipe\.wav: is a device or pipe' sh -c "mkfifo '$work/pipe.wav'; '$intaglio' -q render '$work/pipe.wav' -o '$work/out/x.mp4'"
expect "a size twice" 'r is given twice' bake sphere:r=0.05,r=0.1 --material steel
expect "a mesher for a shape" 'take no --mesher' bake sphere:r=0.05 --material steel --mesher netgen
expect "a scale for a shape" 'take no --scale' bake sphere:r=0.05 --material steel --scale 2
cuboid() {
  printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n'
  printf 'f 1 3 2\nf 2 3 4\nf 5 6 7\nf 6 8 7\nf 1 2 5\nf 2 6 5\nf 3 7 4\nf 4 7 8\nf 1 5 3\nf 3 5 7\nf 2 4 6\nf 4 8 6\n'
}
cuboid >"$work/cuboid.obj"
expect "a body too long" 'cuboid\.obj: is 1e\+06 m long; .*--scale' bake "$work/cuboid.obj" --material steel --scale 1e6
expect "a shell too thick" 'cuboid\.obj: is 1 m long, less than the shell.s thickness of 5 m' bake "$work/cuboid.obj" --material steel --thickness 5
expect "a model over a mesh" 'cuboid\.obj: is not named as a model; .*\.modes' "$intaglio" -q bake "$work/cuboid.obj" --material steel -o "$work/cuboid.obj"
[ "$(head -c 1 "$work/cuboid.obj")" = v ] || { echo "the mesh is gone"; failures=$((failures + 1)); }
mkdir -p "$work/twins"; cp "$work/cuboid.obj" "$work/twins/a.obj"; cp "$work/cuboid.obj" "$work/twins/a.stl"
all() { "$intaglio" -q bake --all "$1" --material steel --modes 5 -o "${2:-$work/out}"; }
expect "--all of no folder" 'none: No such file' all "$work/none"
expect "--all of a file" 'cuboid\.obj: Not a directory; --all takes a folder' all "$work/cuboid.obj"
expect "--all of nothing" 'nothing: holds no mesh' all "$work/nothing"
expect "--all of twins" 'a\.stl: would overwrite the model' all "$work/twins"
rm "$work/twins/a.stl"
expect "--all into a file" 'cuboid\.obj/a\.modes: cannot create its folder' all "$work/twins" "$work/cuboid.obj"
expect "nothing to hear" 'no mode between' bake sphere:r=0.01 --material steel

strike() { "$intaglio" -q sound strike "$@"; }
"$intaglio" -q bake box:x=0.2,y=0.02,z=0.1 --material wood --modes 5 --elements 500 -o "$work/box.modes"
: >"$work/empty.modes"
head -c 2000 "$work/box.modes" >"$work/cut.modes"
wav=$work/out/x.wav
expect "an empty model" 'empty\.modes: is not a modal model' strike "$work/empty.modes" -o "$wav"
expect "a truncated model" 'cut\.modes: is not a modal model, or is cut off' strike "$work/cut.modes" -o "$wav"
expect "a folder for a model" 'nothing: is a folder' strike "$work/nothing" -o "$wav"
expect "a model without name" 'argument 4 is empty' strike "" -o "$wav"
expect "a folder without name" 'argument 4 is empty' "$intaglio" import brick -o ""
expect "an option without value" 'argument 5 is empty' "$intaglio" -q sound page brick --output=
expect "a model that is none" 'box\.obj: no such file' strike "$work/box.obj" -o "$wav"
expect "a sound named otherwise" 'x\.mp3: is not named as a WAV file; end the name with \.wav' strike "$work/box.modes" -o "$work/out/x.mp3"
for verb in scrape roll drop; do
  expect "$verb named otherwise" 'x\.mp3: is not named as a WAV file' "$intaglio" -q sound $verb brick -o "$work/out/x.mp3"
done
expect "a sound over a pipe" 'pipe\.wav: is a device or pipe, not a file' strike "$work/box.modes" -o "$work/pipe.wav"
[ -p "$work/pipe.wav" ] || { echo "the pipe was replaced"; failures=$((failures + 1)); }
expect "a sound over a folder" 'nothing\.wav: is a folder' sh -c "mkdir -p '$work/nothing.wav'; '$intaglio' -q sound drop brick -o '$work/nothing.wav'"
expect "a sound below a file" 'cannot create its folder' strike "$work/box.modes" -o "$work/cuboid.obj/x.wav"
expect "a push of no length" '--direction: must be a non-zero vector' strike "$work/box.modes" --direction 1e300,1e300,0 -o "$wav"
expect "a mallet that is no file" 'none\.toml: no such file' strike "$work/box.modes" --mallet "$work/none.toml" -o "$wav"
expect "a mesh for a texture" 'cuboid\.obj: byte 0: no PNG' "$intaglio" -q sound drop "$work/cuboid.obj" -o "$wav"
expect "a scene for a recipe" 'brick\.toml:[0-9]+: unknown key' "$intaglio" -q sound roll "$scene" -o "$wav"
expect "a page of a texture that is not there" 'nosuch' "$intaglio" -q sound page -o "$work/out" brick nosuch
expect "a page of one texture twice" 'brick: gives the same output files as brick' "$intaglio" -q sound page -o "$work/out" brick brick
expect "a page below a file" 'cannot create its folder' "$intaglio" -q sound page -o "$work/cuboid.obj" brick
expect "an unknown verb" 'intaglio: unknown command "rnder"; did you mean "render"' "$intaglio" rnder x
expect "an unknown verb of sound" 'intaglio sound: unknown command "strik"; did you mean "strike"' "$intaglio" sound strik x
expect "a page that is no page" 'x\.png: is not named as a page' "$intaglio" -q inspect brick --html "$work/out/x.png"
expect "felt, as no page" 'x\.csv: is not named as a page' "$intaglio" -q replay "$work/none.servo.csv" -o "$work/out/x.csv"

# Textures and bases of a scene file, with its line.
printf '[surface]\n\ntexture = "none.png"\n' >"$work/texture.toml"
printf '[[ground]]\nbase = { shape = "mesh", file = "none.obj" }\n' >"$work/base.toml"
printf '[[ground]]\n[ground.base]\nshape = "bowl"\nfile = "none.obj"\n' >"$work/bowl.toml"
printf '[[body]]\n[body.top]\ntexture = "none.png"\n' >"$work/top.toml"
expect "a texture that is not there" 'texture\.toml:3: none\.png: no such file' render "$work/texture.toml"
expect "a mesh that is not there" 'base\.toml:2: none\.obj: no such file' render "$work/base.toml"
expect "a file for a bowl" 'bowl\.toml:4: a bowl does not use ground\.base\.file; .*radius, repeat' render "$work/bowl.toml"
expect "a top that is not there" 'top\.toml:3: none\.png: no such file' render "$work/top.toml"

# A full disk, where one can be made.
if mkdir "$work/full" && mount -t tmpfs -o size=16k tmpfs "$work/full" 2>/dev/null; then
  trap 'umount "$work/full"; rm -rf "$work"' EXIT
  head -c 14000 /dev/zero >"$work/full/fill"
  expect "a full disk" 'x\.wav: .*disk full' strike "$work/box.modes" -o "$work/full/x.wav"
  expect "a full disk for a page" 'disk full' "$intaglio" -q sound page -o "$work/full/page" brick
  expect "a full disk for a model" 'x\.modes: .*disk full' "$intaglio" -q bake "$work/cuboid.obj" --material steel --modes 5 -o "$work/full/x.modes"
  [ "$(find "$work/full" -type f | wc -l)" -eq 1 ] || { echo "left on the full disk: $(find "$work/full")"; failures=$((failures + 1)); }
else
  skipped "no right to mount a disk of 16 kB" "app_bad_input: a full disk"
fi

# Standard streams that are closed or full: results that are lost are no success, and nothing aborts.
streams() { # NAME CODE COMMAND...: the exit code
  local name=$1 wanted=$2 code
  shift 2
  bash -c "$*" intaglio "$intaglio" "$work" >"$work/log" 2>&1
  code=$?
  if [ $code -eq "$wanted" ]; then echo "$name: ok"; else
    echo "$name: exit code $code, expected $wanted"; cat "$work/log"; failures=$((failures + 1)); fi
}
streams "an error with standard error closed" 1 '"$1" inspect "$2/no_such.png" 2>&-'
streams "an error with standard error full" 1 '"$1" inspect "$2/no_such.png" 2>/dev/full'
streams "a result with standard error closed" 0 '"$1" inspect brick --json 2>&-'
streams "a result with standard error full" 0 '"$1" bake plate:a=0.3,t=0.01 --material ceramic --modes 5 -o "$2/plate.modes" 2>/dev/full'
streams "a result that a full disk takes" 1 '"$1" inspect brick --json >/dev/full'
streams "a result to a closed output" 1 '"$1" inspect brick >&-'
streams "help to a full disk" 1 '"$1" --help >/dev/full'
"$intaglio" inspect brick --json >/dev/full 2>"$work/stderr"
grep -q 'standard output: cannot be written: No space left' "$work/stderr" ||
  { echo "a lost result is not named: $(cat "$work/stderr")"; failures=$((failures + 1)); }

# Keys of very many parts, which toml++ reads by recursion.
python3 -c "print('.'.join(['a'] * 300000) + ' = 1')" >"$work/deep.toml"
expect "a key of 300,000 parts in a scene" 'deep\.toml:1: a key of over 32 parts' render "$work/deep.toml"
expect "a key of 300,000 parts in a recipe" 'deep\.toml:1: a key of over 32 parts' render "$scene" --surface "$work/deep.toml"

[ $failures -eq 0 ] && echo "all bad input is refused in one line"
exit $((failures > 0))
