#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes README's animation: steps a demo's scene, has headless Chromium draw frames of its page, and joins them.

    python3 scripts/readme_animation.py [docs/pictures/falling.webp]

Needs build/bin/otg with three.js, and Debian's packages chromium and webp."""
import base64
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "robustness" / "viewer"))
import browser  # noqa: E402  # which the line above lets it find

SIZE, DURATION, FRAMES_PER_SECOND = (640, 400), 2.6, 15
# Runs behind the page: the canvas fills the window, and each frame becomes a picture in the document.
DRAW = """<script>
document.body.style.display = "block";
document.getElementById("stage").style.cssText = "width: %dpx; height: %dpx";
viewer.play(false);
viewer.sized = false;
viewer.resize();
viewer.camera.position.lerp(viewer.center, 0.22);
viewer.controls.update();
const frames = [];
for (let i = 0; i < %d; ++i) {
  viewer.seek(i / %d);
  frames.push(document.getElementById("scene").toDataURL("image/png").split(",")[1]);
}
const list = document.createElement("pre");
list.id = "frames";
list.textContent = frames.join(" ");
document.body.append(list);
</script></body>"""


def main():
    target = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "docs" / "pictures" / "falling.webp")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scene = ROOT / "demos" / "falling_meshes" / "falling_lumps.json"
        subprocess.run([ROOT / "build" / "bin" / "otg", "simulate", scene, "--steps", str(int(DURATION / 0.004) + 10),
                        "--html", folder / "run.html"], check=True, stdout=subprocess.DEVNULL)
        page = (folder / "run.html").read_text()
        head, tail = page.rsplit("</body>", 1)
        count = int(DURATION * FRAMES_PER_SECOND)
        (folder / "frames.html").write_text(head + DRAW % (*SIZE, count, FRAMES_PER_SECOND) + tail)
        dom, console = browser.visit("file://%s/frames.html#t=0" % folder, "--dump-dom", size=(800, 600))
        assert console == [], console
        frames = re.search(r'<pre id="frames">([^<]*)<', dom).group(1).split()
        assert len(frames) == count, len(frames)
        paths = []
        for number, frame in enumerate(frames):
            paths.append(folder / ("frame_%03d.png" % number))
            paths[-1].write_bytes(base64.b64decode(frame))
        delay = str(round(1000 / FRAMES_PER_SECOND))
        subprocess.run(["img2webp", "-loop", "0", "-lossy", "-q", "70", "-m", "6", "-d", delay, *paths[:-1],
                        "-d", "1500", paths[-1], "-o", target], check=True, stdout=subprocess.DEVNULL)
    print("%s: %d frames, %.0f kB" % (target, count, target.stat().st_size / 1000))


if __name__ == "__main__":
    main()
