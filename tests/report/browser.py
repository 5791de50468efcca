"""A small client of Chromium's DevTools protocol over a pipe: open a page, look at it, use mouse and keyboard."""

from __future__ import annotations

import base64
import contextlib
import fcntl
import itertools
import json
import os
import select
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")

_OPTIONS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
    "--hide-scrollbars",
    "--host-resolver-rules=MAP * ~NOTFOUND",
    "--remote-debugging-pipe",
)

_PATIENCE = 60.0
"""[s] that a command may take on a busy machine."""

KEYS = {"ArrowLeft": 37, "ArrowRight": 39, "Home": 36, "End": 35, "Tab": 9, "Enter": 13, "Escape": 27}


class Page:
    """One tab. ``console`` and ``requests`` hold what the page complained of and asked for."""

    def __init__(self, to: int, back: int) -> None:
        self._to, self._back, self._numbers, self._rest = to, back, itertools.count(1), b""
        self._session: str | None = None
        self.console: list[str] = []
        self.requests: list[str] = []
        self._loaded = self.scriptless = False
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log", "DOM"):
            self.call(f"{domain}.enable")

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """A command and its answer."""
        number = next(self._numbers)
        message = {"id": number, "method": method, "params": parameters}
        message |= {"sessionId": self._session} if self._session else {}
        os.write(self._to, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._next()
            if answer.get("id") == number:
                assert "error" not in answer, f"{method}: {answer['error']}"
                return dict(answer["result"])

    def _next(self) -> dict[str, Any]:
        until = time.monotonic() + _PATIENCE
        while b"\0" not in self._rest:
            ready, _, _ = select.select([self._back], [], [], max(0.0, until - time.monotonic()))
            assert ready, "the browser does not answer"
            chunk = os.read(self._back, 1 << 20)
            assert chunk, "the browser has gone"
            self._rest += chunk
        text, _, self._rest = self._rest.partition(b"\0")
        message: dict[str, Any] = json.loads(text)
        self._note(message.get("method", ""), message.get("params", {}))
        return message

    def _note(self, method: str, about: dict[str, Any]) -> None:
        if method == "Page.loadEventFired":
            self._loaded = True
        elif method == "Runtime.exceptionThrown":
            self.console.append(str(about["exceptionDetails"]))
        elif method == "Runtime.consoleAPICalled":
            self.console.append(str(about["args"]))
        elif method == "Log.entryAdded":
            self.console.append(str(about["entry"]["text"]))
        elif method == "Network.requestWillBeSent":
            self.requests.append(str(about["request"]["url"]))

    def open(self, path: Path, width: int = 1200, height: int = 900, **features: str) -> Page:
        """Load a file in a window of this size; ``features`` such as ``prefers_color_scheme="dark"``."""
        self.size(width, height)
        self.media("", **features)
        self._loaded = False
        self.call("Page.navigate", url=path.as_uri())
        while not self._loaded:
            self._next()
        if not self.scriptless:
            self.settle()
        return self

    @contextlib.contextmanager
    def without_script(self) -> Iterator[Page]:
        """Pages opened within the block run no script of their own."""
        self.scriptless = True
        self.call("Emulation.setScriptExecutionDisabled", value=True)
        try:
            yield self
        finally:
            self.scriptless = False
            self.call("Emulation.setScriptExecutionDisabled", value=False)

    def size(self, width: int, height: int = 900) -> None:
        """The window's size [px]."""
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def media(self, kind: str, **features: str) -> None:
        """Show the page as ``kind`` ("print", "" for the screen) and with preferred features."""
        wanted = [{"name": name.replace("_", "-"), "value": value} for name, value in features.items()]
        self.call("Emulation.setEmulatedMedia", media=kind, features=wanted)

    def settle(self) -> None:
        """Wait until what was asked for has been drawn."""
        frames = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(0))))"
        self.ask(frames)
        self.ask("(async () => { while ('busy' in document.documentElement.dataset) await " + frames + " })()")

    def ask(self, expression: str) -> Any:
        """The value of an expression of the page."""
        found = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def forget(self) -> None:
        """Clear what pages have stored; all files share it, and the empty first page has none."""
        self.ask("if (location.protocol === 'file:') localStorage.clear()")

    def mouse(self, kind: str, x: float, y: float, **more: Any) -> None:
        """An event of the mouse at a place of the window: mouseMoved, mousePressed, mouseReleased, mouseWheel."""
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def click(self, x: float, y: float, count: int = 1) -> None:
        """Click the left button; ``count`` 2 is a double click."""
        for number in range(1, count + 1):
            for kind in ("mousePressed", "mouseReleased"):
                self.mouse(kind, x, y, button="left", clickCount=number)
        self.settle()

    def drag(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """Drag with the left button."""
        self.mouse("mouseMoved", *start)
        self.mouse("mousePressed", *start, button="left", buttons=1, clickCount=1)
        for share in (0.3, 0.7, 1.0):
            self.mouse("mouseMoved", *(a + share * (b - a) for a, b in zip(start, end, strict=True)), buttons=1)
        self.mouse("mouseReleased", *end, button="left", clickCount=1)
        self.settle()

    def press(self, key: str) -> None:
        """Press a key."""
        text = {"text": key} if len(key) == 1 else {}
        code = KEYS.get(key, ord(key[0].upper()))
        self.call("Input.dispatchKeyEvent", type="keyDown", key=key, windowsVirtualKeyCode=code, **text)
        self.call("Input.dispatchKeyEvent", type="keyUp", key=key, windowsVirtualKeyCode=code)
        self.settle()

    def show(self, selector: str) -> tuple[float, float, float, float]:
        """Scroll an element into view; returns its left, top, width and height in the window."""
        box = f"document.querySelector({json.dumps(selector)})"
        self.ask(f"{box}.scrollIntoView({{block: 'center', behavior: 'instant'}})")
        self.settle()
        found = self.ask(
            f"(() => {{ const b = {box}.getBoundingClientRect(); return [b.x, b.y, b.width, b.height] }})()"
        )
        return tuple(found)

    def picture(self, path: Path, whole: bool = True) -> Path:
        """A screenshot, of the whole page or of the window."""
        found = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=whole)
        path.write_bytes(base64.b64decode(found["data"]))
        return path

    def printed(self, path: Path) -> Path:
        """The page as PDF on A4."""
        found = self.call("Page.printToPDF", paperWidth=8.27, paperHeight=11.69, printBackground=True)
        path.write_bytes(base64.b64decode(found["data"]))
        return path


