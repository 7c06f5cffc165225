#!/usr/bin/env bash
# intaglio study: shipped designs are checked and registered, bad ones are named in one line.   study.sh INTAGLIO SOURCE_DIR
. "$(dirname "$0")/begin.sh"
fault() {
  echo "wrong: $*"
  failures=$((failures + 1))
}
for name in identification balanced representation conflict; do
  "$intaglio" study check "$source/studies/$name.toml" >"$work/$name.txt" 2>"$work/stderr" || fault "check $name: $(cat "$work/stderr")"
  grep -q "^Takes about" "$work/$name.txt" || fault "check $name says no duration"
  "$intaglio" study preregister "$source/studies/$name.toml" -o "$work/$name.md" 2>"$work/stderr" || fault "preregister $name: $(cat "$work/stderr")"
  grep -qE '^Design `[0-9a-f]{64}`' "$work/$name.md" || fault "the registration of $name has no hash"
done
# The file's own hash, as another program finds it.
sum=$(sha256sum "$source/studies/conflict.toml" | cut -d' ' -f1)
grep -q "conflict.toml | \`$sum\`" "$work/conflict.md" || fault "the hash of conflict.toml is not sha256sum's"
"$intaglio" study check "$source/studies/identification.toml" -n 22 | grep -q "22 is no multiple of 10" || fault "22 people are said to balance"

# refused STATUS TEXT ARGUMENTS...: the exit code, and a part of the one line.
refused() {
  local status=$1 text=$2
  shift 2
  "$intaglio" study "$@" >/dev/null 2>"$work/stderr"
  local code=$?
  [ $code -eq "$status" ] && grep -qF -- "$text" "$work/stderr" || fault "study $*: exit code $code, $(cat "$work/stderr")"
}
sed 's/ask = \["ease"\]/ask = ["eese"]/' "$source/studies/identification.toml" >"$work/bad.toml"
refused 1 'did you mean "ease"?' check "$work/bad.toml"
refused 1 "no such file" check "$work/none.toml"
refused 1 ".md" preregister "$source/studies/conflict.toml" -o "$work/registration.txt"
refused 2 "participants" check "$source/studies/conflict.toml" -n 0
refused 2 "did you mean \"check\"?" chek "$source/studies/conflict.toml"
refused 2 "" check
[ $failures -eq 0 ] && echo "designs are checked"
exit $((failures > 0))
