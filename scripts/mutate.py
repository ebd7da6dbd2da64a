#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Breaks one line of a source tree at random, for scripts/mutate.sh.

    mutate.py TREE SEED [PATTERN]        changes one line of TREE; prints FILE:LINE, the old and the new line, separated
                                         by tabs
    mutate.py TREE SEED PATTERN COUNT    changes nothing; prints the first COUNT seeds from SEED on that change a line,
                                         and the file of each

PATTERN is a regular expression that the file's path within TREE must have.
The same seed and tree give the same change. Exit status 2 if the line that was drawn has nothing to break.
"""
import itertools
import random
import re
import sys
from pathlib import Path

# What is looked for, and what takes its place. One match in the line is drawn.
OPERATORS = [
    (r"<=", "<"), (r">=", ">"), (r"(?<= )<(?= )", "<="), (r"(?<= )>(?= )", ">="),
    (r"==", "!="), (r"!=", "=="), (r"&&", "||"), (r"\|\|", "&&"), (r"(?<=[\w)\]] )\+(?= )", "-"),
    (r"(?<=[\w)\]] )-(?= )", "+"), (r"(?<= )\*(?= )", "/"), (r"\btrue\b", "false"), (r"\bfalse\b", "true"),
    (r"\bmin\(", "max("), (r"\bmax\(", "min("), (r"\b0\b(?![.x])", "1"), (r"\b1\b(?![.x])", "2"),
    (r"\bif \(", "if (false && "), (r"\bif \(", "if (true || "), (r"\bcontinue;", ";"), (r"\bbreak;", ";"),
]
# Lines that no test can be asked about: text, includes, declarations of constants' names, asserts, prefetches,
# messages.
PASSED_OVER = re.compile(r"^\s*(//|/?\*|#|static_assert|assert\(|namespace|using|template|\}|$)"
                         r"|case .*:$|prefetch|\"")


def sources(tree):
    files = sorted(Path(tree).glob("ode_trimesh_gpu/**/*.cpp")) + sorted(Path(tree).glob("ode_trimesh_gpu/**/*.h"))
    files = [f for f in files if "include/ode_trimesh_gpu" not in str(f)]
    return files + sorted(Path(tree).glob("kernels/**/*.cl")) + sorted(Path(tree).glob("kernels/**/*.h"))


def changes(line):
    if PASSED_OVER.search(line):
        return []
    code = line.split("//")[0]
    return [(m.start(), m.end(), new) for pattern, new in OPERATORS for m in re.finditer(pattern, code)]


def drawn(lines, seed):
    """The change of a seed: number of the file, of the line, and what is put where. None if the line has nothing to
    break."""
    draw = random.Random(seed)
    # Every line is as likely as any other, whatever file it is in.
    place = draw.randrange(sum(len(text) for text in lines))
    number = 0
    while place >= len(lines[number]):
        place -= len(lines[number])
        number += 1
    choices = changes(lines[number][place])
    return (number, place, *draw.choice(choices)) if choices else None


def main():
    tree, seed = sys.argv[1], int(sys.argv[2])
    pattern = re.compile(sys.argv[3] if len(sys.argv) > 3 else "")
    files = [f for f in sources(tree) if pattern.search(str(f.relative_to(tree)))]
    lines = [f.read_text().splitlines(keepends=True) for f in files]
    if len(sys.argv) > 4:
        some = ((s, drawn(lines, s)) for s in itertools.count(seed))
        for s, change in itertools.islice((pair for pair in some if pair[1]), int(sys.argv[4])):
            print(s, files[change[0]].relative_to(tree))
        return 0
    change = drawn(lines, seed)
    if change is None:
        return 2
    number, place, begin, end, new = change
    text = lines[number]
    old = text[place]
    text[place] = old[:begin] + new + old[end:]
    files[number].write_text("".join(text))
    print(f"{files[number].relative_to(tree)}:{place + 1}\t{old.strip()}\t{text[place].strip()}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
