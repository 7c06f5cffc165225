#!/usr/bin/env python3
"""Holds the dependency rules of ARCHITECTURE.md: which library may include which, where third-party headers belong, that texels are
read in surface/ only, and that CMakeLists.txt links no library to more than it may include. Prints each violation as file:line and
exits 1."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent

# A library is a folder of src/ or apps/; its value lists what it may include. No sense includes another, and the sound run time needs
# nothing that bakes it.
ALLOWED = {
    "src/core": "",
    "src/surface": "core",
    "src/mesh": "core surface",
    "src/contact": "core surface mesh",
    "src/dynamics": "core surface mesh contact",
    "src/haptics": "core surface mesh",
    "src/haptics/vrpn": "core haptics",
    "src/sound": "core surface",
    "src/sound/audio": "core sound",
    "src/sound/bake": "core mesh sound",
    "src/render": "core surface mesh",
    "src/scene": "core surface mesh contact dynamics haptics sound render",
    "src/scene/voices": "core surface contact dynamics sound sound/bake scene",
    "src/session": "core surface mesh contact dynamics haptics sound sound/bake sound/audio render scene scene/voices",
    "src/report": "core surface mesh contact dynamics haptics sound sound/bake sound/audio render scene scene/voices session",
    "src/evaluate": "core surface mesh contact dynamics haptics sound sound/bake sound/audio render scene scene/voices session report",
    "src/study/statistics": "core",
    "src/study": "core surface mesh contact dynamics haptics sound sound/bake sound/audio render scene scene/voices session report study/statistics",
    "apps/window": "core surface mesh contact dynamics haptics haptics/vrpn sound sound/bake sound/audio render scene scene/voices session report study study/statistics",
    "apps/command": "core surface mesh contact dynamics haptics haptics/vrpn sound sound/bake sound/audio render scene scene/voices session report evaluate study study/statistics window",
    "apps/netgen": "",
}
# The library that defines what a public header, include/intaglio/<name>.h, declares. Public headers include only public ones of
# libraries that theirs may include, the standard library and the few in PUBLIC_LIBRARIES.
PUBLIC = {
    "version": "core", "vec": "core", "error": "core", "memory": "core", "event": "core", "representation": "core", "material": "core", "image": "core",
    "surface": "surface", "triangle_mesh": "mesh", "mesh": "mesh", "contact_point": "contact", "contact": "contact",
    "shape": "core", "solid": "contact", "bullet": "dynamics", "world": "dynamics", "haptics": "haptics", "vrpn": "haptics/vrpn",
    "sound": "sound", "audio": "sound/audio", "bake": "sound/bake", "render": "render", "scene": "scene",
    "session": "session", "report": "report",
}
PUBLIC_LIBRARIES = {"bullet": ("btBulletCollisionCommon.h",), "vec": ("Eigen/", "arm_neon.h"), "error": ("tl/",)}
FOLDERS = sorted(ALLOWED, key=len, reverse=True)

# Headers that expose texels or decode images; only surface/ may include them.
TEXELS_ONLY_IN_SURFACE = re.compile(r"^surface/image/")

# A third-party library may be included by these only.
LIBRARIES = {
    "btBullet": "src/dynamics src/evaluate", "LinearMath/": "src/dynamics", "BulletCollision/": "src/dynamics", "libqhull_r/": "src/contact",
    "spng.h": "src/core src/surface", "turbojpeg.h": "src/surface", "OpenEXR/": "src/surface", "epoxy/": "src/render apps/window", "SDL2/": "apps/window",
    "imgui/": "apps/window", "dmumps_c.h": "src/sound/bake", "metis.h": "src/sound/bake", "sndfile": "src/sound/audio",
    "rtaudio/": "src/sound/audio", "hwy/": "src/sound", "toml++": "src/core", "embree3/": "src/surface src/mesh",
    "nlohmann/": "src/surface src/mesh apps/command", "CLI/": "apps/command", "nglib.h": "apps/netgen",
    "sqlite3.h": "src/study", "boost/math": "src/study/statistics",
}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def folder_of(path: str) -> str | None:
    """The library that `path` belongs to: by its folder, itself or one above, or of a public header by PUBLIC."""
    if path.startswith("include/"):
        library = PUBLIC.get(pathlib.Path(path).stem)
        return library and ("apps/" if library == "window" else "src/") + library
    return next((folder for folder in FOLDERS if path.startswith(folder + "/")), None)


def main() -> int:
    violations = []
    for path in sorted(p for root in ("include", "src", "apps") for p in (ROOT / root).rglob("*") if p.suffix in {".h", ".cpp"}):
        name = path.relative_to(ROOT).as_posix()
        folder = folder_of(name)
        is_public = name.startswith("include/")
        if folder is None:
            violations.append(f"{name}: it belongs to no library (tools/check_dependencies.py lists them)")
            continue
        allowed = {("apps/" if target == "window" else "src/") + target for target in ALLOWED[folder].split()} | {folder}
        for number, line in enumerate(path.read_text().splitlines(), 1):
            match = INCLUDE.match(line)
            if not match:
                continue
            where, header = f"{name}:{number}", match.group(2)
            if match.group(1) == '"':
                found = next((root for root in ("include/", "src/", "apps/") if (ROOT / root / header).exists()), None)
                if found is None:
                    if not header.endswith("_generated.h") and not header.startswith("intaglio_"):
                        violations.append(f"{where}: no such header {header}")
                    continue
                target = folder_of(found + header)
                if is_public and found != "include/":
                    violations.append(f"{where}: a public header may not include {header}")
                if target not in allowed:
                    violations.append(f"{where}: {folder}/ may not include {header}")
                if TEXELS_ONLY_IN_SURFACE.match(header) and folder != "src/surface":
                    violations.append(f"{where}: only surface/ reads texels; it may not include {header}")
            elif is_public:
                if "/" in header or header.endswith(".h"):
                    if not header.startswith(PUBLIC_LIBRARIES.get(path.stem, ()) or "\0"):
                        violations.append(f"{where}: a public header may not include <{header}>")
            else:
                for library, folders in LIBRARIES.items():
                    if header.startswith(library) and folder not in folders.split():
                        violations.append(f"{where}: <{header}> belongs to {', '.join(folders.split())}/")
    for folder in ALLOWED:
        if not (ROOT / folder).is_dir():
            violations.append(f"tools/check_dependencies.py: there is no folder {folder}")
    print("\n".join(violations) if violations else "dependency rules hold")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
