"""What the documents show is true."""

from __future__ import annotations

import re
from pathlib import Path

from pipeline import constants_page

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
    for document in [REPOSITORY / "README.md", *(REPOSITORY / "docs").glob("*.md")]:
        for target in re.findall(r"\]\((?!https?:)([^)#]+)", document.read_text()):
            assert (document.parent / target).exists(), f"{document.name}: {target}"


def test_the_lock_file_names_no_place() -> None:
    lock = (REPOSITORY / "requirements.lock").read_text()
    assert "://" not in lock
    assert "--hash=sha256:" in lock
    assert not re.search(r"(?m)^(-|.*\s@\s|.*file:|#.*/)", lock)


def test_the_ledger_of_constants_is_that_of_the_source() -> None:
    written = constants_page.PAGE.read_text(encoding="utf-8")
    assert written == constants_page.page(constants_page.constants()), "`make readme` writes it"
