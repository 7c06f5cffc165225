"""Files that ask for too much: each is refused with its line, or done, within bounds of time and memory.

hostile.py INTAGLIO FOLDER [--whole] [--table] [NAME...]
  FOLDER  takes the files
  --whole  all cases, not only the quick ones     --table  prints each one's time, peak memory and last line
"""
import base64
import json
import os
import pathlib
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import zlib

SECONDS, BYTES = 20, 1.0e9  # for each: CPU time, which is about 10 s on two cores, and resident memory
cases = []


def case(name, expect, quick=True):
    """`expect`: None for work that is done, else the pattern of the one line that refuses it."""

    def add(make):
        cases.append((name, expect, make, quick))
        return make

    return add


# --- What they are made of ---


def sparse(path, size):
    with open(path, "wb") as file:
        file.truncate(size)
    return path


def scene(folder, text):
    path = folder / "big.toml"
    path.write_text(text)
    return path


def render(scene_file, *options):
    return ["-q", "render", scene_file, "-o", scene_file.parent / "out" / "x.mp4", *options]


def balls(count, radius=lambda k: 0.02):
    side = max(1, round(count**0.5))
    return "".join(
        f"[[ball]]\nradius = {radius(k)}\nposition = [{(k % side) * 0.06 - 0.03 * side}, 0.05, {(k // side) * 0.06 - 0.03 * side}]\n"
        for k in range(count)
    )


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(path, side, bits=8, colour=6, interlaced=0, rows=True):
    """A PNG of one colour, its normals straight up; without `rows` it ends after its header."""
    samples = {0: 1, 2: 3, 6: 4}[colour]
    pixel = (b"\x80\x80\xff\x80" * (bits // 8))[: samples * bits // 8]
    data = b""
    if rows:
        passes = [(8, 8), (8, 8), (4, 8), (4, 4), (2, 4), (2, 2), (1, 2)] if interlaced else [(1, 1)]
        packer = zlib.compressobj(1)
        for across, down in passes:
            row = b"\0" + pixel * (side // across)
            for _ in range(side // down):
                data += packer.compress(row)
        data += packer.flush()
    header = chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, bits, colour, 0, 0, interlaced))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + header + (chunk(b"IDAT", data) + chunk(b"IEND", b"") if rows else b""))
    return path


def gltf(path, nodes, scene_nodes, meshes=None, accessors=None, views=None, data=b"", tail=""):
    document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": scene_nodes}], "nodes": nodes}
    if meshes:
        uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
        document |= {"meshes": meshes, "accessors": accessors, "bufferViews": views}
        document |= {"buffers": [{"byteLength": len(data), "uri": uri}]}
    path.write_text(json.dumps(document) + tail)
    return path


def points(count):
    """A mesh of `count` vertices on a spiral, three a triangle."""
    data = b"".join(struct.pack("<fff", 0.01 * k, k % 3, k % 7) for k in range(count))
    accessor = {"bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3"}
    return (
        [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        [accessor],
        [{"buffer": 0, "byteLength": len(data)}],
        data,
    )


def bake(mesh):
    return ["-q", "bake", mesh, "--material", "steel", "-o", mesh.parent / "out.modes"]


def surface(folder, image, *options):
    return render(scene(folder, "duration = 0.1\n"), "--surface", image, *options)


def exr(path, width, height, channels):
    def attribute(name, kind, data):
        return name + b"\0" + kind + b"\0" + struct.pack("<I", len(data)) + data

    listed = b"".join(c + b"\0" + struct.pack("<IIII", 1, 0, 1, 1) for c in channels) + b"\0"
    window = struct.pack("<iiii", 0, 0, width - 1, height - 1)
    path.write_bytes(
        b"\x76\x2f\x31\x01\x02\0\0\0"
        + attribute(b"channels", b"chlist", listed)
        + attribute(b"compression", b"compression", b"\0")
        + attribute(b"dataWindow", b"box2i", window)
        + attribute(b"displayWindow", b"box2i", window)
        + attribute(b"lineOrder", b"lineOrder", b"\0")
        + attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
        + attribute(b"screenWindowCenter", b"v2f", struct.pack("<ff", 0, 0))
        + attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1))
        + b"\0"
    )
    sparse_tail = 8 * height + 64
    with open(path, "ab") as file:
        file.write(b"\0" * sparse_tail)
    return path


# Small pictures: frames are not the subject.
VIDEO = "[video]\nwidth = 320\nheight = 180\nfps = 10\n"
REFUSED = r"big\.toml: would need about [0-9.]+ GB \(.*\), more than the 2 GB allowed; pass --allow-memory [0-9]+G"

