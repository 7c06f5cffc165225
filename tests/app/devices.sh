#!/usr/bin/env bash
# intaglio devices as a user meets it: serve and monitor by both transports, a port that is taken, no server, no VRPN, no host,
# a server that dies, a clean end.   devices.sh INTAGLIO SOURCE_DIR
set -uo pipefail
intaglio=$1
work=$(mktemp -d)
servers=()
trap 'for server in "${servers[@]}"; do kill -9 "$server" 2>/dev/null; done; rm -rf "$work"' EXIT
failures=0

check() {
  local name=$1
  shift
  if "$@"; then echo "$name: ok"; else echo "$name: FAILED"; failures=$((failures + 1)); fi
}
# serve LOG: a server on a free port, which becomes $port.
serve() {
  rm -f "$1" # the server before said "serving" as well
  "$intaglio" devices serve --port 0 >"$1" 2>&1 &
  server=$!
  servers+=("$server")
  for _ in $(seq 200); do grep -qs '^serving' "$1" && break; sleep 0.05; done
  port=$(sed -n 's/^serving Phantom0 on 127.0.0.1:\([0-9]*\);.*/\1/p' "$1")
}
# exits CODE PATTERN COMMAND...: with that code and one line on standard error like the pattern.
exits() {
  local code=$1 pattern=$2
  shift 2
  "$@" >"$work/stdout" 2>"$work/stderr"
  local got=$?
  [ $got -eq "$code" ] && [ "$(wc -l <"$work/stderr")" -eq 1 ] && grep -qE "$pattern" "$work/stderr" && return
  echo "exit code $got, expected $code; standard error:"
  cat "$work/stderr"
  return 1
}
# Whether each line is one JSON object with the keys that the documentation says.
sound_json() {
  python3 - "$1" "$2" <<'PYTHON'
import json, sys
keys = {"link": {"device", "transport", "version"}, "pose": {"time", "sensor", "position", "orientation"},
        "button": {"time", "button", "pressed"}, "buttons": {"time", "pressed"}, "force": {"time", "newtons"},
        "end": {"reason", "poses", "buttons", "forces", "rate"}}
lines = [json.loads(line) for line in open(sys.argv[1])]
assert lines[0]["event"] == "link" and lines[0]["transport"] == sys.argv[2], lines[0]
assert lines[-1]["event"] == "end" and lines[-1]["reason"] == "finished", lines[-1]
for line in lines:
    assert set(line) == keys[line["event"]] | {"event", "t"}, line
poses = [line for line in lines if line["event"] == "pose"]
assert len(poses) > 50 and len(poses) == lines[-1]["poses"]
assert all(len(p["position"]) == 3 and len(p["orientation"]) == 4 for p in poses)
assert poses[0]["position"] != poses[-1]["position"], "the hand does not move"
assert any(line["event"] == "buttons" for line in lines) and any(line["event"] == "force" for line in lines)
PYTHON
}

serve "$work/server.log"
for transport in udp tcp; do
  flag=$([ $transport = tcp ] && echo --tcp)
  "$intaglio" devices monitor "Phantom0@localhost:$port" $flag --seconds 1 --json >"$work/$transport.jsonl" 2>"$work/stderr"
  check "monitor by $transport ends well" [ $? -eq 0 ]
  check "monitor by $transport, JSON lines" sound_json "$work/$transport.jsonl" $transport
done
check "tcp:// in the address" grep -q '"transport": "tcp"' \
  <("$intaglio" devices monitor "Phantom0@tcp://127.0.0.1:$port" --seconds 0.1 --json)
"$intaglio" devices monitor "Phantom0@localhost:$port" --seconds 0.5 >"$work/text"
check "monitor for people" grep -qE '[0-9.]+ s  sensor 0 .* mm' "$work/text"
check "list finds the server" grep -q "Phantom0@localhost:$port" <("$intaglio" devices list --port "$port" --json)
check "port taken" exits 8 "127\.0\.0\.1:$port: the port is taken; .*--port" "$intaglio" devices serve --port "$port"
kill -TERM "$server"
wait "$server"
check "SIGTERM ends the server cleanly" [ $? -eq 0 ]
check "its last line says so" grep -q '^stopped' "$work/server.log"

check "no server, UDP request" exits 4 'refused' "$intaglio" devices monitor "Phantom0@127.0.0.1:$port"
check "no server, TCP" exits 4 'refused' "$intaglio" devices monitor "Phantom0@127.0.0.1:$port" --tcp
check "no such host" exits 3 'no-such-host' "$intaglio" devices monitor Phantom0@no-such-host.invalid
check "not an address" exits 2 'NAME@HOST' "$intaglio" devices monitor Phantom0
check "ports below 1024 are refused" [ "$("$intaglio" devices serve --port 80 >/dev/null 2>&1; echo $?)" -eq 2 ]

# Somebody else, and somebody who says nothing.
python3 - "$work/other" <<'PYTHON' &
import socket, sys, time
other, silent = socket.socket(), socket.socket()
for s in (other, silent):
    s.bind(("127.0.0.1", 0))
    s.listen()
open(sys.argv[1], "w").write(f"{other.getsockname()[1]} {silent.getsockname()[1]}\n")
peer = other.accept()[0]
peer.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n")
time.sleep(30)
PYTHON
servers+=($!)
for _ in $(seq 200); do [ -s "$work/other" ] && break; sleep 0.05; done
read -r other silent <"$work/other"
check "not a VRPN server" exits 6 'not a VRPN' "$intaglio" devices monitor "Phantom0@127.0.0.1:$other" --tcp
check "no answer" exits 5 'no answer' "$intaglio" devices monitor "Phantom0@127.0.0.1:$silent" --tcp

# A server that is killed under a monitor.
serve "$work/server.log"
"$intaglio" devices monitor "Phantom0@127.0.0.1:$port" --json >"$work/lost.jsonl" 2>"$work/stderr" &
monitor=$!
servers+=("$monitor")
for _ in $(seq 200); do grep -q pose "$work/lost.jsonl" && break; sleep 0.05; done
kill -9 "$server"
wait "$monitor"
check "a server that is killed ends the monitor" [ $? -eq 7 ]
check "and it says why" grep -q '"reason": "the peer closed the link"' "$work/lost.jsonl"

[ $failures -eq 0 ] && echo "devices are listed, watched and served"
exit $((failures > 0))
