# SPDX-License-Identifier: BSD-3-Clause
"""A page in headless Chromium, and its pictures as lists of numbers. Needs Chromium, and of Python only itself."""
import os
import re
import shutil
import struct
import subprocess
import tempfile
import zlib


def find():
    """The path of the browser, or None."""
    return next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


def visit(url, *options, size=(640, 400)):
    """Runs the browser on a page until it is at rest; returns (stdout, messages of the page's console)."""
    with tempfile.TemporaryDirectory() as profile:
        run = subprocess.run(
            [find(), "--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
             "--disable-dev-shm-usage", "--hide-scrollbars", "--force-device-scale-factor=1", "--enable-logging=stderr",
             "--user-data-dir=" + profile, "--window-size=%d,%d" % size, "--virtual-time-budget=5000", *options, url],
            capture_output=True, text=True, timeout=240, env={**os.environ, "HOME": profile})
    if run.returncode != 0:
        raise RuntimeError("the browser failed:\n" + run.stderr[-2000:])
    return run.stdout, re.findall(r":CONSOLE[:(].*", run.stderr)


def screenshot(url, path, size=(640, 400)):
    return visit(url, "--screenshot=" + path, size=size)[1]


def read_png(path):
    """(width, height, rows of bytes with three for each pixel) of an 8-bit PNG without interlacing."""
    with open(path, "rb") as file:
        data = file.read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", path
    place, packed = 8, b""
    while place < len(data):
        length, kind = struct.unpack_from(">I4s", data, place)
        content = data[place + 8:place + 8 + length]
        if kind == b"IHDR":
            width, height, bits, color, _, _, interlace = struct.unpack(">IIBBBBB", content)
            assert (bits, interlace) == (8, 0) and color in (2, 6), path
        elif kind == b"IDAT":
            packed += content
        place += 12 + length
    channels = 3 if color == 2 else 4
    stride = width * channels
    raw, rows, before = zlib.decompress(packed), [], bytearray(stride)
    for y in range(height):
        kind, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            left = line[i - channels] if i >= channels else 0
            up, corner = before[i], before[i - channels] if i >= channels else 0
            if kind == 1:
                line[i] = (line[i] + left) & 255
            elif kind == 2:
                line[i] = (line[i] + up) & 255
            elif kind == 3:
                line[i] = (line[i] + (left + up) // 2) & 255
            elif kind == 4:
                guess = left + up - corner
                nearest = min((left, up, corner), key=lambda value: abs(guess - value))
                line[i] = (line[i] + nearest) & 255
        before = line
        rows.append(bytes(b for i, b in enumerate(line) if i % channels < 3))
    return width, height, rows


def blocks(image, side=8):
    """Mean colours of squares of pixels, row by row."""
    width, height, rows = image
    result = []
    for y in range(0, height - side + 1, side):
        for x in range(0, width - side + 1, side):
            for channel in range(3):
                total = sum(sum(rows[y + j][3 * x + channel:3 * (x + side):3]) for j in range(side))
                result.append(total / side ** 2)
    return result


def difference(a, b):
    """(share of squares that differ by more than 12 of 255, mean difference) of two images of one size. Edges that are
    drawn a pixel aside, other fonts and other smoothing make little of it."""
    first, second = blocks(a), blocks(b)
    assert a[:2] == b[:2] and len(first) == len(second)
    differences = [abs(x - y) for x, y in zip(first, second, strict=True)]
    return sum(d > 12 for d in differences) / len(differences), sum(differences) / len(differences)
