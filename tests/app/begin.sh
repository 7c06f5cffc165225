# For the scripts here, to be sourced: their arguments ($intaglio, $source), a folder that goes at their end ($work), a count of $failures.
set -uo pipefail
intaglio=$1
source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0

# skipped WHY WHAT: says what a script cannot try here, and adds it to the file that INTAGLIO_SKIPS names, which script/test prints at its
# end (ctest hides what passing tests say).
skipped() {
  echo "skipped: $1: $2"
  [ -z "${INTAGLIO_SKIPS:-}" ] || printf '%s: %s\n' "$1" "$2" >>"$INTAGLIO_SKIPS"
}