# --- Scenes ---


@case("100 balls, 1 s", None, quick=False)
def _(folder):
    return render(scene(folder, "duration = 1\n" + VIDEO + balls(100)))


@case("1,000 balls, 0.2 s", None, quick=False)
def _(folder):
    return render(scene(folder, "duration = 0.2\n" + VIDEO + balls(1000)))


@case("10,000 balls, 0.1 s", None, quick=False)
def _(folder):
    return render(scene(folder, "duration = 0.1\n" + VIDEO + balls(10_000)))


@case("100,000 balls", r"big\.toml: .*100000 bodies.*16384")
def _(folder):
    return render(scene(folder, balls(100_000)))


@case("100 grounds", None)
def _(folder):
    grounds = "".join(
        f'[[ground]]\ntexture = "brick"\nsize = [0.2, 0.2]\nposition = [{k % 10 * 0.2}, -0.1, {k // 10 * 0.2}]\n'
        for k in range(100)
    )
    return render(scene(folder, "duration = 0.2\n" + VIDEO + grounds))


@case("300 radii", r"big\.toml: has bodies of 301 different sizes.*256")
def _(folder):
    return render(scene(folder, "duration = 0.2\n" + balls(300, lambda k: round(0.01 + 1e-4 * k, 6))))


@case("20,000 boxes of different sizes", r"big\.toml: .*20000 bodies")
def _(folder):
    boxes = "".join(
        f'[[body]]\nshape = "box"\nsize = [{0.01 + 1e-6 * k}, 0.02, 0.02]\nposition = [0, {0.1 + 0.03 * k}, 0]\n'
        for k in range(20_000)
    )
    return render(scene(folder, boxes))


@case("1,000 letters", None, quick=False)
def _(folder):
    letters = "".join(
        f'[[body]]\nshape = "letter"\nletter = "{chr(65 + k % 26)}"\nsize = [0.05, 0.01, 0.07]\n'
        f"position = [{k % 32 * 0.08 - 1.2}, 0.1, {k // 32 * 0.08 - 1.2}]\n"
        for k in range(1000)
    )
    return render(scene(folder, "duration = 0.1\n" + VIDEO + letters))


@case("a picture of 8K, 16 samples a pixel", REFUSED)
def _(folder):
    return render(scene(folder, "duration = 1\n[video]\nwidth = 7680\nheight = 4320\nsupersample = 4\n"))


@case("a path of 100,000 points", None)
def _(folder):
    path = ",".join(f"[{0.1 * k:.1f},0,1,0]" for k in range(100_000))
    return render(scene(folder, f"duration = 0.1\n{VIDEO}[pen]\npath = [{path}]\n"))


@case("500 bowls, repeated 64 times", REFUSED)
def _(folder):
    bowl = '[[ground]]\ntexture = "brick"\nbase = { shape = "bowl", radius = 5, repeat = [64, 64] }\n'
    return render(scene(folder, bowl * 500))


@case("2,000 boxes with relief", REFUSED)
def _(folder):
    box = '[[body]]\nshape = "box"\nsize = [0.1, 0.1, 0.1]\ntop = { texture = "brick", depth = %g }\n'
    return render(scene(folder, "".join(box % (0.001 + 1e-6 * k) for k in range(2000))))


@case("a scene of 10 GB", r"big\.toml: has 10000000000 bytes; at most 16777216 are read")
def _(folder):
    return render(sparse(folder / "big.toml", 10_000_000_000))


@case("a duration beyond reason", r"--duration")
def _(folder):
    return render(scene(folder, ""), "--duration", "1e9")


# --- Meshes ---


@case("glTF of a million nodes", r"big\.gltf: has only triangles without area", quick=False)
def _(folder):
    mesh = points(3)
    nodes = [{"mesh": 0}] + [{}] * 1_000_000
    return bake(gltf(folder / "big.gltf", nodes, list(range(len(nodes))), *mesh))


@case("glTF of 300,000 nodes", r"big\.gltf: has no triangles")
def _(folder):
    return bake(gltf(folder / "big.gltf", [{}] * 300_000, list(range(300_000))))


@case("glTF, a cycle", r"big\.gltf: nodes\[0\]: is part of a cycle")
def _(folder):
    return bake(gltf(folder / "big.gltf", [{"children": [1]}, {"children": [0]}], [0]))


@case("glTF, a chain of 100,000 nodes", r"big\.gltf: nodes\[65\]: .*nested too deeply")
def _(folder):
    return bake(gltf(folder / "big.gltf", [{"children": [k + 1]} for k in range(100_000)] + [{}], [0]))


