# SPDX-License-Identifier: BSD-3-Clause
"""Every page of the site in headless Chromium, as wide as a desktop and as a phone: check_pages.py FOLDER [PICTURES]

Fails where a page scrolls sideways, where a picture is broken, and where a page does not load. Writes a picture of each
page into the folder PICTURES, if one is given. Does nothing, with a message, where there is no Chromium."""
import functools
import html
import http.server
import json
import pathlib
import re
import sys
import tempfile
import threading

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests" / "robustness" / "viewer"))
import browser  # noqa: E402  # which the line above lets it find

SIZES = {"desktop": (1280, 900), "phone": (390, 844)}
# Loads one page after the other into a frame of the wanted size, and measures it there.
PROBE = """<!doctype html><body style="margin:0"><pre id="found"></pre><script>
const pages = %s, sizes = %s, found = [];
const load = (frame, url) => new Promise((done) => { frame.onload = done; frame.src = url; });
(async () => {
  for (const [name, [width, height]] of Object.entries(sizes)) {
    for (const page of pages) {
      const frame = document.body.appendChild(document.createElement("iframe"));
      frame.style.cssText = `border:0;width:${width}px;height:${height}px`;
      await load(frame, "/" + page);
      const inside = frame.contentDocument, root = inside.documentElement;
      const say = (fault) => found.push(`${page} (${name}): ${fault}`);
      if (!inside.title) say("no title");
      if (root.scrollWidth > width) {
        const wide = [...inside.querySelectorAll("article *")].find((e) => e.getBoundingClientRect().right > width + 1);
        say(`${root.scrollWidth} pixels wide` + (wide ? ", by " + wide.outerHTML.slice(0, 80) : ""));
      }
      for (const picture of inside.images) {
        if (!picture.complete || picture.naturalWidth === 0) say("broken picture " + picture.getAttribute("src"));
      }
      frame.remove();
    }
  }
  document.getElementById("found").textContent = JSON.stringify(found);
})();
</script>"""


class Quiet(http.server.SimpleHTTPRequestHandler):
    def __init__(self, probe, *args, **words):
        self.probe = probe
        super().__init__(*args, **words)

    def do_GET(self):
        if self.path != "/probe":
            super().do_GET()
            return
        self.send_response(200)
        self.send_header("Content-Type", "text/html; charset=utf-8")
        self.end_headers()
        self.wfile.write(self.probe.encode())

    def log_message(self, *args):
        pass


def faults_of(root, pages):
    probe = PROBE % (json.dumps(pages), json.dumps(SIZES))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, probe, directory=root)) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        dom, console = browser.visit("http://127.0.0.1:%d/probe" % server.server_port,
                                     "--virtual-time-budget=600000", "--dump-dom", size=SIZES["desktop"])
        server.shutdown()
    text = html.unescape(re.search(r'id="found">([^<]*)<', dom).group(1))
    assert text, "the browser did not come to the last page\n" + "\n".join(console)
    return json.loads(text)


def self_test():
    """A wide page, a broken picture and a page without a title are found."""
    with tempfile.TemporaryDirectory() as folder:
        good = "<title>good</title><meta name=viewport content='width=device-width'><h1>good</h1>"
        for name, content in (("good.html", good),
                              ("wide.html", good + "<article><div style='width:700px'>wide</div></article>"),
                              ("broken.html", good + "<img src='none.png'>"), ("empty.html", "")):
            (pathlib.Path(folder) / name).write_text("<!doctype html>" + content)
        found = faults_of(folder, sorted(path.name for path in pathlib.Path(folder).iterdir()))
    expected = {"wide.html (phone)", "broken.html (phone)", "broken.html (desktop)", "empty.html (phone)",
                "empty.html (desktop)"}
    assert {fault.split(":")[0] for fault in found} == expected, found


def main():
    if browser.find() is None:
        print("Pages were not looked at: there is no Chromium (scripts/install_dependencies.sh viewer)",
              file=sys.stderr)
        return 0
    self_test()
    root = pathlib.Path(sys.argv[1]).resolve()
    pages = sorted(str(page.relative_to(root)) for page in root.rglob("*.html") if "_static" not in page.parts)
    assert len(pages) > 30, pages
    if len(sys.argv) > 2:
        pictures = pathlib.Path(sys.argv[2])
        pictures.mkdir(parents=True, exist_ok=True)
        for name, size in SIZES.items():
            for page in pages:
                picture = pictures / ("%s_%s.png" % (page.replace("/", "_")[:-5], name))
                browser.screenshot((root / page).as_uri(), str(picture), size=size)
    found = faults_of(str(root), pages)
    print("\n".join(found), file=sys.stderr)
    print("%d pages at %s" % (len(pages), " and ".join("%d pixels" % width for width, _ in SIZES.values())))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
