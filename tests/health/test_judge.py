"""What findings make of channels, and which findings may do what."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.health import fire

from hfanalysis.health import judge as judging
from hfanalysis.health.judge import judge
from hfanalysis.health.seen import SeenTest, Sister, look
from hfanalysis.products.health import Finding, Health


def finding(verdict: Any, *channels: str, **about: Any) -> Finding:
    """Something found of these channels."""
    said = {"kind": "zero", "evidence": "it reads 76 N", "means": "its zero has moved", "cure": None}
    return Finding(**{**said, "verdict": verdict, "channels": channels, **about})


def given(monkeypatch: pytest.MonkeyPatch, room: str, *found: Finding) -> None:
    """A room whose only detector finds just this."""

    def find(test: SeenTest) -> list[Finding]:
        return list(found)

    monkeypatch.setattr(judging, room, SimpleNamespace(detectors=lambda: {"made_up": find}))


def test_a_healthy_firing_has_no_findings(tmp_path: Path) -> None:
    health = judge(*fire.ingested(tmp_path, fire.columns()))
    assert {name: channel.verdict for name, channel in health.channels.items()} == dict.fromkeys(
        fire.CHANNELS, "healthy"
    )
    assert health.warnings == ()
    assert health.firing == pytest.approx((0.0, 8.0), abs=0.1)


def test_a_channel_is_as_bad_as_the_worst_of_its_findings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    given(monkeypatch, "kinds")
    given(monkeypatch, "ties", finding("suspect", "thrust"), finding("unusable", "thrust", "p_run", start=1.0))
    health = judge(*fire.ingested(tmp_path, fire.columns()))
    assert [health.of(name).verdict for name in ("thrust", "p_run", "p_tank")] == ["unusable", "unusable", "healthy"]
    assert len(health.of("thrust").findings) == len(health.between) == 2


def test_other_tests_only_ever_make_suspect(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    log, definition = fire.ingested(tmp_path, fire.columns())
    sister = Sister(definition, {name: seen.coarse for name, seen in look(log, definition).channels.items()})
    given(monkeypatch, "kinds")
    given(monkeypatch, "ties")
    given(monkeypatch, "stand", finding("unusable", "thrust", kind="scale"))
    assert judge(log, definition, [sister]).of("thrust").verdict == "suspect"
    assert judge(log, definition).of("thrust").verdict == "healthy"


def test_the_engineer_has_the_last_word(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    given(monkeypatch, "kinds")
    given(monkeypatch, "ties", finding("unusable", "thrust"))
    text = fire.toml(thrust='trust = "checked on a dead weight"')
    health = judge(*fire.ingested(tmp_path, fire.columns(), text))
    assert health.of("thrust").verdict == "healthy"
    assert health.of("thrust").findings[0].overruled
    assert health.between[0].overruled
    assert "checked on a dead weight" in health.warnings[0]


def test_a_health_comes_back_from_json_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    given(monkeypatch, "kinds")
    given(monkeypatch, "ties", finding("suspect", "thrust", bias=20.0, start=1.0))
    health = judge(*fire.ingested(tmp_path, fire.columns()))
    assert Health.from_json(health.to_json()) == health


def test_a_gauge_that_wakes_late_does_not_date_the_firing(tmp_path: Path) -> None:
    columns = fire.columns()
    late = columns["time"] < 4.0
    columns["p_chamber"][late] = fire.columns(1)["p_chamber"][: late.sum()].mean()
    log, definition = fire.ingested(tmp_path, columns)
    found = look(log, definition).fire
    assert found is not None
    assert found[0] == pytest.approx(0.0, abs=0.1)


def test_of_two_firings_the_one_that_the_phases_take_is_judged(tmp_path: Path) -> None:
    read = fire.columns()
    later = {name: np.concatenate([values, values]) for name, values in read.items()}
    later["time"] = np.concatenate([read["time"], read["time"] + 20.0])
    spans = []
    for text in (fire.toml(), fire.toml().replace("[log]", "[log]\nfiring = 2", 1)):
        spans.append(look(*fire.ingested(tmp_path / str(len(spans)), later, text)).fire)
    assert spans[0] == pytest.approx((0.0, 8.0), abs=0.3)
    assert spans[1] == pytest.approx((20.0, 28.0), abs=0.3)
