# SPDX-License-Identifier: BSD-3-Clause
"""Every public function has a docstring: what it does, each argument, what it returns, and from where it may be called.

What holds for a whole header, or is that of another function which the docstring names, need not be said again."""
import pathlib
import re
import sys

FUNCTION = re.compile(r"(/\*\*(?:(?!\*/).)*\*/)?\s*OTG_API\s+([^;{]+?)(\w+)\s*\(([^;]*)\)\s*;", re.S)
REFERS = re.compile(r"\bAs (?:there|d\w+\(\))|\bThe same\b|@sa d\w+|Arguments? (?:for argument|as) ?d\w+")
THREADS = re.compile(r"thread|near callback")


def faults(header):
    text = header.read_text()
    declared = len(re.findall(r"^OTG_API", text, re.M))
    found = 0
    for match in FUNCTION.finditer(text):
        found += 1
        doc, result, name, arguments = match.groups()
        if doc is None or "@brief" not in doc:
            yield f"{name}: no docstring"
            continue
        refers = REFERS.search(doc) is not None
        if result.strip() != "void" and "@returns" not in doc and not refers:
            yield f"{name}: what it returns is not said"
        if not refers and not THREADS.search(doc):
            yield f"{name}: from which threads it may be called is not said"
        if refers:
            continue
        for argument in [] if arguments.strip() == "void" else arguments.split(","):
            argument = re.search(r"(\w+)\s*(\[[^\]]*\])?\s*$", argument).group(1)
            if not re.search(rf"\b{argument}\b", doc.split("@brief", 1)[1]):
                yield f"{name}: nothing is said of {argument}"
    if found != declared:
        yield f"{found} of {declared} functions were understood"


headers = sorted(pathlib.Path(sys.argv[1]).glob("*.h"))
assert len(headers) > 10, headers
wrong = [f"{header.name}: {fault}" for header in headers for fault in faults(header)]
print("\n".join(wrong))
sys.exit(1 if wrong else 0)
