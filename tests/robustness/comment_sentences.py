# SPDX-License-Identifier: BSD-3-Clause
"""The sentences of comments in C, C++ and OpenCL C."""
import re

LINE = re.compile(r"\s*//[/!]?<?\s?(.*)$")
TRAILING = re.compile(r"\S.*?\s//[/!]?<?\s(.*)$")


def comments(text):
    """(number of the first line, its lines) of each comment. Lines that follow each other are one."""
    lines, i = text.split("\n"), 0
    while i < len(lines):
        first = i
        if LINE.match(lines[i]):
            parts = []
            while i < len(lines) and LINE.match(lines[i]):
                parts.append(LINE.match(lines[i]).group(1))
                i += 1
            yield first + 1, parts
        elif re.match(r"\s*/\*", lines[i]):
            parts = []
            while i < len(lines):
                line = re.sub(r"^\s*(/\*\*?|\*(?!/))?\s?", "", lines[i])
                parts.append(line.split("*/")[0])
                i += 1
                if "*/" in line:
                    break
            yield first + 1, parts
        else:
            trailing = TRAILING.search(lines[i])
            if trailing:
                yield first + 1, [trailing.group(1)]
            i += 1


def sentences(text):
    """(number of the line of the comment, sentence). Tables are left out."""
    for line, parts in comments(text):
        joined = "\n".join(part for part in parts if not part.lstrip().startswith("|"))
        for block in re.split(r"\n\s*\n|\n(?=\s*[-*] |\s*\d+\. |@\w+|\s{2,})|(?=@(?:param|returns|remarks|brief))",
                              joined):
            for sentence in re.split(r"(?<=[.!?:;])\s+", block):
                yield line, " ".join(sentence.split())


def word_count(sentence):
    """Of formulas only the words count."""
    return sum(bool(re.search("[A-Za-z]{2}", word)) for word in sentence.split())
