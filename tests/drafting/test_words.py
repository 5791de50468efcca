"""What names of columns say, in the sense that test stands use them in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hfanalysis.drafting.columns import Column
from hfanalysis.drafting.guesses import judged
from hfanalysis.drafting.labels import taken_apart
from hfanalysis.drafting.shapes import Shape
from hfanalysis.drafting.survey import chosen

FIRING = Shape("pulse", rest=14.7, end=15.0, low=14.0, high=300.0, plateau=250.0)
EMPTYING = Shape("falls", rest=750.0, end=15.0, low=14.0, high=752.0, plateau=600.0)


def guessed(label: str, shape: Shape = FIRING) -> str | None:
    """The channel that a column of this label and shape is guessed to be."""
    name, unit = taken_apart(label)
    best = judged(Column("log.csv", 1, label, name, unit, np.zeros(0), 0), shape).best
    return best.channel if best else None


@pytest.mark.parametrize(
    ("label", "channel"),
    [
        ("PT-TANK (psia)", "p_tank"),
        ("P_RUN_TANK (psi)", "p_tank"),  # a run tank is a tank
        ("P_N2O_FLOW (psi)", "p_run"),  # N2O is not N2
        ("P_N2_FLOW (psi)", "p_purge"),
        ("GN2 pressure (psi)", "p_purge"),
        ("NitrousTankPressure (psi)", "p_tank"),
        ("P_oxtank (bar)", "p_tank"),
        ("PT-CC (psi)", "p_chamber"),
        ("Pc (bar)", "p_chamber"),
        ("PTC1 (psi)", "p_chamber"),
        ("P_COMB_CHMBR (psi)", "p_chamber"),
        ("Brennkammerdruck (bar)", "p_chamber"),
        ("chamber pressure", "p_chamber"),
        ("PT-MAN (psi)", "p_run"),
        ("n2o_tank_p (bar)", "p_tank"),
        ("PN2O_INJ (bar)", "p_run"),
        ("HPN2 (psi)", "p_purge"),
        ("PT_RUN2 (psi)", "p_run"),  # the second of the line: no nitrogen in it
        ("OX_TNK_PRES (psi)", "p_tank"),
        ("Engine Pressure (bar)", "p_chamber"),
        ("Main axial cell (lbf)", "thrust"),
        ("N2O weight (kg)", "m_tank"),
        ("P_AMB (bar)", None),
        ("dP injector (bar)", None),
        ("inj_press (psi)", "p_run"),
        ("fill line (psi)", "p_fill"),
        ("LC-THRUST (lbf)", "thrust"),
        ("LCC1 (lbf)", "thrust"),  # the cell at the chamber
        ("Schub [N]", "thrust"),
        ("LC-TANK (kg)", "m_tank"),
        ("LCR1 (lbm)", "m_tank"),
        ("TANK_WEIGHT", "m_tank"),
        ("TC-TANK (degC)", "T_tank"),
        ("T_RUN_TANK (C)", "T_tank"),
        ("TCC2 (degC)", "T_chamber"),
        ("Main Valve", "valve"),
        ("FUEL_TANK (psi)", None),
        ("Thrust (psi)", None),
        ("TC-TANK (lbf)", None),
        ("vibration", None),
        ("setpoint", None),
    ],
)
def test_words_are_weighed_as_test_stands_use_them(label: str, channel: str | None) -> None:
    shape = {"p_tank": EMPTYING, "m_tank": replace(EMPTYING, rest=9.0, high=9.0, end=0.1)}.get(channel or "", FIRING)
    assert guessed(label, shape) == channel


def test_a_force_in_pounds_is_one_in_pounds_force() -> None:
    label = "Force (lbs)"
    best = judged(Column("log.csv", 1, label, *taken_apart(label), np.zeros(0), 0), FIRING).best
    assert best is not None
    assert (best.channel, best.unit) == ("thrust", "lbf")


def test_only_name_and_stated_unit_together_take_a_column_for_a_channel() -> None:
    """A guess without a unit, by a letter or by a shape alone is left to the engineer."""
    labels = ["PT-CC (psi)", "PT-RUN", "PTR1 (psi)", "P_o (bar)", "P_N2O (psi)", "(psi)"]
    columns = [Column("log.csv", i, label, *taken_apart(label), np.zeros(0), 0) for i, label in enumerate(labels)]
    found = [judged(column, FIRING) for column in columns]
    assert [guess.channel for guess in chosen(found).values()] == ["p_chamber"]


def test_of_two_columns_for_one_channel_the_one_that_behaves_so_is_taken() -> None:
    dead = Shape("constant", 445.0, 445.0, 445.0, 445.0)
    columns = [Column("log.csv", i, "PT-RUN (psi)", "PT-RUN", "psi", np.zeros(0), 0) for i in (1, 2)]
    found = [judged(columns[0], dead), judged(columns[1], FIRING)]
    assert [number for _, number in chosen(found)] == [2]


@pytest.mark.parametrize(
    ("label", "name", "unit"),
    [
        ("tank psig", "tank", "psig"),
        ("thrust_lbf", "thrust", "lbf"),
        ("T_tank_K", "T_tank", "K"),
        ("Zeit s", "Zeit", "s"),
        ("Temperature [Deg F]", "Temperature", "deg F"),
        ("p_c", "p_c", ""),
        ("mass_flow", "mass_flow", ""),
        ("PT-RUN", "PT-RUN", ""),
        ("(psi)", "(psi)", ""),
    ],
)
def test_a_label_is_taken_apart_into_name_and_unit(label: str, name: str, unit: str) -> None:
    assert taken_apart(label) == (name, unit)
