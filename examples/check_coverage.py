#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""check_coverage.py INCLUDE_FOLDER EXAMPLES_FOLDER: every public function is called in an example and documented.

Documented means: a comment before it with @brief and @ingroup; each argument under @param; what it returns under
@returns. A function that says it is "the same" as the one before, or names the function whose text holds for it, needs
not repeat them. Prints what is missing; exit status 1 if anything is.
"""
import pathlib
import re
import sys

DECLARATION = re.compile(r'(?P<comment>/\*\*(?:(?!\*/).)*\*/)?\s*OTG_API\s+(?P<type>[^;(]*?)\b(?P<name>d[A-Z]\w*)\s*'
                         r'\((?P<arguments>[^;]*)\);', re.S)


def argument_names(text):
    text = ' '.join(text.split())
    if text in ('void', ''):
        return []
    return [re.search(r'(\w+)(\[\d*\])?$', part.strip()).group(1) for part in text.split(',')]


def refers(comment):
    """Whether another function's text holds for this one."""
    return re.search(r'@brief\s+(The same|The mesh of the geom, by)|[a-z]\w*\(\)|This holds for|counterpart of',
                     ' '.join(comment.split())) is not None


def main():
    include, examples = (pathlib.Path(folder) for folder in sys.argv[1:3])
    called = '\n'.join(p.read_text() for p in sorted(examples.iterdir()) if p.suffix in ('.c', '.cpp', '.h'))
    missing, functions = [], 0
    for header in sorted(include.glob('*.h')):
        for match in DECLARATION.finditer(header.read_text()):
            functions += 1
            name, comment = match['name'], match['comment'] or ''
            text = re.sub(r'^\s*\*', '', comment, flags=re.M)

            def lacks(what, place=f'{header.name}: {name}'):
                missing.append(f'{place}: {what}')

            if not re.search(rf'\b{name}\b\s*[(;)]', called):
                lacks('no example calls it')
            for tag in ('@brief', '@ingroup'):
                if tag not in text:
                    lacks(f'no {tag}')
            names = argument_names(match['arguments'])
            result = match['type'].replace('const', '').strip()
            if result != 'void' and '@returns' not in text and not refers(text):
                lacks('no @returns')
            for argument in names:
                named = re.search(rf'@param\s+{argument}\b', text) or re.search(rf'\b{argument}\b', text)
                if len(names) > 1 and not named and not refers(text):
                    lacks(f'nothing about {argument}')
    if functions < 100:
        missing.append(f'only {functions} functions were found')
    for line in missing:
        print(line)
    print(f'{functions} functions, {len(missing)} gaps')
    return 1 if missing else 0


if __name__ == '__main__':
    sys.exit(main())
