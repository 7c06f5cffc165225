#!/usr/bin/env python3
"""One dialect in the whole project. Checks, by line (CONTRIBUTING.md says why):

  cast      static_cast to an arithmetic type: write int(x), double(x), std::size_t(x)
  static    a static at file level: use an anonymous namespace
  alias     an alias that hides a type of src/core, such as using Clock = std::chrono::steady_clock
  include   an #include in quotes that does not start at src/, apps/ or the project's folder; a header without #pragma once
  process   a call in src/ that changes the whole process: signal, setenv, dup2, exit, detach ... (a comment beside
            it that begins with "Process-wide:" gives the reason and is an exception)
  test      tests/*/*.cpp with a TEST_CASE is test_SUBJECT.cpp, and no other file is
  case      the name of a TEST_CASE is a sentence in the present tense, without a full stop, unique in its folder
  words     archaic words, and sentences that begin with Of, What, Who or Whose, in comments, messages and pages
  path      a file or folder named in a page that does not exist
  columns   comments over 110 columns; Markdown over 100 (tables, code and links excepted)
  length    a source file over 600 lines

  tools/check_dialect.py [FOLDER...]      only these folders
  tools/check_dialect.py --count          how many of each kind a folder, instead of each
"""
import collections
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
CODE_FOLDERS = ("include", "src", "apps", "tests", "bench", "fuzz", "examples")
# Where quoted includes start. Generated headers have no folder.
INCLUDE_ROOTS = ("include", "src", "apps", "")
GENERATED = {"intaglio_materials.h", "intaglio_thresholds.h", "intaglio_shaders.h", "model_generated.h"}

ARITHMETIC = r"(?:bool|char|short|int|unsigned|long|float|double|(?:std::)?(?:size_t|ptrdiff_t|u?int(?:8|16|32|64|ptr)_t))"
CAST = re.compile(rf"\bstatic_cast<{ARITHMETIC}>")
STATIC = re.compile(r"^(?:inline |constexpr )*static\b(?!_assert)")
ALIAS = re.compile(r"^\s*using (\w+) =")
PROCESS = re.compile(
    r"(?<![\w.>])(?:std::|::)?(?:signal|sigaction|setenv|unsetenv|putenv|dup2|dlsym|exit|_exit|_Exit|quick_exit|atexit|"
    r"setlocale|chdir|umask)\s*\(|\.detach\(\)"
)
CASE = re.compile(r'\bTEST_CASE(?:_TEMPLATE)?\(\s*((?:"(?:[^"\\]|\\.)*"\s*)+)')
ARCHAIC = re.compile(
    r"\b(?:[Dd]ear(?! ImGui)|dearer|dearest|told(?! (?:apart|otherwise|to)\b)|for ever|whoever|whom|whomever|whence|thence|"
    r"hither|thither|thereof|whereof|wherein|lest|reckon|nought|oftener)\b"
)
# A sentence that begins so and is no question.
RIDDLE = re.compile(r"(?:^|(?<=[.;:!?] ))(?:Of|What|Who|Whose|Whom|Whoever|Whence)\b(?![^.]*\?)")
# In code spans of pages: paths below the project's folders, and names of its sources.
PATH = re.compile(
    r"`((?:include|src|apps|tests|tools|script|bench|fuzz|examples|cmake|core|surface|mesh|contact|dynamics|haptics|sound|render|"
    r"scene|session|report|window|app|intaglio)/[\w./-]*[\w/]|\w+\.(?:h|cpp|glsl|frag|vert))`"
)
STRING = re.compile(r'"((?:[^"\\\n]|\\.)*)"')


def project_files() -> list[str]:
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return [name for name in listed.stdout.splitlines() if (ROOT / name).is_file()]


def core_types(files: list[str]) -> set[str]:
    declared = re.compile(r"^(?:class|struct|enum class) (\w+)", re.M)
    headers = [f for f in files if f.startswith(("src/core/", "include/")) and f.endswith(".h")]
    return {name for header in headers for name in declared.findall((ROOT / header).read_text())}


def split_comment(line: str) -> tuple[str, str]:
    """The code and the // comment of a line of C++; strings may hold //."""
    in_string = False
    k = 0
    while k < len(line) - 1:
        if line[k] == "\\":
            k += 1
        elif line[k] == '"':
            in_string = not in_string
        elif not in_string and line.startswith("//", k):
            return line[:k], line[k + 2 :].strip()
        k += 1
    return line, ""


def words(text: str, begins: bool):
    """Problems of English in a piece of text; `begins`: its first word begins a sentence."""
    for match in ARCHAIC.finditer(text):
        yield f'"{match.group(0)}"'
    for match in RIDDLE.finditer(text):
        if match.start() > 0 or begins:
            yield f'a sentence that begins with "{match.group(0)}"'


