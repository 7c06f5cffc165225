#!/usr/bin/env bash
# Files that ask for too much are refused in one line, or done, in bounded time and memory.   hostile.sh INTAGLIO SOURCE_DIR
# INTAGLIO_SLOW=1 tries all of them; otherwise those that take long even where all is well are left out.
. "$(dirname "$0")/begin.sh"
python3 "$(dirname "$0")/hostile.py" "$intaglio" "$work" ${INTAGLIO_SLOW:+--whole}
