#!/usr/bin/env python3
"""Holds docs/scene.md to the scene reader, and docs/study-design.md to that of designs: every key that the sources read has a row, and
no row is without a key. A row may name several keys."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
READ = re.compile(r'\b(?:r|reader)\.(?:number|integer|boolean|string|vec3|vec2|choice|rows|table|tables)\("([a-z_0-9]+)"')
HELPED = re.compile(r'(?:read_material|read_direction|start_from)\(\w+, "([a-z_]+)"')
ROW = re.compile(r"^\|\s*`([a-z_0-9]+)`\s*\|", re.M)
HEADING = re.compile(r"^## `\[+([a-z_]+)\]+`", re.M)


# Keys of a design, also as the first argument after the reader's of a helper.
READ_DESIGN = re.compile(r'\b(?:r|t|l)\.(?:number|integer|boolean|string|strings|vec2|choice|table|tables)\(\s*"([a-z_]+)"')
HELPED_DESIGN = re.compile(r'(?:read_(?:name|names|text_key|questions|texts|count|list)|set\.read)\((?:\w+, )?"([a-z_]+)"')
DESIGN_ROW = re.compile(r"^\|((?:\s*`[a-z_]+`,?)+)\s*\|", re.M)


def compare(page: str, read: set[str], documented: set[str]) -> list[str]:
    problems = [f"{page}: key {key} is read but not documented" for key in sorted(read - documented)]
    return problems + [f"{page}: key {key} is documented but not read" for key in sorted(documented - read)]


def main() -> int:
    source = "".join(f.read_text() for f in sorted((ROOT / "src/scene").glob("*.cpp"))) + (ROOT / "src/core/toml.cpp").read_text()
    docs = (ROOT / "docs/scene.md").read_text()
    read = set(READ.findall(source)) | set(HELPED.findall(source))
    problems = compare("docs/scene.md", read, set(ROW.findall(docs)) | set(HEADING.findall(docs)))

    design = "".join(f.read_text() for f in sorted((ROOT / "src/study/design").glob("design*.cpp")))
    docs = (ROOT / "docs/study-design.md").read_text()
    keys = set(READ_DESIGN.findall(design)) | set(HELPED_DESIGN.findall(design))
    rows = {key for row in DESIGN_ROW.findall(docs) for key in re.findall(r"[a-z_]+", row)}
    problems += compare("docs/study-design.md", keys, rows | set(HEADING.findall(docs)))
    print("\n".join(problems) if problems else f"{len(read)} scene keys and {len(keys)} keys of designs are documented")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
