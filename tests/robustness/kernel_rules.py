#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Rules of the functions in kernels/ that no compiler checks.

  kernel_rules.py ROOT EXCEPTIONS        checks the tree at ROOT; exit status 1 if a rule is broken
  kernel_rules.py --write ROOT           prints today's exceptions
  kernel_rules.py --self-test DIR        makes small trees below DIR that break each rule once, and expects a report

A function has MOST_LINES lines and MOST_PARAMETERS parameters at most. A kernel takes one OTG_GIVEN(NAME), which counts
as one, of a structure that a header of kernels/shared/layout/ binds to the kernel by OTG_STRUCTURE(NAME, "kernel").

EXCEPTIONS lists functions that do not keep that: file, name, lines, parameters and, for a kernel whose parameters are
written by hand, "by-hand". A listed function may not grow, and has to leave the list when it keeps the rules; so the
list only shrinks.
"""
import os
import re
import shutil
import sys

MOST_LINES = 60
MOST_PARAMETERS = 8
BY_HAND = "by-hand"


def without_comments(text):
    """The text with comments, strings and lines of the preprocessor blank, and all lines where they were."""
    def kept(found):
        return re.sub(r"[^\n]", " ", found.group())

    text = re.sub(r"//[^\n]*|/\*.*?\*/", kept, text, flags=re.S)
    text = re.sub(r'"(?:[^"\\\n]|\\.)*"', kept, text)
    return re.sub(r"^[ \t]*#(?:\\\n|[^\n])*", kept, text, flags=re.M)


def parameters_of(text):
    """How many there are between the parentheses. One that only one branch of the preprocessor has counts, too."""
    depth, count = 0, 1
    for c in text:
        depth += c in "([{"
        depth -= c in ")]}"
        count += c == "," and depth == 0
    return 0 if text.strip() in ("", "void") else count


class Function:
    def __init__(self, file, header, line, lines):
        self.file, self.line, self.lines = file, line, lines
        end = header.rindex(")")
        begin, depth = end, 0
        while True:
            depth += header[begin] == ")"
            depth -= header[begin] == "("
            if depth == 0:
                break
            begin -= 1
        inside = header[begin + 1 : end]
        self.parameters = parameters_of(inside)
        self.name = re.search(r"(\w+)\)?\s*$", header[:begin]).group(1)
        self.is_kernel = re.search(r"\b(__kernel|kernel|OTG_\w*KERNEL)\b", header[:begin]) is not None
        self.given = set(re.findall(r"\bOTG_GIVEN\(\s*(\w+)\s*\)", inside))
        rest = re.sub(r"\bOTG_GIVEN\(\s*\w+\s*\)", "", inside)
        # A branch of the preprocessor for each structure: only one is there at a time.
        if self.given and not rest.strip():
            self.parameters = 1
        self.by_hand = self.is_kernel and (not self.given or bool(rest.strip()))


def functions_of(file, text):
    """All that are defined at the outermost level."""
    text = without_comments(text)
    found, depth, begin, header = [], 0, 0, ""
    for i, c in enumerate(text):
        if c == "{":
            if depth == 0:
                header = text[begin:i]
                first = begin + len(header) - len(header.lstrip())
            depth += 1
        elif c == "}":
            depth -= 1
            if depth < 0:
                raise ValueError("%s: braces do not match" % file)
            if depth == 0:
                if header.rstrip().endswith(")"):
                    line = text.count("\n", 0, first) + 1
                    found.append(Function(file, header, line, text.count("\n", first, i) + 1))
                begin = i + 1
        elif c == ";" and depth == 0:
            begin = i + 1
    if depth != 0:
        raise ValueError("%s: braces do not match" % file)
    return found


def merged(functions):
    """One for each name, as large as the largest: branches of the preprocessor may define one each."""
    by_name = {}
    for f in functions:
        one = by_name.setdefault(f.name, f)
        one.lines, one.parameters = max(one.lines, f.lines), max(one.parameters, f.parameters)
        one.by_hand = one.by_hand or f.by_hand
        one.given |= f.given
    return list(by_name.values())


def kernel_files(root):
    for folder, folders, files in os.walk(os.path.join(root, "kernels")):
        folders.sort()
        for name in sorted(files):
            if name.endswith((".h", ".cl")):
                yield os.path.join(folder, name)


def scan(root):
    """All functions, and by structure the names of the kernels that it is bound to."""
    functions, structures = [], {}
    for path in kernel_files(root):
        with open(path, encoding="utf-8") as source:
            text = source.read()
        file = os.path.relpath(path, root)
        functions += merged(functions_of(file, text))
        if file.startswith("kernels/shared/layout/"):
            for name, kernel in re.findall(r'^OTG_STRUCTURE\((\w+), "(\w+)"\)', text, flags=re.M):
                structures.setdefault(name, set()).add(kernel)
    return functions, structures


def breaks_rules(function):
    return function.lines > MOST_LINES or function.parameters > MOST_PARAMETERS or function.by_hand


def described(function):
    words = [function.file, function.name, str(function.lines), str(function.parameters)]
    return " ".join(words + ([BY_HAND] if function.by_hand else []))


def read_exceptions(path):
    exceptions = {}
    with open(path, encoding="utf-8") as lines:
        for line in lines:
            words = line.split("#")[0].split()
            if words:
                exceptions[(words[0], words[1])] = (int(words[2]), int(words[3]), BY_HAND in words[4:])
    return exceptions


def check(root, exceptions):
    """What is wrong, in a line each."""
    functions, structures = scan(root)
    wrong, left = [], dict(exceptions)
    if not functions:
        wrong.append("no functions found below %s/kernels" % root)
    for f in functions:
        place = "%s:%d: %s" % (f.file, f.line, f.name)
        for name in sorted(f.given):
            if f.name not in structures.get(name, ()):
                wrong.append('%s takes %s, which no OTG_STRUCTURE(%s, "%s") makes' % (place, name, name, f.name))
        if not breaks_rules(f):
            continue
        allowed = left.pop((f.file, f.name), None)
        now = (f.lines, f.parameters, f.by_hand)
        if allowed is None:
            why = ["its parameters are written by hand: give it a structure"] if f.by_hand else []
            if f.lines > MOST_LINES or f.parameters > MOST_PARAMETERS:
                why.append("%d lines and %d parameters; %d and %d are the most"
                           % (f.lines, f.parameters, MOST_LINES, MOST_PARAMETERS))
            wrong.append("%s: %s" % (place, "; ".join(why)))
        elif any(is_now > was for is_now, was in zip(now, allowed, strict=True)):
            wrong.append("%s grew: the list of exceptions has %d lines and %d parameters, it is '%s'"
                         % (place, allowed[0], allowed[1], described(f)))
        elif now != allowed:
            wrong.append("%s shrank: write '%s' into the list of exceptions" % (place, described(f)))
    taken = {(name, f.name) for f in functions for name in f.given}
    for name in sorted(structures):
        for kernel in sorted(structures[name]):
            if (name, kernel) not in taken:
                wrong.append('OTG_STRUCTURE(%s, "%s"): no such kernel takes it' % (name, kernel))
    for file, name in left:
        wrong.append("%s: %s keeps the rules or is gone: take it off the list of exceptions" % (file, name))
    return wrong


def write_tree(folder, files):
    shutil.rmtree(folder, ignore_errors=True)
    for name, text in files.items():
        path = os.path.join(folder, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as out:
            out.write(text)


def self_test(folder):
    """Exit status."""
    def body(lines):
        return "{\n" + "  // }\n" * (lines - 2) + "}\n"
    layout = "kernels/shared/layout/a_given.h"
    structure = 'OTG_STRUCTURE(Walk, "walk")\n'
    clean = {layout: structure, "kernels/a.cl": "__kernel void walk(OTG_GIVEN(Walk)) {\n  if (x) { y(); }\n}\n"}
    eight = "void f(%s) {}\n" % ", ".join("int p%d" % i for i in range(8))
    nine = "void f(%s) {}\n" % ", ".join("__global const int* p%d" % i for i in range(9))
    branches = "__kernel void walk(\n#if A\n    OTG_GIVEN(Walk)\n#else\n    OTG_GIVEN(Walk)\n#endif\n) {}\n"
    long = "inline static int f(void)\n" + body(MOST_LINES)
    cases = [  # name, files, exceptions, part of the report or None
        ("clean", clean, {}, None),
        ("branches", {layout: structure, "kernels/a.cl": branches}, {}, None),
        ("eight", {"kernels/a.h": eight}, {}, None),
        ("sixty", {"kernels/a.h": "int f(void) " + body(MOST_LINES)}, {}, None),
        ("long", {"kernels/a.h": long}, {}, "f: 61 lines"),
        ("generic", {"kernels/a.h": "REAL OTG_NAME(f)(int x)\n" + body(MOST_LINES)}, {}, "f: 61 lines"),
        ("nine", {"kernels/a.h": nine}, {}, "9 parameters"),
        ("by_hand", {"kernels/a.cl": "__kernel void walk(int x) {}\n"}, {}, "by hand"),
        ("half", {layout: structure, "kernels/a.cl": "__kernel void walk(OTG_GIVEN(Walk), int x) {}\n"}, {}, "by hand"),
        ("other", {**clean, "kernels/b.cl": "__kernel void run(OTG_GIVEN(Walk)) {}\n"}, {}, "run takes Walk"),
        ("not_taken", {layout: structure, "kernels/a.h": eight}, {}, "no such kernel"),
        ("listed", {"kernels/a.h": long}, {("kernels/a.h", "f"): (61, 0, False)}, None),
        ("grown", {"kernels/a.h": long}, {("kernels/a.h", "f"): (60, 9, False)}, "grew"),
        ("shrunk", {"kernels/a.h": long}, {("kernels/a.h", "f"): (62, 0, False)}, "shrank"),
        ("kept", {"kernels/a.h": eight}, {("kernels/a.h", "f"): (61, 9, False)}, "keeps the rules"),
        ("gone", clean, {("kernels/b.h", "f"): (61, 9, False)}, "keeps the rules"),
        ("empty", {"kernels/a.txt": ""}, {}, "no functions"),
    ]
    failed = 0
    for name, files, exceptions, part in cases:
        tree = os.path.join(folder, name)
        write_tree(tree, files)
        report = check(tree, exceptions)
        good = not report if part is None else len(report) == 1 and part in report[0]
        if not good:
            failed = 1
            print("self-test '%s': expected %s, got %s" % (name, part, report))
    return failed


def main(arguments):
    if len(arguments) == 2 and arguments[0] == "--self-test":
        return self_test(arguments[1])
    if len(arguments) == 2 and arguments[0] == "--write":
        print("\n".join(described(f) for f in scan(arguments[1])[0] if breaks_rules(f)))
        return 0
    if len(arguments) != 2:
        print(__doc__)
        return 2
    wrong = check(arguments[0], read_exceptions(arguments[1]))
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
