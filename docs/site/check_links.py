# SPDX-License-Identifier: BSD-3-Clause
"""Every link from a page of the site to another page, picture or place in a page leads somewhere.

check_links.py FOLDER"""
import html
import pathlib
import re
import sys
import urllib.parse


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    pages = {page: page.read_text() for page in root.rglob("*.html")}
    places = {page: {html.unescape(name) for name in re.findall(r'\bid="([^"]+)"', text)}
              for page, text in pages.items()}
    seen, broken = 0, []
    for page, text in pages.items():
        for link in map(html.unescape, re.findall(r'(?:href|src)="([^"]+)"', text)):
            if re.match(r"[a-z]+:|//", link):
                continue
            seen += 1
            path, _, place = urllib.parse.unquote(link).partition("#")
            target = (page.parent / path.split("?")[0]).resolve() if path else page
            if not target.exists() or (place and target in places and place not in places[target]):
                broken.append("%s: %s" % (page.relative_to(root), link))
    assert seen > 1000, seen
    print("\n".join(broken), file=sys.stderr)
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
