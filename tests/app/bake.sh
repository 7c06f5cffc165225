#!/usr/bin/env bash
# intaglio bake --all: bakes what is there, skips what is done, bakes again what changed, goes on after a failure, and the
# workflow does the same where snakemake is installed.   bake.sh INTAGLIO SOURCE_DIR
. "$(dirname "$0")/begin.sh"
expect() {
  local name=$1 pattern=$2
  if grep -qE "$pattern" "$work/log"; then echo "$name: ok"; else
    echo "$name: expected /$pattern/, got:"; cat "$work/log"; failures=$((failures + 1)); fi
}
cuboid() {
  printf 'v 0 0 0\nv %s 0 0\nv 0 %s 0\nv %s %s 0\nv 0 0 %s\nv %s 0 %s\nv 0 %s %s\nv %s %s %s\n' \
    "$1" "$2" "$1" "$2" "$3" "$1" "$3" "$2" "$3" "$1" "$2" "$3"
  printf 'f 1 3 2\nf 2 3 4\nf 5 6 7\nf 6 8 7\nf 1 2 5\nf 2 6 5\nf 3 7 4\nf 4 7 8\nf 1 5 3\nf 3 5 7\nf 2 4 6\nf 4 8 6\n'
}
all() { "$intaglio" bake --all "$work/meshes" --material "${1:-ceramic}" --modes 5 -o "$work/models" -j 2 >"$work/log" 2>&1; }

mkdir -p "$work/meshes/deep"
cuboid 0.3 0.05 0.05 >"$work/meshes/bar.obj"
cuboid 0.2 0.05 0.04 >"$work/meshes/deep/brick.obj"
all && expect "bakes all" '2 baked, 0 up to date, 0 failed'
[ -s "$work/models/deep/brick.modes" ] || { echo "no model of the brick"; failures=$((failures + 1)); }
all && expect "skips what is done" '0 baked, 2 up to date, 0 failed'
cuboid 0.3 0.06 0.05 >"$work/meshes/bar.obj"
rm "$work/models/deep/brick.modes" # as if it had been stopped there
all && expect "bakes what changed or is missing" '2 baked, 0 up to date, 0 failed'
head -c 1000 "$work/models/bar.modes" >"$work/cut" && mv "$work/cut" "$work/models/bar.modes"
all && expect "bakes what is broken" '1 baked, 1 up to date, 0 failed'
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >"$work/meshes/a_sheet.obj"
all && { echo "a failure has exit code 0"; failures=$((failures + 1)); }
expect "goes on after a failure" '0 baked, 2 up to date, 1 failed'
expect "says why" 'a_sheet.obj: encloses no volume'
rm "$work/meshes/a_sheet.obj"
all glass && expect "another material" '2 baked, 0 up to date, 0 failed'

if command -v snakemake >/dev/null; then
  mkdir "$work/home"
  export HOME="$work/home" XDG_CACHE_HOME="$work/home/.cache" # snakemake keeps sources there, its jobs, too
  flow() {
    (cd "$work" && snakemake -s "$source/workflow/Snakefile" --cores 2 --quiet --nolock --config meshes=meshes models=flow \
      material=ceramic options='--modes 5' intaglio="$intaglio" >"$work/log" 2>&1)
  }
  flow || { echo "the workflow failed:"; cat "$work/log"; failures=$((failures + 1)); }
  [ -s "$work/flow/deep/brick.modes" ] && [ -s "$work/flow/bar.json" ] || { echo "no models"; failures=$((failures + 1)); }
  touch -r "$work/meshes/bar.obj" "$work/stamp"
  flow && expect "the workflow skips what is done" 'Nothing to be done|^$'

  # The Slurm profile, with stand-ins for Slurm's commands: sbatch checks the words it is given and runs the script as a job.
  mkdir -p "$work/slurm"
  cat >"$work/slurm/sbatch" <<'EOF'
#!/usr/bin/env bash
echo "$@" >>"$SLURM_LOG"
for word in "$@"; do
  case $word in
    --parsable | --cpus-per-task=[1-9]* | --mem=[1-9]* | --time=[1-9]* | --job-name=* | --output=*) ;;
    -*) echo "sbatch: unrecognized option '$word'" >&2; exit 1 ;;
    *) script=$word ;;
  esac
done
[ "$(head -c 2 "$script")" = '#!' ] || { echo "sbatch: not a script" >&2; exit 1; }
id=$$
case ${KILLED:-none} in none) ;; *) grep -q "$KILLED" "$script" && { echo OUT_OF_MEMORY >"$SLURM_LOG.$id"; echo $id; exit; } ;; esac
(setsid env -i PATH="$PATH" HOME="$HOME" bash -c 'bash "$1" && echo COMPLETED >"$2" || echo FAILED >"$2"' job "$script" "$SLURM_LOG.$id" \
  >/dev/null 2>&1 </dev/null &)
echo $id
EOF
  printf '#!/bin/sh\necho "cancelled $*" >>"$SLURM_LOG"\n' >"$work/slurm/scancel"
  printf '#!/bin/sh\nfor id in "$@"; do [ -f "$SLURM_LOG.$id" ] && exec cat "$SLURM_LOG.$id"; done; echo RUNNING\n' >"$work/slurm/sacct"
  chmod +x "$work/slurm/sbatch" "$work/slurm/scancel" "$work/slurm/sacct"
  cuboid 0.25 0.05 0.04 >"$work/meshes/block.obj"
  slurm() {
    (cd "$work" && SLURM_LOG="$work/slurm.log" PATH="$work/slurm:$PATH" timeout 120 snakemake -s "$source/workflow/Snakefile" \
      --profile "$source/workflow/slurm" --latency-wait 5 --max-status-checks-per-second 10 --quiet --nolock --config meshes=meshes \
      models=slurm_models material=ceramic options='--modes 5' minutes=7 intaglio="$intaglio" >"$work/log" 2>&1)
  }
  slurm || { echo "the workflow with the Slurm profile failed:"; cat "$work/log"; failures=$((failures + 1)); }
  for name in bar block deep/brick; do
    [ -s "$work/slurm_models/$name.modes" ] || { echo "no model $name by Slurm"; failures=$((failures + 1)); }
  done
  cp "$work/slurm.log" "$work/log" && expect "one Slurm job an object, with its memory and time" 'cpus-per-task=1 --mem=4000 --time=7 '
  [ "$(wc -l <"$work/slurm.log")" = 3 ] || { echo "not three Slurm jobs:"; cat "$work/slurm.log"; failures=$((failures + 1)); }
  rm "$work/slurm_models/bar.modes" "$work/slurm_models/block.modes"
  KILLED=block.obj slurm
  [ $? = 1 ] || { echo "a job that Slurm killed is not told"; failures=$((failures + 1)); }
  [ -s "$work/slurm_models/bar.modes" ] || { echo "one killed job keeps the others from running"; failures=$((failures + 1)); }
else
  skipped "snakemake is not installed (script/setup test)" "app_bake: the workflow, here and by Slurm"
fi
exit $((failures > 0))