@case("glTF, a million nested levels", r"big\.gltf: is not a glTF file")
def _(folder):
    path = folder / "big.gltf"
    path.write_text("[" * 1_000_000 + "]" * 1_000_000)
    return bake(path)


@case("glTF of 250 MB of braces", r"big\.gltf: would need about .* GB \(JSON")
def _(folder):
    path = folder / "big.gltf"
    path.write_bytes(b'{"asset":[' + b"{}," * 83_000_000 + b"{}]}")
    return bake(path)


@case("glTF, one mesh in 1,000 nodes", r"big\.gltf: would need about .* GB \(mesh")
def _(folder):
    return bake(gltf(folder / "big.gltf", [{"mesh": 0}] * 1000, list(range(1000)), *points(60_000)))


@case("glTF, an accessor of 200 million", r"big\.gltf: accessors\[0\]: needs 200000000 elements")
def _(folder):
    meshes, accessors, views, data = points(3)
    accessors[0]["count"] = 200_000_000
    return bake(gltf(folder / "big.gltf", [{"mesh": 0}], [0], meshes, accessors, views, data))


@case("OBJ of 900 MB", r"big\.obj: has 900000000 bytes; at most 268435456 are read")
def _(folder):
    return bake(sparse(folder / "big.obj", 900_000_000))


@case("OBJ of a million faces on one vertex", r"big\.obj: has only triangles without area")
def _(folder):
    path = folder / "big.obj"
    path.write_text("v 0 0 0\n" + "f 1 1 1\n" * 1_000_000)
    return bake(path)


@case("OBJ of 30 million points", r"big\.obj: has no triangles", quick=False)
def _(folder):
    path = folder / "big.obj"
    path.write_bytes(b"v 1 1 1\n" * 30_000_000)
    return bake(path)


@case("OBJ of one face with a million corners", r"big\.obj: ")
def _(folder):
    path = folder / "big.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf" + " 1 2 3" * 333_000 + "\n")
    return bake(path)


@case("glTF with a buffer of 10 GB beside it", r"side\.bin: has 10000000000 bytes; at most")
def _(folder):
    sparse(folder / "side.bin", 10_000_000_000)
    meshes, accessors, views, _ = points(3)
    path = gltf(folder / "big.gltf", [{"mesh": 0}], [0], meshes, accessors, views)
    document = json.loads(path.read_text())
    document["buffers"] = [{"byteLength": 36, "uri": "side.bin"}]
    path.write_text(json.dumps(document))
    return bake(path)


@case("STL that counts to 2^32", r"big\.stl: is not an STL file")
def _(folder):
    path = folder / "big.stl"
    path.write_bytes(b"\0" * 80 + struct.pack("<I", 2**32 - 1) + b"\0" * 500)
    return bake(path)


@case("STL of 4 million empty triangles", r"big\.stl: would need about [0-9.]+ GB \(mesh", quick=False)
def _(folder):
    path = sparse(folder / "big.stl", 84 + 50 * 4_000_000)
    with open(path, "r+b") as file:
        file.seek(80)
        file.write(struct.pack("<I", 4_000_000))
    return bake(path)


# --- Textures ---

TEXTURE = r"big\.\w+: would need about [0-9.]+ GB \(texture.*pass --allow-memory [0-9]+G"


@case("PNG of 8,192 x 8,192, inspected", TEXTURE)
def _(folder):
    return ["-q", "inspect", png(folder / "big.png", 8192)]


@case("PNG of 8,192 x 8,192, rendered", r"would need about [0-9.]+ GB \(texture")
def _(folder):
    return surface(folder, png(folder / "big.png", 8192))


@case("PNG that claims 16,384 x 16,384", r"big\.png: byte 16: the image is 16384 x 16384 pixels; at most")
def _(folder):
    return ["-q", "inspect", png(folder / "big.png", 16384, rows=False)]


@case("PNG that claims 40,000 x 40,000", r"big\.png: byte 16: the image is 40000 x 40000 pixels; at most")
def _(folder):
    return ["-q", "inspect", png(folder / "big.png", 40_000, rows=False)]


@case("PNG with a text of 500 MB", r"big\.png: .*limits")
def _(folder):
    path = png(folder / "big.png", 16)
    packer = zlib.compressobj(9)
    text = b"".join(packer.compress(b"\0" * 1_000_000) for _ in range(500)) + packer.flush()
    data = path.read_bytes()
    path.write_bytes(data[:33] + chunk(b"zTXt", b"a\0\0" + text) + data[33:])
    return ["-q", "inspect", path]


