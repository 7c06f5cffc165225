#!/usr/bin/env python3
"""Fails on names that two users or two clones that build and test at once would share: fixed names in the temporary folder, names
that are not unique (a process id outlives its process in leftovers, rand() without a seed is the same for all), shared memory,
displays and ports. Use mkdtemp, mktemp, Python's tempfile, -displayfd and port 0; in C++ tests/temporary_folder.h.
Fails too where src/ and apps/ open a file for writing, or rename one, other than by core/output_files.h.
Prints each finding as file:line and exits 1."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDERS = ["apps", "bench", "cmake", "examples", "fuzz", "include", "src", "script", "tests", "tools", "workflow"]
SUFFIXES = {".h", ".cpp", ".sh", ".py", ".cmake", ".txt", ".yaml", ""}
NOT_TEXT = {"seeds", "golden"}

WRONG = [  # pattern, what to write instead
    (re.compile(r"""(?<![\w.}"')])/(?:var/)?tmp\b|/dev/shm\b|\bP_tmpdir\b"""), "a fixed place; ask mktemp -d, or tests/temporary_folder.h"),
    (re.compile(r"\b(?:tmpnam|tempnam|tmpnam_r)\s*\(|\btempfile\.mktemp\b|\bmktemp\s+(?:-\w*\s+)*-\w*u"), "a name without its file can be taken by others; create the file or folder with it"),
    (re.compile(r"\b(?:std::)?s?rand\s*\("), "the same numbers in every process; core/random.h has a seed"),
    (re.compile(r"\b(?:shm_open|sem_open|mq_open)\s*\("), "a name for the whole machine"),
    (re.compile(r"\bgetpid\s*\((?!.*// Not in a name)"), "a process id is not unique: an earlier process had it and may have left files behind"),
    (re.compile(r"\bXvfb\s+:\d|\bxvfb-run\s+(?!.*(?:-a\b|--auto))"), "a fixed display; Xvfb -displayfd, or xvfb-run -a"),
    (re.compile(r'"\$intaglio" devices serve\b(?!.*--port)'), "a fixed port; --port 0 prints a free one"),
]
WRITES = re.compile(r"""\bofstream\b|\bfopen\s*\([^;]*"[wa]|\b(?:fs|filesystem)::(?:rename|copy_file)\s*\(|\brename(?:at2?)?\s*\(|\bO_CREAT\b|\bmkstemps?\b""")
WRITERS = {
    "src/core/output_files.cpp",  # which is the way
    "src/study/store/stream_recorder.cpp",  # appends to new files while a trial runs; what a kill leaves is their purpose
    "apps/netgen/main.cpp",  # a program of its own, in a folder that core/process's caller has made for it
}
ASKS = re.compile(r"\btemp_directory_path\s*\(|\bTMPDIR\b")  # right only where mkdtemp makes the name out of it

def is_comment(line, path):
    return line.lstrip().startswith("//" if path.suffix in {".h", ".cpp"} else "#")


def findings(path):
    name = str(path.relative_to(ROOT))
    lines = path.read_text().splitlines()
    for number, line in enumerate(lines, 1):
        if is_comment(line, path):
            continue
        for pattern, instead in WRONG:
            if match := pattern.search(line + "\n"):
                yield f"{name}:{number}: {match.group(0).strip()}: {instead}"
        if name.startswith(("src/", "apps/")) and name not in WRITERS and (match := WRITES.search(line)):
            yield f"{name}:{number}: {match.group(0).strip()}: results are written by core/output_files.h"
        if ASKS.search(line) and "mkdtemp" not in "".join(lines[number - 1 : number + 2]):
            yield f"{name}:{number}: a name in the temporary folder that mkdtemp does not make; tests/temporary_folder.h has one"


def main() -> int:
    wrong, files = [], 0
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*")):
            parts = path.relative_to(ROOT).parts
            if not path.is_file() or path.suffix not in SUFFIXES or NOT_TEXT & set(parts) or path == pathlib.Path(__file__).resolve():
                continue
            files += 1
            wrong += findings(path)
    print("\n".join(wrong) if wrong else f"no fixed temporary names in {files} files")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
