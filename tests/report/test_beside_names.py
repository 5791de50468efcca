"""One sentence for each named effect that the reconstruction can be laid beside."""

from __future__ import annotations

import numpy as np
import pytest
from tests.products.filled import filled

from hfanalysis.products.diagnosis import Constants, Diagnosis, NamedEffect
from hfanalysis.products.reconstruction import AXIS, Reconstruction
from hfanalysis.quantity import Quantity
from hfanalysis.report.beside_names import sentences

TIME = np.linspace(0.0, 5.0, 51)
FLUX = np.linspace(300.0, 150.0, 51)
LAW = 2e-4, 0.5
RATE = LAW[0] * FLUX ** LAW[1]


def said(name: str, parameters: dict[str, Quantity], found: Reconstruction) -> list[str]:
    effect = filled(NamedEffect, {"name": name, "parameters": parameters})
    constants = Constants.model_validate({"without": {}, "with": {"a": Quantity(LAW[0]), "n": Quantity(LAW[1])}})
    diagnosis = filled(Diagnosis, {"effects": (effect,), "constants": constants})
    histories = {AXIS: TIME, "p_chamber": np.full(51, 20e5), "oxidizer_flux": FLUX,
                 "regression_rate_low95": 0.97 * RATE, "regression_rate_high95": 1.03 * RATE}  # fmt: skip
    return list(sentences(found, histories, diagnosis))


def reconstruction(**known: Quantity) -> Reconstruction:
    return Reconstruction(variant="d", **known)


@pytest.mark.parametrize(("deficit", "verb"), [(0.09, "agrees with"), (0.2, "contradicts"), (0.0, "contradicts")])
def test_an_efficiency_is_one_less_its_deficit(deficit: float, verb: str) -> None:
    own = reconstruction(c_star_efficiency=Quantity(0.9, "", 0.01))
    (sentence,) = said("combustion_efficiency", {"deficit": Quantity(deficit, "", 0.005)}, own)
    assert verb in sentence
    assert "no probability" in sentence


@pytest.mark.parametrize(("rate", "verb"), [(1e-4, "agrees with"), (3e-4, "contradicts")])
def test_a_throat_that_erodes_grows_by_its_rate(rate: float, verb: str) -> None:
    parameters = {"rate": Quantity(rate, "m/s", 0.05 * rate), "heating": Quantity(0.01, "s"), "exponent": Quantity(0.8)}
    own = reconstruction(throat_radius_change=Quantity(5e-4, "m", 5e-5))
    (sentence,) = said("nozzle_throat_erosion", parameters, own)
    assert verb in sentence
    assert not said("nozzle_throat_erosion", parameters, reconstruction())


@pytest.mark.parametrize(("exponent", "reference", "verb"), [(0.3, 20e5, "agrees with"), (0.3, 10e5, "contradicts")])
def test_a_regression_by_pressure_is_laid_into_the_band(exponent: float, reference: float, verb: str) -> None:
    parameters = {"exponent": Quantity(exponent), "bend": Quantity(0.0), "reference": Quantity(reference, "Pa")}
    (sentence,) = said("grain_pressure_regression", parameters, reconstruction())
    assert verb in sentence


def test_an_effect_of_the_tank_has_nothing_beside_it() -> None:
    assert not said("tank_heat", {}, reconstruction())