_AS_3_AND_4 = (
    "import os, sys; to, back, *c = sys.argv[1:]; os.dup2(int(to), 3); os.dup2(int(back), 4); os.execv(c[0], c)"
)
"""Chromium reads commands from descriptor 3 and answers on 4."""


def _moved_up(descriptor: int) -> int:
    """The descriptor under a number out of the way of 3 and 4."""
    moved = fcntl.fcntl(descriptor, fcntl.F_DUPFD, 10)
    os.close(descriptor)
    return moved


@contextlib.contextmanager
def browser(profile: Path) -> Iterator[Page]:
    """A tab in a Chromium of its own, which ends with the block."""
    to_read, to_write = os.pipe()
    back_read, back_write = os.pipe()
    to_read, back_write = _moved_up(to_read), _moved_up(back_write)
    command = [str(CHROMIUM), *_OPTIONS, f"--user-data-dir={profile}", "about:blank"]
    process = subprocess.Popen(
        [sys.executable, "-c", _AS_3_AND_4, str(to_read), str(back_write), *command],
        pass_fds=(to_read, back_write),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    os.close(to_read)
    os.close(back_write)
    try:
        yield Page(to_write, back_read)
    finally:
        os.close(to_write)
        os.close(back_read)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGTERM)
        process.wait(timeout=30)
