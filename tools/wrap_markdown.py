#!/usr/bin/env python3
"""tools/wrap_markdown.py FILE...: wraps paragraphs and list items of Markdown files at 100 columns.

Only paragraphs with a longer line change. Tables, code, headings and HTML stay as they are; code spans and links are never broken.
Fails, changing nothing, if anything but white space would change."""
import re
import sys

COLUMNS = 100
UNBREAKABLE = re.compile(r"`[^`]*`|!?\[[^\]]*\]\([^)]*\)")
# A word that must not begin a line, since it would begin something else there.
MARKER = re.compile(r"[-+*]|\d+[.)]|#+|>|\||=+|-+|```.*|~~~.*")
LIST_ITEM = re.compile(r"(\s*)([-+*]|\d+[.)])(\s+)(.*)")
QUOTE = re.compile(r"(\s*>\s?)(.*)")


def words_of(text: str) -> list[str]:
    spans: list[str] = []

    def hide(match):
        spans.append(match.group(0))
        return f"\x00{len(spans) - 1}\x01"

    return [re.sub(r"\x00(\d+)\x01", lambda m: spans[int(m.group(1))], word) for word in UNBREAKABLE.sub(hide, text).split()]


def fill(words: list[str], first: str, rest: str) -> list[str]:
    lines, line, empty = [], first, True
    for word in words:
        longer = line + word if empty else f"{line} {word}"
        if not empty and len(longer) > COLUMNS and not MARKER.fullmatch(word):
            lines.append(line)
            longer = rest + word
        line, empty = longer, False
    return [*lines, line]


class Paragraph:
    def __init__(self, line: str, first: str, rest: str, text: str):
        self.lines, self.first, self.rest, self.texts = [line], first, rest, [text]

    def add(self, line: str, text: str):
        self.lines.append(line)
        self.texts.append(text)

    def wrapped(self) -> list[str]:
        if all(len(line) <= COLUMNS for line in self.lines):
            return self.lines
        return fill(words_of(" ".join(self.texts)), self.first, self.rest)


def wrap(text: str) -> str:
    out: list[str] = []
    fence = None
    paragraph = None

    def end():
        nonlocal paragraph
        if paragraph:
            out.extend(paragraph.wrapped())
        paragraph = None

    for line in text.split("\n"):
        stripped = line.strip()
        if fence:
            out.append(line)
            if stripped.startswith(fence):
                fence = None
        elif match := re.match(r"```+|~~~+", stripped):
            end()
            fence = match.group(0)
            out.append(line)
        elif not stripped or stripped[0] in "|#<" or (line.startswith("    ") and not paragraph):
            end()
            out.append(line)
        elif match := LIST_ITEM.fullmatch(line):
            end()
            first = match.group(1) + match.group(2) + match.group(3)
            paragraph = Paragraph(line, first, " " * len(first), match.group(4))
        elif match := QUOTE.fullmatch(line):
            if paragraph and paragraph.first == match.group(1):
                paragraph.add(line, match.group(2))
            else:
                end()
                paragraph = Paragraph(line, match.group(1), match.group(1), match.group(2))
        elif paragraph:
            paragraph.add(line, stripped)
        else:
            indent = line[: len(line) - len(line.lstrip())]
            paragraph = Paragraph(line, indent, indent, stripped)
        if line.endswith(("  ", "\\")):
            end()  # a hard line break
    end()
    return "\n".join(out)


def main(files: list[str]) -> int:
    for file in files:
        with open(file, encoding="utf-8") as page:
            before = page.read()
        after = wrap(before)
        assert before.split() == after.split(), file
        if after != before:
            with open(file, "w", encoding="utf-8") as page:
                page.write(after)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
