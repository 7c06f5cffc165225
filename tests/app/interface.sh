#!/usr/bin/env bash
# The interface that users' scripts rely on, listed in interface.txt, is still there. Fails with the names of missing items; additions are fine.
#   interface.sh INTAGLIO SOURCE_DIR            compares
#   interface.sh INTAGLIO SOURCE_DIR --print    prints today's list, to add to interface.txt what is new
set -uo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export XDG_CONFIG_HOME="$work/config" XDG_CACHE_HOME="$work/cache" SDL_VIDEODRIVER=offscreen LP_NUM_THREADS=2
python3 - "$1" "$2" "$work" "${3:-}" <<'PYTHON'
import json, os, pathlib, re, subprocess, sys, time

PROGRAM, SOURCE, WORK = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
KEPT = SOURCE / "tests/app/interface.txt"
found = set()

def intaglio(*arguments, ok=True):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=60, cwd=SOURCE)
    if ok and done.returncode != 0:
        sys.exit(f"intaglio {' '.join(map(str, arguments))} failed: {done.stderr}")
    return done.stdout if ok else done.stderr

# Commands, their arguments, options and the options' choices, as --help lists them.
def add_command(path):
    section, subcommands = "", []
    for line in intaglio(*path, "--help").splitlines():
        if re.fullmatch(r"[A-Z]\w+:", line):
            section = line[:-1]
        elif match := re.match(r"  (\S+)(?: (.*))?$", line):
            name, rest = match.group(1), match.group(2) or ""
            if section == "Subcommands":
                subcommands.append(name)
            elif section == "Positionals":
                found.add(" ".join(["argument", *path, name]))
            elif section == "Options":
                for one in name.split(","):
                    found.add(" ".join(["option", *path, one]))
                choices = re.search(r"TEXT:\{(.*?)\}", rest)
                for choice in choices.group(1).split(",") if choices else []:
                    found.add(" ".join(["option", *path, name.split(",")[-1], choice]))
        elif line and not line.startswith(" "):
            section = ""
    for name in subcommands:
        found.add(" ".join(["command", *path, name]))
        add_command([*path, name])

# JSON keys: a.b of an object in an object, a[].b of one in a list.
def add_json(name, value, at=""):
    if isinstance(value, dict):
        for key, inner in value.items():
            found.add(f"json {name}: {at}{key}")
            add_json(name, inner, f"{at}{key}.")
    elif isinstance(value, list):
        for inner in value:
            add_json(name, inner, f"{at[:-1]}[].")

def add_columns(name, file):
    with open(file) as lines:
        header = next(line for line in lines if not line.startswith("#"))
    for column in header.strip().split(","):
        found.add(f"column {name}: {column}")

def refusal(file, text, *arguments):
    (WORK / file).write_text(text)
    return intaglio(*arguments, WORK / file, *(["-o", WORK / "none.mp4"] if arguments[0] == "render" else []), ok=False)

# A scene's key, setting or event is unknown when the refusal of a wrong value begins as that of a made-up name does. (A second
# made-up name ends each file, so that none is ever accepted.)
def unknown(message, example):
    after = lambda text: re.sub(r"^intaglio: \S+?:\d+: ", "", text)
    start = after(example).split('"')[0]
    assert len(start) > 5, example
    return after(message).startswith(start)

def scene_refusal(key, value):
    section, _, rest = key.rpartition(" ")
    heading = f"{section}\n" if section else ""
    if rest.startswith("skin."):
        heading += 'shape = "sphere"\n'
    return refusal("asked.toml", f"{heading}{rest} = {value}\nmade_up = 1\n", "render")

def documented_scene_keys():
    section = ""
    for line in (SOURCE / "docs/scene.md").read_text().splitlines():
        if match := re.match(r"## `(\[+\w+\]+)`", line):
            section = match.group(1) + " "
        elif line.startswith("## Materials"):
            section = "[surface] material."
        elif match := re.match(r"\|\s*`(\w+)`\s*\|", line):
            name = match.group(1)
            if section.startswith("[cues]"):
                name = "touch." + name
            if section.startswith("[[ground]]") and name != "base":
                name = "base." + name
            elif section.startswith("[surface] material.") and name in ("rms_height", "correlation_length", "spectral_slope"):
                name = "micro." + name
            yield section + name
    for side in ("top", "bottom", "skin"):
        for name in ("texture", "green", "polarity", "edge", "depth", "maps"):
            yield f"[[body]] {side}.{name}"
    yield "[[body]] skin.repeat"
    for cue in ("picture", "touch", "pen_sound", "ball_motion", "ball_sound"):
        yield f"[cues] {cue}"

