"""Tests make docs: the site is complete, and every link inside it leads somewhere.

Every run reads the guides and the datasheets, and resolves their links. ALL=1 builds the whole
site, with a page for each package and each file that a guide links to.
"""

import html
import inspect
import re
import sys
from html.parser import HTMLParser
from importlib import import_module
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest
from shared import Shared, run
from test_census import BLOCKS, ROOT
from test_make import here


class Page(HTMLParser):
    """The anchors of a page, and its links."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: set[str] = set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name in ("id", "name") and value:
                self.anchors.add(value)
            elif name in ("href", "src") and value:
                self.links.add(value)


def broken_links(site: Path) -> list[str]:
    """Every link to a missing file or anchor. Links to other sites are left out."""
    pages = {path.resolve(): Page(path) for path in sorted(site.rglob("*.html"))}
    found = []
    for path, page in pages.items():
        for link in sorted(page.links):
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            missing = not target.is_file() or not target.is_relative_to(site.resolve())
            anchor = unquote(parts.fragment)
            if missing or (anchor and anchor not in pages[target].anchors):
                found.append(f"{path.relative_to(site.resolve())}: {link}")
    return found


def test_every_guide_can_be_read_and_its_links_lead_somewhere(tmp_path: Path) -> None:
    """No page is written, and the pages of packages, which take most of the time, are left out."""
    left_out = ["exclude_patterns=extensions,api/*", "suppress_warnings=toc.excluded"]
    settings = [word for setting in left_out for word in ("-D", setting)]
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "dummy"]
    places = ["-d", tmp_path / "doctrees", ROOT / "docs", tmp_path / "site"]
    result = run(*command, *places, *settings)
    assert result.returncode == 0, result.stderr


@pytest.mark.all_only
def test_the_site_is_complete_and_every_link_leads_somewhere(shared: Shared) -> None:
    (Path(sys.prefix) / ".ready").touch()
    site = shared.folder / "docs" / "site"
    result = here("docs", f"SITE={site}")
    assert result.returncode == 0, result.stderr
    assert [path.name for path in site.parent.iterdir()] == ["site"]
    assert not broken_links(site)
    start = Page(site / "index.html")
    assert "the-blocks" in start.anchors
    for guide in (ROOT / "docs").glob("*.md"):
        assert (site / f"{guide.stem}.html").is_file()
        assert f"{guide.stem}.html" in start.links or guide.stem == "index"
    slips = (site / "slips.html").read_text(encoding="utf-8")
    assert "sigma_6 = 0.633" in slips
    for path in site.rglob("*"):
        if path.is_file():
            content = path.read_bytes()
            assert str(ROOT).encode() not in content, path
            assert str(site.parent).encode() not in content, path
    for area, block in BLOCKS:
        has_ports_and_docstring(site, area, block)


def has_ports_and_docstring(site: Path, area: str, block: str) -> None:
    """A function with MyHDL's decorator still has its signature."""
    text = (site / "api" / f"hdl.{area}.html").read_text(encoding="utf-8")
    entry = re.search(rf'id="hdl\.{area}\.{block}\.{block}">(.*?)</dt>(.*?)</dd>', text, re.S)
    assert entry, block
    hardware = getattr(import_module(f"hdl.{area}.{block}"), block)
    for name in inspect.signature(hardware).parameters:
        assert f'<span class="pre">{name}</span>' in entry[1]
    summary = html.unescape(re.sub("<.*?>", "", entry[2]))
    first = (inspect.getdoc(hardware) or "").replace("`", "").split()
    assert " ".join(first[:3]) in " ".join(summary.split())