@case("PNG of 4,096 x 4,096, 16 bits, interlaced", None, quick=False)
def _(folder):
    return ["-q", "inspect", png(folder / "big.png", 4096, bits=16, interlaced=1)]


@case("a folder of 5,000 images", None)
def _(folder):
    image = png(folder / "a_normal.png", 16)
    for k in range(5000):
        os.link(image, folder / f"a_{k}_diff.png")
    return ["-q", "inspect", folder]


@case("a recipe of 10 GB", r"big\.toml: has 10000000000 bytes")
def _(folder):
    return ["-q", "inspect", sparse(folder / "big.toml", 10_000_000_000)]


@case("PNG of 10 GB", r"big\.png: has 10000000000 bytes")
def _(folder):
    return ["-q", "inspect", sparse(folder / "big.png", 10_000_000_000)]


@case("JPEG that claims 65,500 x 65,500", r"big\.jpg: the image is 65500 x 65500 pixels; at most")
def _(folder):
    path = folder / "big.jpg"
    path.write_bytes(
        b"\xff\xd8\xff\xc2" + struct.pack(">HBHHB", 17, 8, 65500, 65500, 3) + b"\x01\x22\0\x02\x11\1\x03\x11\1"
        + b"\xff\xda\0\x0c\3\1\0\2\x11\3\x11\0\0\0"
    )
    return ["-q", "inspect", path]


@case("TGA of 8,000 x 8,000 in runs", TEXTURE)
def _(folder):
    path = folder / "big.tga"
    header = struct.pack("<BBBHHBHHHHBB", 0, 0, 10, 0, 0, 0, 0, 0, 8000, 8000, 32, 8)
    path.write_bytes(header + b"\xff\xff\x80\x80\x80" * (8000 * 8000 // 128))
    return ["-q", "inspect", path]


@case("EXR of 1,000 channels", r"big\.exr: would need about")
def _(folder):
    names = sorted(f"c{k:04}".encode() for k in range(1000))
    return ["-q", "inspect", exr(folder / "big.exr", 8000, 8000, names)]


@case("EXR that claims 8,000 x 8,000", r"big\.exr: would need about")
def _(folder):
    return ["-q", "inspect", exr(folder / "big.exr", 8000, 8000, [b"A", b"B", b"G", b"R"])]


# --- Running them ---


# In a process of its own: the peak of a child includes that of the program that starts it, before it does.
RUNNER = """import os, sys
child = os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ)
_, status, usage = os.wait4(child, 0)
print(os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime, 1024 * usage.ru_maxrss)"""


def measured(command, folder, limit=300):
    """Exit code, seconds of CPU time and peak bytes of a command, and what it said on standard error. CPU time, because
    other load does not count."""
    words = [sys.executable, "-IS", "-c", RUNNER, *map(str, command)]
    with tempfile.TemporaryFile() as said:
        child = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=said, cwd=folder, text=True, start_new_session=True)
        try:
            code, seconds, peak = child.communicate(timeout=limit)[0].splitlines()[-1].split()
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGKILL)
            child.communicate()
            code, seconds, peak = -9, limit, 0
        said.seek(0)
        return int(code), float(seconds), float(peak), said.read(4000).decode(errors="replace")


def fault(expect, code, seconds, peak, text):
    lines = text.splitlines()
    if expect is None and code != 0:
        return f"exit code {code}: {text}"
    if expect is not None and (code in (0, -9) or len(lines) < 1 or not re.search(expect, lines[0])):
        return f"exit code {code}, expected a line like /{expect}/, got: {text}"
    if seconds > SECONDS or peak > BYTES:
        return f"{seconds:.1f} s, {peak / 1e6:.0f} MB"
    return ""


def main():
    words = [a for a in sys.argv[3:] if not a.startswith("--")]
    intaglio, failures = os.path.abspath(sys.argv[1]), 0
    for name, expect, make, quick in cases:
        if words and not any(w in name for w in words) or not (quick or words or "--whole" in sys.argv):
            continue
        folder = pathlib.Path(tempfile.mkdtemp(dir=sys.argv[2]))
        try:
            code, seconds, peak, text = measured([intaglio, *make(folder)], folder)
            wrong = fault(expect, code, seconds, peak, text)
            last = (text.splitlines() or ["done"])[-1].replace(f"{folder}/", "")
            if "--table" in sys.argv:
                print(f"{name:42} {seconds:5.1f} s {peak / 1e6:6.0f} MB  {code:3}  {last[:200]}", flush=True)
            elif wrong:
                print(f"{name}: {wrong}")
            failures += bool(wrong)
        finally:
            shutil.rmtree(folder)
    return failures


if __name__ == "__main__":
    sys.exit(1 if main() else 0)
