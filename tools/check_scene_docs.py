#!/usr/bin/env python3
"""Holds docs/scene.md to the scene reader: every key that src/scene/*.cpp and src/core/toml.cpp read has a row, and no row is without a key."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
READ = re.compile(r'\b(?:r|reader)\.(?:number|integer|boolean|string|vec3|vec2|choice|rows|table|tables)\("([a-z_0-9]+)"')
HELPED = re.compile(r'(?:read_material|read_direction|start_from)\(\w+, "([a-z_]+)"')
ROW = re.compile(r"^\|\s*`([a-z_0-9]+)`\s*\|", re.M)
HEADING = re.compile(r"^## `\[+([a-z_]+)\]+`", re.M)


def main() -> int:
    source = "".join(f.read_text() for f in sorted((ROOT / "src/scene").glob("*.cpp"))) + (ROOT / "src/core/toml.cpp").read_text()
    docs = (ROOT / "docs/scene.md").read_text()
    read = set(READ.findall(source)) | set(HELPED.findall(source))
    documented = set(ROW.findall(docs)) | set(HEADING.findall(docs))
    problems = [f"docs/scene.md: key {key} is read but not documented" for key in sorted(read - documented)]
    problems += [f"docs/scene.md: key {key} is documented but not read" for key in sorted(documented - read)]
    print("\n".join(problems) if problems else f"{len(read)} scene keys are documented")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
