"""The documentation as a site: `make docs`. Fails at a warning of the builder, a dead link or anchor, and where a page
would load something from elsewhere; links to elsewhere are listed."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SITE = ROOT / "site"

LOADED = re.compile(
    r'<(?:script|img|iframe|source|audio|video)\b[^>]*?\bsrc="(https?:)?//[^"]*"|<link\b[^>]*>', re.IGNORECASE
)
FETCHED = ("stylesheet", "preload", "prefetch", "preconnect", "icon", "modulepreload")
LINK = re.compile(r'<a\b[^>]*\bhref="(https?://[^"]+)"', re.IGNORECASE)


def from_elsewhere(html: str) -> Iterator[str]:
    """What a page would load from another place than the site.

    >>> list(from_elsewhere('<script src="https://x.org/a.js"></script><img src="a.png">'))
    ['<script src="https://x.org/a.js"']
    """
    for found in LOADED.finditer(html):
        text = found[0]
        if not text.lower().startswith("<link") or (
            re.search(r'href="(https?:)?//', text) and any(f'rel="{kind}' in text for kind in FETCHED)
        ):
            yield text


def main() -> None:
    """Build, then look at what was built."""
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--clean", "--site-dir", str(SITE)]
    quiet = {**os.environ, "NO_MKDOCS_2_WARNING": "1"}
    built = subprocess.run(command, cwd=ROOT, env=quiet, capture_output=True, text=True, check=False)
    sys.stderr.writelines(line for line in built.stderr.splitlines(keepends=True) if not line.startswith("INFO"))
    pages = (
        {path: path.read_text(encoding="utf-8") for path in sorted(SITE.rglob("*.html"))}
        if not built.returncode
        else {}
    )
    fetched = [f"{path.relative_to(ROOT)}: {text}" for path, html in pages.items() for text in from_elsewhere(html)]
    print("\n".join(fetched), end="\n" if fetched else "")
    outward = sorted({link for html in pages.values() for link in LINK.findall(html)})
    print(f"{len(pages)} pages in {SITE.relative_to(ROOT)}/; links to elsewhere: {', '.join(outward) or 'none'}")
    sys.exit(1 if built.returncode or fetched else 0)


if __name__ == "__main__":
    main()
