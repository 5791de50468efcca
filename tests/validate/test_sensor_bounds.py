"""What thrust, chamber pressure and tank cell may say before they are doubted, by equilibrium and by weighing."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from tests.segment.stand import AMBIENT, THROAT, Trial, channel, definition, fire, log_of, segments_of

from hfanalysis.engine.thrust_coefficient import GAMMAS
from hfanalysis.quantity import Quantity
from hfanalysis.record.sections import GrainSection
from hfanalysis.thermo.combustion import Gas, equilibrium
from hfanalysis.units import Value
from hfanalysis.validate.full import _cell_reads
from hfanalysis.validate.performance import Fire
from hfanalysis.validate.sensor_faults import _throat, findings

FIRE = Fire(9.0, 0.1, "video")


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=200.0)


@pytest.fixture(scope="module")
def gases() -> list[Gas]:
    """Nitrous oxide and paraffin from fuel-rich to lean at the pressures of small stands."""
    return [equilibrium(p, ratio) for p in (6e5, 30e5) for ratio in (3.0, 5.0, 7.0, 9.0)]


def test_heat_capacity_ratios_hold_those_of_the_burnt_gas(gases: list[Gas]) -> None:
    """Shifting ratios lie below the frozen ones, by a tenth at most."""
    frozen = [gas.gamma for gas in gases]
    assert GAMMAS[0] < min(frozen) < max(frozen) < GAMMAS[1]
    assert GAMMAS[0] > 0.9 * min(frozen)
    assert GAMMAS[1] < 1.1 * max(frozen)


def test_a_throat_that_is_not_stated_is_that_of_the_propellant_and_its_gas(burn: Trial, gases: list[Gas]) -> None:
    """A_t = m c* / integral of p_c dt, c* of what burns to nine tenths or whole: to a tenth."""
    grain, loaded = GrainSection(mass=Value(1.6)), burn.stand.mass
    found = _throat(log_of(burn), segments_of(burn), definition(burn.stand, nozzle=None, grain=grain), FIRE)
    assert found is not None
    area, relative, _ = found
    lit = (burn.time >= 0.0) & (burn.time <= FIRE.end)
    total = float(np.trapezoid(burn.values["p_chamber"][lit], burn.time[lit]))
    velocities = [share * gas.characteristic_velocity for gas in gases for share in (0.9, 1.0)]
    low, high = ((loaded + 1.6) * c / total for c in (min(velocities), max(velocities)))
    assert area == pytest.approx(np.sqrt(low * high), rel=0.1)
    assert relative == pytest.approx(0.25 * (high - low) / area, rel=0.35)


def verdicts(test: Trial, factor: float, std: float = 0.0) -> list[str]:
    """Where the thrust is this much of what a stated nozzle gives."""
    log, stated = log_of(test), definition(test.stand)
    assert stated.nozzle is not None
    nozzle = replace_radius(stated, std)
    off = replace(log["thrust"], values=factor * log["thrust"].values)
    found = findings(replace(log, channels={**log.channels, "thrust": off}), segments_of(test), nozzle, FIRE)
    return [f.verdict for f in found]


def replace_radius(stated, std: float):  # type: ignore[no-untyped-def]
    """The throat's radius known to a standard deviation [m]."""
    return replace(stated, nozzle=replace(stated.nozzle, throat_radius=Value(THROAT, std)))


def test_a_thrust_is_doubted_beyond_what_losses_and_the_throat_explain(burn: Trial) -> None:
    """The stand's thrust is 1.4 p_c A_t; a twentieth more or less is within losses, a fifth is not."""
    assert verdicts(burn, 0.95) == verdicts(burn, 1.02) == []
    assert verdicts(burn, 0.75) == verdicts(burn, 1.25) == ["thrust and p_c A_t disagree"]
    assert verdicts(burn, 0.75, std=0.1 * THROAT) == verdicts(burn, 1.25, std=0.1 * THROAT) == []


