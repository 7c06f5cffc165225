#!/usr/bin/env python3
"""Holds that whatever takes bytes from outside has a fuzzer.

  parsers  a function of src/, apps/ or include/ that is named parse_, decode_ or read_ and is given bytes, text or a stream
           must be called in fuzz/ (or in a header of tests/ that a fuzzer includes)
  readers  a line that reads a file or a socket must be followed, within 15 lines, by the call of such a parser

A comment beside either is an exception, and is checked:
  // Fuzzed by fuzz/NAME.cpp through FUNCTION     the fuzzer calls FUNCTION (or makes an object of that type), which calls this one
  // Not parsed: REASON      the bytes are copied, hashed or searched
  // Trusted: REASON         they come from the program's own user or from the program itself"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BYTES = re.compile(r"span<const std::uint8_t>|\bByteView\b|\bBytes\b(?! *&)|std::string_view|std::istream ?&")
PARSER = re.compile(r"\b((?:parse|decode|read)_\w+)\(((?:[^(){};]|\{\}|\([^()]*\))*)\)\s*;")
READER = re.compile(r"\b(?:read_file|read_text)\(|\bstd::ifstream\b|(?<![\w>])::(?:recv|recvfrom|f?read)\(|\bstd::cin\b")
MARKER = re.compile(r"// (?:(?:Not parsed|Trusted): \S|Fuzzed by (fuzz/\w+\.cpp) through (\w+))")
# Where the readers themselves are defined.
DEFINITIONS = {"src/core/file.cpp"}


def fuzzed_text(path: pathlib.Path) -> str:
    """A fuzzer's text, with that of the project's headers that stand in fuzz/ or tests/ and that it includes."""
    text = path.read_text()
    for header in re.findall(r'#include "((?:fuzz|tests)/[^"]+)"', text):
        text += (ROOT / header).read_text()
    return text


def without_comments(text: str) -> str:
    return re.sub(r"//[^\n]*", "", text)


def main() -> int:
    fuzzers = {path.relative_to(ROOT).as_posix(): fuzzed_text(path) for path in sorted((ROOT / "fuzz").glob("*.cpp"))}
    all_fuzzers = "\n".join(fuzzers.values()) + (ROOT / "fuzz/CMakeLists.txt").read_text()
    problems, parsers, readers = [], set(), 0

    def marked(lines: list[str], number: int, name: str) -> bool:
        """Whether the line, or a comment right above its statement, has a marker; a wrong one is a problem."""
        above = number
        while above > 0 and lines[above - 1].strip() and not lines[above - 1].rstrip().endswith((";", "{", "}")):
            above -= 1
        match = MARKER.search("\n".join(lines[above : number + 1]))
        if match and match.group(1) and not re.search(rf"\b{match.group(2)}\b", fuzzers.get(match.group(1), "")):
            problems.append(f"{name}:{number + 1}: {match.group(1)} does not call {match.group(2)}")
        return bool(match)

    sources = [path for folder in ("include", "src", "apps") for path in sorted((ROOT / folder).rglob("*"))]
    for path in (path for path in sources if path.suffix == ".h"):
        text, name = path.read_text(), path.relative_to(ROOT).as_posix()
        for match in PARSER.finditer(text):
            function, parameters = match.groups()
            if "return" in text[text.rfind("\n", 0, match.start()) : match.start()] or not BYTES.search(parameters):
                continue
            parsers.add(function)
            number = text.count("\n", 0, match.start())
            if not re.search(rf"\b{function}\b", all_fuzzers) and not marked(text.splitlines(), number, name):
                problems.append(f"{name}:{number + 1}: no fuzzer calls {function}")
    for path in (path for path in sources if path.suffix == ".cpp"):
        lines, name = path.read_text().splitlines(), path.relative_to(ROOT).as_posix()
        for number, line in enumerate(lines):
            if name in DEFINITIONS or not READER.search(without_comments(line)):
                continue
            readers += 1
            following = without_comments("\n".join(lines[number : number + 15]))
            if not any(re.search(rf"\b{parser}\(", following) for parser in parsers) and not marked(lines, number, name):
                problems.append(f"{name}:{number + 1}: reads what no fuzzed parser takes (the exceptions: tools/check_fuzzers.py)")
    print("\n".join(problems) if problems else f"{len(parsers)} parsers and {readers} readers have fuzzers")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
