"""What the documents show is true."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from pipeline import constants_page, site, site_hooks

from hfanalysis.record.definition import load_definition

REPOSITORY = Path(__file__).parents[2]


def test_the_documented_definition_is_valid(tmp_path: Path) -> None:
    text = (REPOSITORY / "docs" / "test-toml.md").read_text()
    example = re.search(r"```toml\n(.*?)```", text, re.DOTALL)
    assert example is not None
    folder = tmp_path / "HF5"
    folder.mkdir()
    (folder / "test.toml").write_text(example[1])
    (folder / "log.csv").write_text("Time (s),PT-TANK (psia),LC-THRUST (lbf)\n0,1,2\n1,2,3\n")
    assert set(load_definition(folder / "test.toml").channels) == {"p_tank", "thrust"}


def test_the_continuous_check_runs_the_test_command_of_the_readme() -> None:
    readme = (REPOSITORY / "README.md").read_text()
    assert re.search(r"^make test\b", readme, re.MULTILINE)
    assert re.search(r"^make test\b", (REPOSITORY / ".ci" / "run").read_text(), re.MULTILINE)


def test_links_between_documents_lead_somewhere() -> None:
    for document in [REPOSITORY / "README.md", *(REPOSITORY / "docs").rglob("*.md")]:
        for target in re.findall(r"\]\((?!https?:)([^)#]+)", document.read_text()):
            assert (document.parent / target).exists(), f"{document.name}: {target}"


@pytest.mark.parametrize(
    ("html", "count"),
    [
        ('<script src="https://x.org/a.js"></script>', 1),
        ('<script src="assets/a.js"></script><img src="hf5.png">', 0),
        ('<link rel="stylesheet" href="//fonts.org/a.css">', 1),
        ('<link rel="canonical" href="https://x.org/">', 0),
        ('<a href="https://x.org/">a source</a>', 0),
    ],
)
def test_what_a_page_loads_from_elsewhere_is_found(html: str, count: int) -> None:
    assert len(list(site.from_elsewhere(html))) == count


def test_equations_of_pages_become_mathml_and_files_of_the_repository_names() -> None:
    made = site_hooks.on_page_markdown("$$ \\frac{a}{b} $$\n[a stage](../CONTRIBUTING.md#a-stage), [page](files.md)")
    assert made.startswith("<math")
    assert "<mfrac>" in made
    assert made.endswith("a stage, [page](files.md)")


def test_every_page_has_its_place() -> None:
    navigation = (REPOSITORY / "mkdocs.yml").read_text()
    docs = REPOSITORY / "docs"
    pages = {path.relative_to(docs).as_posix() for path in docs.rglob("*.md")}
    assert set(re.findall(r"[\w/-]+\.md", navigation.partition("\nnav:")[2])) == pages


@pytest.mark.parametrize("path", sorted(REPOSITORY.glob("requirements*.lock")), ids=lambda path: path.name)
def test_a_lock_file_names_no_place(path: Path) -> None:
    lock = path.read_text()
    assert "://" not in lock
    assert "--hash=sha256:" in lock
    assert not re.search(r"(?m)^(-|.*\s@\s|.*file:|#.*/)", lock)


def test_the_ledger_of_constants_is_that_of_the_source() -> None:
    written = constants_page.PAGE.read_text(encoding="utf-8")
    assert written == constants_page.page(constants_page.constants()), "`make readme` writes it"
