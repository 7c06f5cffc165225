"""What tools/stop_latency and tools/kill_trial have in common: a folder with inputs of every size for the verbs of `intaglio`, runs of
them, and what a run has left behind."""
import hashlib, os, pathlib, random, select, shutil, struct, subprocess, tempfile, time, uuid, zlib

SOURCE = pathlib.Path(__file__).resolve().parent.parent


def write_png(file, side, seed=1):
    """A grey image of noise that is quick to make."""
    row = random.Random(seed).randbytes(side)
    rows = b"".join(b"\0" + row[k % side :] + row[: k % side] for k in range(0, 7 * side, 7))
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0)
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b""))


def cuboid(x, y, z):
    corners = [(a, b, c) for c in (0, z) for b in (0, y) for a in (0, x)]
    faces = "1 3 2,2 3 4,5 6 7,6 8 7,1 2 5,2 6 5,3 7 4,4 7 8,1 5 3,3 5 7,2 4 6,4 8 6".split(",")
    return "".join("v %g %g %g\n" % corner for corner in corners) + "".join(f"f {face}\n" for face in faces)


class Run:
    """A command that has been started."""

    def __init__(self, world, arguments, variables=None):
        self.world, self.mark = world, "INTAGLIO_TRIAL=" + uuid.uuid4().hex
        name, value = self.mark.split("=")
        with open(world.work / "stdout", "wb") as out, open(world.work / "stderr", "wb") as errors:
            self.process = subprocess.Popen(
                [world.program, *map(str, arguments)], stdin=subprocess.DEVNULL, stdout=out, stderr=errors,
                env={**world.variables, **(variables or {}), name: value}, cwd=world.work, start_new_session=True)
        self.descriptor = os.pidfd_open(self.process.pid)

    def said(self):
        return (self.world.work / "stderr").read_text(errors="replace")

    def printed(self):
        return (self.world.work / "stdout").read_text(errors="replace")

    def has_ended(self, within=0.0):
        return bool(select.select([self.descriptor], [], [], within)[0])

    def code(self, within=60.0):
        """The exit code, or None where it takes longer; then it is killed."""
        ended = self.has_ended(within)
        if not ended:
            self.process.kill()
        code = self.process.wait()
        os.close(self.descriptor)
        return code if ended else None

    def family(self):
        """The processes that have come from this command, itself among them; they inherit the mark."""
        found = []
        for entry in os.listdir("/proc"):
            if entry.isdigit():
                try:
                    if self.mark.encode() in pathlib.Path("/proc", entry, "environ").read_bytes():
                        found.append(int(entry))
                except OSError:
                    pass
        return found

    def orphans(self):
        """What is left of them, 0.3 s after the end."""
        end = time.monotonic() + 0.3
        while (left := self.family()) and time.monotonic() < end:
            time.sleep(0.01)
        return left


class World:
    """A folder of inputs, and an empty one for results, `out`."""

    def __init__(self, program):
        self.program = str(pathlib.Path(program).resolve())
        self.work = pathlib.Path(tempfile.mkdtemp())
        self.out, self.temporary = self.work / "out", self.work / "temporary"
        self.temporary.mkdir()
        self.empty()
        self.variables = {**os.environ, "TMPDIR": str(self.temporary),  # in the folder of mkdtemp
                          "XDG_CONFIG_HOME": str(self.work / "config"), "XDG_CACHE_HOME": str(self.work / "cache"), "SDL_VIDEODRIVER": "offscreen", "LP_NUM_THREADS": "2"}
        self.add_scenes()
        self.add_programs()
        meshes = self.work / "meshes"
        meshes.mkdir()
        for k in range(4):
            (meshes / f"bar{k}.obj").write_text(cuboid(0.3, 0.05, 0.03 + 0.005 * k))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        shutil.rmtree(self.work, ignore_errors=True)

    def add_scenes(self):
        """scene/brick.toml is small and quick; slow/slow.toml has 40 models to bake, and no baked ones."""
        text = (SOURCE / "scenes/brick.toml").read_text()
        for key, value in {"width": 64, "height": 36, "fps": 10, "supersample": 1}.items():
            text = "\n".join(f"{key} = {value}" if line.startswith(key + " =") else line for line in text.split("\n"))
        for name in ("scene", "slow"):
            (self.work / name).mkdir()
        (self.work / "scene/models").symlink_to(SOURCE / "scenes/models")
        (self.work / "scene/brick.toml").write_text(text)
        balls = "".join(f'[[ball]]\nradius = {0.03 + 0.0001 * k}\nposition = [0, {0.3 + 0.1 * k}, 0]\n' for k in range(40))
        (self.work / "slow/slow.toml").write_text('[surface]\ntexture = "brick"\n[sound]\nmodes = 200\n' + balls)

    def add_programs(self):
        """An ffmpeg that never comes to an end of its second pass, and a Netgen that never ends; both say that they have begun."""
        stuck = self.work / "stuck"
        stuck.mkdir()
        real = shutil.which("ffmpeg")
        (stuck / "ffmpeg").write_text(f'#!/bin/sh\ncase "$*" in *faststart*) touch "{self.work}/begun"; sleep 60;; esac\nexec {real} "$@"\n')
        (stuck / "netgen").write_text(f'#!/bin/sh\ntouch "{self.work}/begun"\nsleep 60\n')
        for name in ("ffmpeg", "netgen"):
            (stuck / name).chmod(0o755)

    def add_big_image(self):
        write_png(self.work / "big.png", 4096)

    def add_log(self, name, seconds):
        """A haptic log."""
        made = Run(self, ["-q", "render", "scene/brick.toml", "-o", "log/log.mp4", "--duration", seconds]).code()
        assert made == 0, self.work.joinpath("stderr").read_text()
        (self.work / "log/log.servo.csv").rename(self.work / name)

    def empty(self):
        shutil.rmtree(self.out, ignore_errors=True)
        self.out.mkdir()
        (self.work / "begun").unlink(missing_ok=True)

    def has_begun(self):
        return (self.work / "begun").exists()

    def results(self):
        """Each file of `out` with a hash of what is in it."""
        return {str(f.relative_to(self.out)): hashlib.sha256(f.read_bytes()).hexdigest() for f in sorted(self.out.rglob("*")) if f.is_file()}

    def hidden(self):
        return sorted(str(f.relative_to(self.out)) for f in self.out.rglob(".*") if f.is_file())

    def strays(self):
        """Temporaries, of ours and of programs that we start."""
        return self.hidden() + [str(f) for f in self.temporary.iterdir()]
