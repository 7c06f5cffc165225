#!/usr/bin/env python3
"""Holds the dependency rule of ARCHITECTURE.md: which folder of intaglio/ may include which.

core <- surface <- {contact <- dynamics, haptics, sound, render} <- session <- {study, window, app}; senses never include each other,
and texels and image files are read in surface/ only. Prints each violation as file:line and exits 1."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIBRARY = ROOT / "intaglio"

ALLOWED = {
    "core": set(),
    "surface": {"core"},
    "contact": {"core", "surface"},
    "dynamics": {"core", "surface", "contact"},
    "haptics": {"core", "surface"},
    "sound": {"core", "surface"},
    "render": {"core", "surface"},
    "session": {"core", "surface", "contact", "dynamics", "haptics", "sound", "render"},
    "window": {"core", "surface", "contact", "dynamics", "haptics", "sound", "render", "session"},
    "study": {"core", "surface", "contact", "dynamics", "haptics", "sound", "render", "session"},
}
# Headers that hand out texels or decode images; only surface/ may include them.
TEXELS_ONLY_IN_SURFACE = {"intaglio/surface/image_file.h", "intaglio/surface/brick.h", "intaglio/surface/field.h",
                          "intaglio/surface/image_formats.h", "intaglio/surface/image_exr_header.h"}
INCLUDE = re.compile(r'^\s*#\s*include\s*"(intaglio/([a-z]+)/[^"]+)"')
# A third-party library may be included by these folders only.
LIBRARIES = {
    "btBullet": {"dynamics"}, "spng.h": {"core", "surface"}, "turbojpeg.h": {"surface"}, "OpenEXR/": {"surface"}, "epoxy/": {"render", "window"}, "SDL2/": {"window"}, "imgui/": {"window"},
    "dmumps_c.h": {"sound"}, "metis.h": {"sound"}, "sndfile": {"sound"}, "toml++": {"core"}, "embree3/": {"surface"}, "nlohmann/": {"surface"},
}
THIRD_PARTY = re.compile(r'^\s*#\s*include\s*<([^>]+)>')


def main() -> int:
    violations = []
    for path in sorted(LIBRARY.rglob("*")):
        if path.suffix not in {".h", ".cpp"}:
            continue
        folder = path.relative_to(LIBRARY).parts[0]
        for number, line in enumerate(path.read_text().splitlines(), 1):
            where = f"{path.relative_to(ROOT)}:{number}"
            if match := INCLUDE.match(line):
                header, target = match.groups()
                if target != folder and target not in ALLOWED.get(folder, set()):
                    violations.append(f"{where}: {folder}/ may not include {header}")
                if header in TEXELS_ONLY_IN_SURFACE and folder != "surface":
                    violations.append(f"{where}: only surface/ reads texels; it may not include {header}")
                if not (ROOT / header).exists():
                    violations.append(f"{where}: no such header {header}")
            elif match := THIRD_PARTY.match(line):
                for name, folders in LIBRARIES.items():
                    if match.group(1).startswith(name) and folder not in folders:
                        violations.append(f"{where}: <{match.group(1)}> belongs to {', '.join(sorted(folders))}/")
    print("\n".join(violations) if violations else "dependency rule holds")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
