#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""No sources that need each other: prints every cycle of includes and ends with 1 if there is one.

    include_cycles.py ROOT                checks the tree at ROOT
    include_cycles.py --self-test DIR     makes small trees below DIR, with and without a cycle, and expects them
                                          distinguished

A header and the sources of the same name in the same folder are one unit, NAME_impl.h among them, so that a source that
includes what includes its header is a cycle, too. Inside layers as between them. The same of the folders of a layer:
what lies beside them in the layer is no folder.
"""
import pathlib
import re
import shutil
import sys

FOLDERS = ('ode_trimesh_gpu', 'kernels', 'harness', 'benchmarks', 'demos', 'tests', 'examples')
# Where an include may begin, as the build has it. Kernels see kernels/ alone.
ROOTS = ('ode_trimesh_gpu', 'ode_trimesh_gpu/include', 'kernels', 'harness', 'benchmarks', 'demos', 'tests')
ENDINGS = ('.h', '.hpp', '.c', '.cpp', '.cl')
INCLUDE = re.compile(r'^\s*#\s*include\s+["<]([^">]+)[">]', re.M)


def unit_of(path):
    """The path without its ending, and without what a second file of the unit has besides."""
    return re.sub(r'_impl$', '', str(path.with_suffix('')))


def resolve(root, file, name):
    """The file that `file` means by `name`, below `root`; None if it is none of the project's."""
    roots = ('kernels',) if file.parts[0] == 'kernels' else ROOTS
    for place in (file.parent, *(pathlib.Path(r) for r in roots)):
        if (root / place / name).is_file():
            return place / name
    return None


def graph_of(root):
    """For each unit the units that it includes, each with the line's file."""
    graph = {}
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob('*')):
            if path.suffix not in ENDINGS:
                continue
            file = path.relative_to(root)
            edges = graph.setdefault(unit_of(file), {})
            for name in INCLUDE.findall(path.read_text(errors='replace')):
                found = resolve(root, file, name)
                if found is not None and unit_of(found) != unit_of(file):
                    edges.setdefault(unit_of(found), str(file))
    return graph


def components(graph):
    """The strongly connected components of more than one unit (Tarjan's algorithm, without recursion)."""
    number, low, stack, on_stack, found = {}, {}, [], set(), []
    for start in graph:
        if start in number:
            continue
        work = [(start, iter(graph[start]))]
        number[start] = low[start] = len(number)
        stack.append(start)
        on_stack.add(start)
        while work:
            unit, rest = work[-1]
            following = next((n for n in rest if n in graph), None)
            if following is None:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[unit])
                if low[unit] == number[unit]:
                    cut = stack.index(unit)
                    if len(stack) - cut > 1:
                        found.append(stack[cut:])
                    on_stack.difference_update(stack[cut:])
                    del stack[cut:]
            elif following not in number:
                work.append((following, iter(graph[following])))
                number[following] = low[following] = len(number)
                stack.append(following)
                on_stack.add(following)
            elif following in on_stack:
                low[unit] = min(low[unit], number[following])
    return found


def folders_of(graph):
    """The same graph of the folders of layers. A layer is a folder of the first two names."""
    folders = {}
    for unit, edges in graph.items():
        here = unit.rsplit('/', 1)[0]
        for other, file in edges.items():
            there = other.rsplit('/', 1)[0]
            in_one_layer = here.split('/')[:2] == there.split('/')[:2] and min(here.count('/'), there.count('/')) >= 2
            folders.setdefault(here, {})
            folders.setdefault(there, {})
            if in_one_layer and here != there:
                folders[here].setdefault(there, file)
    return folders


def check(root):
    """One paragraph for each cycle: its units, and which line of which file leads from one to the next."""
    graph = graph_of(root)
    reports = []
    for what, nodes in (('units', graph), ('folders', folders_of(graph))):
        for units in components(nodes):
            lines = [f'{len(units)} {what} include each other:']
            for unit in sorted(units):
                lines += [f'  {file} includes {other}' for other, file in sorted(nodes[unit].items()) if other in units]
            reports.append('\n'.join(lines))
    return reports, len(graph)


def self_test(directory):
    shutil.rmtree(directory, ignore_errors=True)

    def tree(name, files):
        for path, includes in files.items():
            place = directory / name / path
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_text(''.join(f'#include "{i}"\n' for i in includes))
        return check(directory / name)[0]

    lib = 'ode_trimesh_gpu/'
    clean = tree('clean', {lib + 'mesh/a.h': [], lib + 'mesh/a.cpp': ['mesh/a.h', 'mesh/b.h'], lib + 'mesh/b.h': [],
                           'kernels/shared/a.h': [], 'kernels/walk/a.cl': ['shared/a.h']})
    headers = tree('headers', {lib + 'mesh/a.h': ['mesh/b.h'], lib + 'bvh/c.h': ['mesh/a.h'],
                               lib + 'mesh/b.h': ['bvh/c.h']})
    source = tree('source', {lib + 'ode/a.h': [], lib + 'ode/a.cpp': ['ode/a.h', 'ode/b.h'],
                             lib + 'ode/b.h': ['ode/a.h']})
    kernels = tree('kernels', {'kernels/a.h': ['b.h'], 'kernels/b.h': ['a.h']})
    folders = tree('folders', {lib + 'ode/a/a.h': ['ode/b/b.h'], lib + 'ode/b/b.h': [],
                               lib + 'ode/b/c.h': ['ode/a/d.h'], lib + 'ode/a/d.h': []})
    wanted = [(clean, None), (headers, '3 units'), (source, '2 units'), (kernels, '2 units'), (folders, '2 folders')]
    return [reports for reports, begin in wanted
            if len(reports) != (begin is not None) or (begin and not reports[0].startswith(begin))]


def main():
    if sys.argv[1] == '--self-test':
        wrong = self_test(pathlib.Path(sys.argv[2]))
        for reports in wrong:
            print('self-test: not as expected:', reports)
        return 1 if wrong else 0
    reports, units = check(pathlib.Path(sys.argv[1]))
    if units < 100:
        reports.append(f'only {units} units were found')
    for report in reports:
        print(report)
    return 1 if reports else 0


sys.exit(main())