def test_how_well_the_coefficient_is_known_is_as_the_throats_area_is(burn: Trial) -> None:
    log = log_of(burn)
    off = replace(log["thrust"], values=0.4 * log["thrust"].values)
    stated = replace_radius(definition(burn.stand), 0.02 * THROAT)
    found = findings(replace(log, channels={**log.channels, "thrust": off}), segments_of(burn), stated, FIRE)[0].size
    assert found.value is not None
    drawn = pi * (THROAT * (1.0 + 0.02 * np.random.default_rng(2).standard_normal(20_000))) ** 2
    assert found.std == pytest.approx(found.value * np.std(drawn) / np.mean(drawn), rel=0.03)


@pytest.mark.parametrize(("off", "reads"), [(0.03, True), (-0.03, True), (0.08, False), (-0.08, False)])
def test_a_tank_cell_is_compared_where_it_reads_what_is_loaded_to_a_twentieth(
    burn: Trial, off: float, reads: bool
) -> None:
    loaded = burn.stand.mass
    read = np.full(burn.time.size, (1.0 + off) * loaded)
    log = log_of(burn)
    weighed = replace(log, channels={**log.channels, "m_tank": channel("m_tank", burn.time + 100.0, read)})
    assert _cell_reads(weighed, segments_of(burn), loaded) is reads


def test_a_doubt_about_the_zero_does_not_hide_it(burn: Trial) -> None:
    log, drift = log_of(burn), 0.05 * float(np.percentile(burn.values["thrust"], 99.0))
    wide = float(np.hypot(1.0, drift))
    warm = replace(log["thrust"], zero=0.0, zero_std=wide, drift=drift, doubt=drift)
    found = findings(
        replace(log, channels={**log.channels, "thrust": warm}), segments_of(burn), definition(burn.stand), FIRE
    )
    assert "does not return to zero" in [f.verdict for f in found]


@pytest.mark.parametrize(("share", "told"), [(0.012, False), (0.03, True), (-0.03, True)])
def test_a_cell_is_named_that_ends_a_fiftieth_of_its_peak_from_zero(burn: Trial, share: float, told: bool) -> None:
    log = log_of(burn)
    drift = share * float(np.percentile(burn.values["thrust"][burn.time > 0.0], 99.0))
    warm = replace(log["thrust"], zero=0.0, zero_std=1.0, drift=drift)
    found = findings(
        replace(log, channels={**log.channels, "thrust": warm}), segments_of(burn), definition(burn.stand), FIRE
    )
    assert ("does not return to zero" in [f.verdict for f in found]) is told


@pytest.mark.parametrize(("times_ambient", "judged"), [(1.6, False), (4.0, True)])
def test_a_nozzle_that_is_not_choked_says_nothing_of_the_thrust(
    burn: Trial, times_ambient: float, judged: bool
) -> None:
    """Between 1.1 and 1.8 times ambient its flow separates and its thrust is anything."""
    pressure = np.where(burn.time > 0.0, times_ambient * AMBIENT, AMBIENT)
    thrust = np.where(burn.time > 0.0, 3.0 * AMBIENT * times_ambient * pi * THROAT**2, 0.0)
    odd = replace(burn, values={**burn.values, "p_chamber": pressure, "thrust": thrust})
    verdict = [f.verdict for f in findings(log_of(odd), segments_of(odd), definition(burn.stand), FIRE)]
    assert ("thrust and p_c A_t disagree" in verdict) is judged


@pytest.mark.parametrize(("dry", "judged"), [(0.8, False), (1.3, True)])
def test_what_lasts_less_than_half_a_second_is_no_steady_part(burn: Trial, dry: float, judged: bool) -> None:
    """The start takes the first half second; the liquid has to last for as long again."""
    phases = segments_of(burn, t_v=Quantity(dry, "s", 1e-3))
    log = log_of(burn)
    off = replace(log["thrust"], values=0.5 * log["thrust"].values)
    found = findings(replace(log, channels={**log.channels, "thrust": off}), phases, definition(burn.stand), FIRE)
    assert bool(found) is judged
