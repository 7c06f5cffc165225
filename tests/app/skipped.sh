# skipped WHY WHAT: says what a script cannot try here, and adds it to the file that INTAGLIO_SKIPS names, which script/test prints at its
# end (ctest hides what passing tests say). To be sourced.
skipped() {
  echo "skipped: $1: $2"
  [ -z "${INTAGLIO_SKIPS:-}" ] || printf '%s: %s\n' "$1" "$2" >>"$INTAGLIO_SKIPS"
}