def check_code(name: str, text: str, hidden: set[str]):
    lines = text.splitlines()
    if len(lines) > 600:
        yield len(lines), "length", f"{len(lines)} lines; at most 600"
    if name.endswith(".h") and "#pragma once" not in text:
        yield 1, "include", "no #pragma once"
    comment_before = ""
    raw = False
    for number, line in enumerate(lines, 1):
        if raw:
            raw = ')"' not in line and ')html"' not in line
            continue
        raw = 'R"' in line and ')"' not in line.split('R"', 1)[1]
        code, comment = split_comment(line)
        if CAST.search(code):
            yield number, "cast", CAST.search(code).group(0)
        if STATIC.match(code):
            yield number, "static", code.strip()
        if (alias := ALIAS.match(code)) and alias.group(1) in hidden and "::" in code and "intaglio" not in code:
            yield number, "alias", code.strip()
        if match := re.match(r'#include "([^"]+)"', code):
            file = match.group(1)
            if file not in GENERATED and not any((ROOT / root / file).exists() for root in INCLUDE_ROOTS):
                yield number, "include", f'"{file}": give the path from src/, apps/ or the project\'s folder'
        elif name.startswith("src/") and PROCESS.search(code) and not comment.startswith("Process-wide:"):
            yield number, "process", code.strip()
        else:
            for string in STRING.findall(code):
                for problem in words(string, begins=True):
                    yield number, "words", f'{problem} in "{string}"'
        if comment:
            fresh = not comment_before or comment_before.endswith((".", ":", ";"))
            for problem in words(comment, begins=fresh):
                yield number, "words", f"{problem}: // {comment}"
            if len(line) > 110:
                yield number, "columns", f"a comment of {len(line)} columns"
        comment_before = comment


def check_case_names(name: str, text: str, seen: dict[str, str]):
    for match in CASE.finditer(text):
        number = text.count("\n", 0, match.start()) + 1
        title = "".join(STRING.findall(match.group(1)))
        if len(title.split()) < 3:
            yield number, "case", f'"{title}" is no sentence'
        if title.endswith("."):
            yield number, "case", f'"{title}" ends in a full stop'
        if wrong := re.search(r"\b(should|shall|will) ", title):
            yield number, "case", f'"{title}": "{wrong.group(1)}": say what is so'
        if title in seen:
            yield number, "case", f'"{title}" is the name of a case in {seen[title]}, too'
        seen[title] = name


def check_test_name(name: str, text: str):
    base = pathlib.PurePath(name).name
    if CASE.search(text) and not re.fullmatch(r"test_\w+\.cpp", base):
        yield 1, "test", f"{base} has a TEST_CASE: call it test_SUBJECT.cpp"
    elif not CASE.search(text) and base.startswith("test_"):
        yield 1, "test", f"{base} has no TEST_CASE: call it otherwise"


def check_markdown(name: str, text: str, names: set[str]):
    fenced = False
    before = ""
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
            continue
        if fenced or line.startswith("#"):
            before = ""
            continue
        table = line.startswith("|")
        if len(line) > 100 and not table and not re.search(r"\]\(|https?://|^\[|^\s*`[^`]*`\W?$", line):
            yield number, "columns", f"{len(line)} columns; at most 100"
        for path in PATH.findall(line):
            places = (ROOT / root / (path + suffix) for root in INCLUDE_ROOTS for suffix in ("", ".h", ".cpp"))
            if path not in names and "SUBJECT" not in path and not any(place.exists() for place in places):
                yield number, "path", f"{path} does not exist"
        prose = re.sub(r"`[^`]*`", "``", line).strip(" *#-")
        for problem in words(prose, begins=not table and (not before or before.endswith((".", ":", ";")))):
            yield number, "words", f"{problem}: {prose[:90]}"
        before = line.strip()


def check_script(name: str, text: str):
    for number, line in enumerate(text.splitlines(), 1):
        if match := re.search(r"(?:^|\s)#(?!!)\s*(.*)", line):
            for problem in words(match.group(1), begins=True):
                yield number, "words", f"{problem}: # {match.group(1)}"


def check(name: str, hidden: set[str], cases: dict[str, dict[str, str]], names: set[str]):
    path = ROOT / name
    folder = str(pathlib.PurePath(name).parent)
    if name.endswith((".h", ".cpp")) and name.startswith(CODE_FOLDERS):
        text = path.read_text()
        yield from check_code(name, text, hidden)
        if name.startswith("tests/") and name.count("/") > 1:
            yield from check_case_names(name, text, cases[folder])
            yield from check_test_name(name, text)
    elif name.endswith(".md") and not name.startswith(("workflow/", ".")):
        yield from check_markdown(name, path.read_text(), names)
    elif name.endswith((".sh", ".py", ".cmake", "CMakeLists.txt", ".glsl", ".frag", ".vert")) or name.startswith(("script/", "tools/")):
        if pathlib.PurePath(name).name != pathlib.PurePath(__file__).name:
            yield from check_script(name, path.read_text())


def main(arguments: list[str]) -> int:
    count = "--count" in arguments
    folders = tuple(a.rstrip("/") for a in arguments if a != "--count")
    files = project_files()
    hidden = core_types(files)
    names = {pathlib.PurePath(f).name for f in files}
    cases: dict[str, dict[str, str]] = collections.defaultdict(dict)
    total = collections.Counter()
    for name in files:
        if folders and not any(name == f or name.startswith(f + "/") for f in folders):
            continue
        for number, rule, text in check(name, hidden, cases, names):
            if not count:
                print(f"{name}:{number}: {rule}: {text}")
            parts = name.split("/")
            total["/".join(parts[:2]) if len(parts) > 2 else parts[0], rule] += 1
    if count:
        for (folder, rule), n in sorted(total.items()):
            print(f"{n:5d} {rule:8s} {folder}")
    problems = sum(total.values())
    print(f"{problems} problems of dialect" if problems else "one dialect")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
