#!/usr/bin/env bash
# intaglio evaluate: its numbers rise with a fault, bad input is named, a batch goes on where it was.   evaluate.sh INTAGLIO SOURCE_DIR
# Takes 45 s: two evaluations are measured, with one stroke and one roll each: too few to tell reliefs apart.
. "$(dirname "$0")/begin.sh"
fault() {
  echo "wrong: $*"
  failures=$((failures + 1))
}
run() { timeout 300 "$intaglio" -q evaluate "$@" 2>"$work/stderr"; }

# A scene file stands for its surface.
printf '[surface]\ntexture = "brick"\nsize = [1, 1]\n' >"$work/true.toml"
run "$work/true.toml" --quick --runs 1 --json "$work/true.json" --html "$work/true.html" || fault "failed: $(cat "$work/stderr")"
run brick --quick --runs 1 --json "$work/late.json" --fault sound-delay=60ms || fault "failed with a fault: $(cat "$work/stderr")"
python3 - "$work" <<'PYTHON' || failures=$((failures + 1))
import json, sys
true, late = (json.load(open(f"{sys.argv[1]}/{name}.json"))["representations"] for name in ("true", "late"))
wrong = 0
# Not the paper's normal map: its sound is out of step without a fault, too.
for key in ("normal", "relief_paper", "relief", "mesh_256", "mesh_512"):
    a, b = true[key]["agreement"], late[key]["agreement"]
    if not (b["jnd"]["mean"] > a["jnd"]["mean"] and b["score"] >= a["score"]):
        print(f"wrong: sound that is 60 ms late does not raise the conflict of {key}: {a['jnd']}, {a['score']} to {b['jnd']}, {b['score']}")
        wrong = 1
ours, papers, flat = (true[key]["agreement"]["jnd"]["mean"] for key in ("normal", "normal_paper", "flat"))
if not ours < papers < flat:
    print(f"wrong: conflict of our normal map {ours}, the paper's {papers}, flat {flat}")
    wrong = 1
if not (relief := true["relief"]["agreement"]["jnd"]["mean"]) < papers:
    print(f"wrong: conflict of our relief {relief}, the paper's normal map {papers}")
    wrong = 1
sys.exit(wrong)
PYTHON
grep -q "<svg" "$work/true.html" || fault "the page has no plot"

# refused STATUS TEXT ARGUMENTS...: the exit code, and a part of the one line.
refused() {
  local status=$1 text=$2
  shift 2
  run "$@" >/dev/null
  local code=$?
  [ $code -eq "$status" ] && grep -qF -- "$text" "$work/stderr" || fault "evaluate $*: exit code $code, $(cat "$work/stderr")"
}
refused 1 "no texture" --quick
refused 1 "did you mean" brik --quick
refused 1 "give -o FOLDER" brick pebbles
refused 1 ".json" brick --json "$work/result.txt"
refused 1 "sond" brick --fault sond-delay=60ms
refused 2 "--runs" brick --runs 0
printf '[surface]\ntexture = "brick"\nsize = [1, 2]\n' >"$work/long.toml"
refused 1 "is not a square" "$work/long.toml"
printf '[surface]\ntexture = "brick"\nsice = [1, 2]\n' >"$work/wrong.toml"
refused 1 "wrong.toml:3" "$work/wrong.toml"
refused 1 "no/such" --all "$work/no/such" -o "$work/out"

# Results that exist are kept; a stranger's file is named.
mkdir "$work/out"
cp "$work/true.json" "$work/out/brick.json"
run brick -o "$work/out" || fault "a batch that is done failed: $(cat "$work/stderr")"
[ "$(wc -l <"$work/out/summary.csv")" -eq 2 ] && grep -q '^"brick",' "$work/out/summary.csv" ||
  fault "summary: $(cat "$work/out/summary.csv")"
cmp -s "$work/true.json" "$work/out/brick.json" || fault "a batch measured again"
echo '{"mine": 1}' >"$work/out/pebbles.json"
refused 1 "is no result of evaluate" brick pebbles -o "$work/out"
grep -q '^"brick",' "$work/out/summary.csv" || fault "one bad result lost the others"
[ $failures -eq 0 ] && echo "evaluations are whole"
exit $((failures > 0))
