#!/usr/bin/env bash
# Every verb can be stopped in every phase of its work, by SIGINT and SIGTERM, and when the reader of its output goes away:
# the exit code says so, the old results stand, and no temporary and no process is left. Half a minute: there are thirty phases.   stop.sh INTAGLIO SOURCE_DIR
. "$(dirname "$0")/begin.sh"
export XDG_CONFIG_HOME="$work/config" XDG_CACHE_HOME="$work/cache" SDL_VIDEODRIVER=offscreen LP_NUM_THREADS=2
check() {
  local name=$1
  shift
  if "$@"; then echo "$name: ok"; else echo "$name: FAILED"; cat "$work/stderr"; failures=$((failures + 1)); fi
}
hidden() { find "$work" -name '.*.part*' -type f; }

# The bounds are for loaded machines; docs/trust.md has the figures.
"$source/tools/stop_latency" -n 0 --limit 5 "$intaglio" || failures=$((failures + 1))

# A Netgen of a bake of `bake --all` dies with its grandparent.
mkdir "$work/meshes"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n' | tee "$work/meshes/a.obj" >"$work/meshes/b.obj"
printf '#!/bin/sh\necho $$ >>"%s/pids"\nexec sleep 60\n' "$work" >"$work/netgen"
chmod +x "$work/netgen"
INTAGLIO_NETGEN="$work/netgen" "$intaglio" bake --all "$work/meshes" --mesher netgen --material steel -j 2 -o "$work/models" 2>"$work/stderr" &
for _ in $(seq 500); do [ "$(cat "$work/pids" 2>/dev/null | wc -l)" -eq 2 ] && break; sleep 0.02; done
kill -KILL $!
wait $! 2>/dev/null
living() { ps -o stat= -p "$(paste -sd, "$work/pids")" | grep -v Z; } # the init of a container may not reap the dead
for _ in $(seq 100); do living >/dev/null || break; sleep 0.02; done
check "grandchildren die by SIGKILL" [ "$(wc -l <"$work/pids")" -eq 2 -a -z "$(living)" ]

# timeout(1) signals the process and then its group, so that the signal comes twice.
timeout 1 "$intaglio" -q render "$source/scenes/brick.toml" -o "$work/out.mp4" --duration 600 2>"$work/stderr"
check "one signal that comes twice is one" [ $? -eq 124 -a -z "$(hidden)" ]

# A window that waits for the pen's host has 0.3 s to end by itself, and says that it was interrupted; a second signal leaves it none.
"$intaglio" run --fresh --audio null --device Phantom0@192.0.2.1 2>"$work/stderr" &
sleep 0.5
kill -INT $!
sleep 0.12
kill -INT $!
wait $!
check "a second signal ends at once" [ $? -eq 130 -a ! -s "$work/stderr" ]

# A window that is closed does not wait for a recording whose last step takes long; the next one completes it.
window() { "$intaglio" -q run "$source/scenes/brick.toml" --fresh --audio null --width 160 --height 90 --record-to "$work/recorded" "$@"; }
mkdir "$work/recorded" "$work/bin"
printf '#!/bin/sh\ncase "$*" in *faststart*) exec sleep 60;; esac\nexec %s "$@"\n' "$(command -v ffmpeg)" >"$work/bin/ffmpeg"
chmod +x "$work/bin/ffmpeg"
printf '0.1 key F9\n1.5 quit\n' >"$work/record.events"
PATH="$work/bin:$PATH" window --script "$work/record.events" 2>"$work/stderr"
check "an unfinished recording is left" [ $? -eq 0 -a -n "$(hidden)" -a -z "$(ls "$work/recorded")" ]
printf '3 quit\n' >"$work/wait.events"
window --script "$work/wait.events" 2>"$work/stderr"
check "and completed" [ $? -eq 0 -a -z "$(hidden)" -a -n "$(ls "$work/recorded")" ]

# Readers that go away.
"$intaglio" inspect brick --json --html "$work/page.html" 2>"$work/stderr" | true
check "without a reader a verb ends quietly" [ "${PIPESTATUS[0]}" -eq 141 -a ! -s "$work/stderr" -a -z "$(hidden)" ]
(trap '' PIPE; "$intaglio" inspect brick --json 2>"$work/stderr" | true; exit "${PIPESTATUS[0]}")
check "where SIGPIPE is ignored it is said" [ $? -eq 1 -a "$(wc -l <"$work/stderr")" -eq 1 ]

# A closed terminal ends a verb, unless nohup(1) has made it ignore that.
for wanted in 129 0; do
  (
    [ $wanted -ne 0 ] || trap '' HUP
    exec "$intaglio" -q import brick --size 1024 -o "$work/imported"
  ) 2>"$work/stderr" &
  sleep 0.2
  kill -HUP $!
  wait $!
  code=$?
  check "SIGHUP: exit code $wanted" [ $code -eq $wanted -a ! -s "$work/stderr" ]
done

[ $failures -eq 0 ] && echo "everything can be stopped"
exit $((failures > 0))
