#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""press_keys.py SECONDS: presses the space bar a few times, then holds "a", on the X display of the environment."""
import ctypes
import sys
import time

x11, xtest = ctypes.CDLL('libX11.so.6'), ctypes.CDLL('libXtst.so.6')
x11.XOpenDisplay.restype = ctypes.c_void_p
x11.XKeysymToKeycode.argtypes = [ctypes.c_void_p, ctypes.c_ulong]
x11.XFlush.argtypes = [ctypes.c_void_p]
xtest.XTestFakeKeyEvent.argtypes = [ctypes.c_void_p, ctypes.c_uint, ctypes.c_int, ctypes.c_ulong]
display = x11.XOpenDisplay(None)
if not display:
    sys.exit('no X display')


def key(symbol, down):
    xtest.XTestFakeKeyEvent(display, x11.XKeysymToKeycode(display, ord(symbol)), down, 0)
    x11.XFlush(display)


end, presses = time.time() + float(sys.argv[1]), 0
while time.time() < end:
    if presses < 8:
        key(' ', 1)
        time.sleep(0.1)
        key(' ', 0)
    else:
        key('a', 1)
    presses += 1
    time.sleep(1)