def add_scene_keys(keys):
    example = scene_refusal("[surface] invented", "1979-05-27")
    for key in keys:
        if not unknown(scene_refusal(key, "1979-05-27"), example):
            found.add(f"scene {key}")
            message = scene_refusal(key, '"no such"')
            if "one of" in message:
                for choice in re.findall(r'"([^"]+)"', message.split("one of", 1)[1]):
                    found.add(f"scene {key} = {choice}")

def add_script(names, kind, line):
    refused = lambda name: refusal("asked.events", f"1 {line.format(name)}\n2 made_up\n", "run", "--script")
    example = refused("made_up")
    for name in names:
        message = refused(name)
        if ".events:2:" in message or not unknown(message, example):
            found.add(f"{kind} {name}")

def add_devices():
    add_json("devices list --json", json.loads(intaglio("devices", "list", "--json")))
    server = subprocess.Popen([PROGRAM, "devices", "serve", "--port", "0"], stdout=subprocess.PIPE, text=True)
    try:
        port = re.search(r"127\.0\.0\.1:(\d+)", server.stdout.readline()).group(1)
        for line in intaglio("devices", "monitor", f"Phantom0@localhost:{port}", "--seconds", "0.5", "--json").splitlines():
            event = json.loads(line)
            add_json(f"devices monitor --json {event['event']}", event)
    finally:
        server.kill()
        server.wait()

add_command([])
if sys.argv[4] == "--print":
    scene_keys = list(documented_scene_keys())
    settings = re.findall(r'(?:<&Settings::\w+>\(|[{ ])"(\w+)"[,}]', "".join(f.read_text() for f in (SOURCE / "apps/window").glob("settings.cpp")))
    settings += ["width", "height", "interface_scale"]
    events = "key hold release move point down up wheel drop resize set device screenshot quit".split()
else:
    kept = KEPT.read_text().splitlines()
    scene_keys = [line[6:] for line in kept if line.startswith("scene ") and " = " not in line]
    settings = [line[8:] for line in kept if line.startswith("setting ")]
    events = [line[6:] for line in kept if line.startswith("event ")]
add_scene_keys(scene_keys)
add_script(settings, "setting", "set {} 1e9")
add_script(events, "event", "{} a b c d")

video = WORK / "out/brick.mp4"
intaglio("-q", "render", "scenes/brick.toml", "-o", video, "--duration", "0.2")
for suffix in (".mp4", ".html", ".wav", ".events.csv", ".servo.csv"):
    if (file := video.with_suffix("").with_name("brick" + suffix)).exists():
        found.add(f"file render {suffix}")
        if suffix.endswith(".csv"):
            add_columns(f"render {suffix}", file)

add_json("inspect --json", json.loads(intaglio("inspect", "brick", "--json")))
box = ["--material", "wood", "--modes", "5", "--elements", "500", "--json"]
add_json("bake --json", json.loads(intaglio("bake", "box:x=0.2,y=0.02,z=0.1", *box, "-o", WORK / "box.modes")))
(WORK / "meshes").mkdir()
(WORK / "meshes/tetrahedron.obj").write_text("v 0 0 0\nv .1 0 0\nv 0 .1 0\nv 0 0 .1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
add_json("bake --all --json", json.loads(intaglio("bake", "--all", WORK / "meshes", *box, "-o", WORK / "models")))
add_devices()
(WORK / "quit.events").write_text("0.3 quit\n")
add_json("run --json", json.loads(intaglio("run", "--audio", "null", "--script", WORK / "quit.events", "--width", 320, "--height", 180, "--json")))
for line in (WORK / "config/intaglio/window.toml").read_text().splitlines():
    if " = " in line:
        found.add(f"window.toml {line.split(' = ')[0]}")

for script in ("setup", "build", "test", "demo"):
    if os.access(SOURCE / "script" / script, os.X_OK):
        found.add(f"script {script}")
for columns in re.findall(r'"(\w+(?:,\w+)+)\\n"', (SOURCE / "bench/contact.cpp").read_text()):
    for column in columns.split(","):
        found.add(f"column bench_contact: {column}")

if sys.argv[4] == "--print":
    print("\n".join(sorted(found)))
    sys.exit(0)
missing = [line for line in kept if line and not line.startswith("#") and line not in found]
for line in missing:
    print(f"missing: {line}")
print(f"{len(kept) - len(missing)} of {len(kept)} kept")
sys.exit(1 if missing or len(kept) < 300 else 0)
PYTHON
