#!/usr/bin/env python3
"""Holds docs/equations.md to the code: every formula of its table has a tag in the code and a named test.

A row reads | Eq. 1.2 | ... | `function` in `src/file.h` | `test name` in `tests/file.cpp` |. The tag is a comment line that
starts with the formula's name and cites the paper, right above the function. Tags without a row fail as well."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
TABLE = ROOT / "docs" / "equations.md"
TAG = re.compile(r"^\s*//\s*((?:Eq\. \d\.\d)|(?:§\d(?:\.\d+)+)), Sterling & Lin 2016(?:, §[\d.]+)?\s*$")
ROW = re.compile(r"^\|\s*(Eq\. \d\.\d|§[\d.]+)\s*\|")
REQUIRED = ["Eq. 1.1", "Eq. 1.2", "Eq. 1.3", "Eq. 1.4", "§1.3.1", "§1.3.2"]


def named(cell: str):
    """Pairs (name, file) of a cell such as `f` in `a.h`."""
    return re.findall(r"`([^`]+)` in `([^`]+)`", cell)


def main() -> int:
    problems, rows, tags = [], {}, {}
    for path in sorted((ROOT / "src").rglob("*")):
        if path.suffix in {".h", ".cpp"}:
            lines = path.read_text().splitlines()
            for number, line in enumerate(lines):
                if match := TAG.match(line):
                    following = "\n".join(lines[number + 1 : number + 4])
                    tags.setdefault(match.group(1), []).append((str(path.relative_to(ROOT)), number + 1, following))
    for line in TABLE.read_text().splitlines():
        if match := ROW.match(line):
            cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
            rows[match.group(1)] = (named(cells[-2]), named(cells[-1]))

    for formula in REQUIRED:
        if formula not in rows:
            problems.append(f"docs/equations.md: no row for {formula}")
    for formula, places in tags.items():
        if formula not in rows:
            problems.append(f"{places[0][0]}:{places[0][1]}: tag {formula} has no row in docs/equations.md")
    for formula, (functions, tests) in rows.items():
        if not functions or not tests:
            problems.append(f"docs/equations.md: {formula} names no function or no test")
        for function, file in functions:
            if not any(place[0] == file and re.search(rf"\b{re.escape(function)}\b", place[2]) for place in tags.get(formula, [])):
                problems.append(f"docs/equations.md: {file} has no tag {formula} right above {function}")
        for test, file in tests:
            source = ROOT / file
            if not source.exists() or f'TEST_CASE("{test}")' not in source.read_text():
                problems.append(f'docs/equations.md: {file} has no TEST_CASE("{test}") for {formula}')
    print("\n".join(problems) if problems else f"{len(rows)} formulas have code and tests")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
