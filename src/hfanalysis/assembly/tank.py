"""The tank of an engine file: what it holds, how large it is, and what waits in it."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

from hfanalysis.engine.tank import nitrogen_pressure, split
from hfanalysis.errors import InputError
from hfanalysis.record.engine_file import EngineFile, Needs
from hfanalysis.steady_design import injector, sizing
from hfanalysis.thermo.nitrous import saturation
from hfanalysis.thermo.saturation import Saturation


@dataclass(frozen=True)
class TankBuilt:
    """A tank's volume [m^3], and its lengths [m] where the file says enough (``reason``: what is lacking).

    Without a dip tube (not ``dipped``) it is a plain cylinder.
    """

    volume: float
    size: sizing.TankSize | None
    reason: str = ""

    @property
    def dipped(self) -> bool:
        """Whether its dip tube has a length."""
        return self.size is not None and not self.reason


def properties(file: EngineFile) -> Saturation:
    """The saturation properties that the file asks for."""
    return saturation(file.model.properties)


def temperature(needs: Needs) -> float:
    """The tank's initial temperature [K]; InputError where the liquid has no saturated state there."""
    found = needs.value(needs.file.tank.temperature, "tank", "temperature").value
    source = properties(needs.file)
    if not isfinite(float(source.pressure(found))):
        raise InputError(
            f"{needs.file.where('tank', 'temperature')}: found {found:.2f} K; expected {source.t_min:.1f} to "
            f"{source.t_max:.1f} K, where {source.source} knows saturated nitrous oxide"
        )
    return found


def saturated(needs: Needs) -> injector.Saturated:
    """Pressure [Pa] and density [kg/m^3] of the liquid in the tank, under nitrogen where that is stated; InputError
    where its temperature does not say."""
    t, source = temperature(needs), properties(needs.file)
    return injector.Saturated(float(source.pressure(t)) + _nitrogen(needs), float(source.liquid_density(t)))


def _nitrogen(needs: Needs) -> float:
    """What nitrogen adds to the tank's pressure [Pa]; InputError where the stated pressure is that of no such tank."""
    stated = needs.file.tank.nitrogen_pressure
    if stated is None:
        return 0.0
    own = float(properties(needs.file).pressure(temperature(needs)))
    if stated.value <= own:
        raise InputError(
            f"{needs.file.where('tank', 'nitrogen_pressure')}: found {stated.value / 1e5:.4g} bar; expected more than "
            f"the {own / 1e5:.4g} bar of the nitrous oxide itself"
        )
    return stated.value - own


def nitrogen_mass(needs: Needs, volume: float) -> float:
    """Nitrogen [kg] above the liquid of a tank of ``volume`` [m^3], an ideal gas beside the vapor; none where no
    pressure is stated."""
    added = _nitrogen(needs)
    if added == 0.0:
        return 0.0
    load = needs.value(needs.file.tank.oxidizer_mass, "tank", "oxidizer_mass").value
    return added / nitrogen_pressure(properties(needs.file), volume, load, temperature(needs), 1.0)


def tank(needs: Needs, load: float | None = None) -> TankBuilt:
    """The tank [m^3] from its volume, length or ullage, holding the file's oxidizer, or another ``load`` [kg], as
    saturated liquid and vapor.

    Raises InputError where it does not hold that much, or where the file does not say enough.
    """
    t, source, stated = temperature(needs), properties(needs.file), needs.file.tank
    mass = needs.value(stated.oxidizer_mass, "tank", "oxidizer_mass").value if load is None else load
    try:
        built = _volume(needs, source, mass, t) if stated.volume is not None else _sized(needs, source, mass, t)
    except ValueError as error:
        raise InputError(f"{needs.file.where('tank')}: {error}") from None
    held = split(source, built.volume, mass, t)
    if held.liquid <= 0.0 or held.vapor < 0.0:
        least, most = (built.volume * float(d(t)) for d in (source.vapor_density, source.liquid_density))
        raise InputError(
            f"{needs.file.where('tank', 'oxidizer_mass')}: found {mass:.4g} kg; expected {least:.4g} to {most:.4g} kg, "
            f"what {built.volume * 1e3:.4g} L hold as liquid and vapor at {t:.2f} K"
        )
    return built


def _volume(needs: Needs, source: Saturation, mass: float, t: float) -> TankBuilt:
    stated = needs.file.tank
    volume = needs.value(stated.volume, "tank", "volume").value
    if stated.inner_diameter is None:
        return TankBuilt(volume, None, "tank.inner_diameter is not given")
    v_l, v_v = float(source.liquid_volume(t)[0]), float(source.vapor_volume(t)[0])
    liquid = (mass * v_v - volume) / (v_v - v_l) * v_l
    if not 0.0 < liquid < volume:
        return TankBuilt(volume, None, "the tank is not saturated")
    return TankBuilt(volume, _for_ullage(needs, source, mass, t, volume / liquid - 1.0), _undipped(needs))


def _sized(needs: Needs, source: Saturation, mass: float, t: float) -> TankBuilt:
    stated = needs.file.tank
    if stated.length is None:
        ullage = needs.value(stated.ullage, "tank", "volume (or length, or ullage)").value
        size = _for_ullage(needs, source, mass, t, ullage)
        return TankBuilt(size.volume, size, _undipped(needs))
    diameter = needs.value(stated.inner_diameter, "tank", "inner_diameter").value
    size = sizing.size_for_length(source, mass, t, diameter, _dip_tube(needs), stated.length.value)
    return TankBuilt(size.volume, size, _undipped(needs))


def _for_ullage(needs: Needs, source: Saturation, mass: float, t: float, ullage: float) -> sizing.TankSize:
    diameter = needs.value(needs.file.tank.inner_diameter, "tank", "inner_diameter").value
    return sizing.size_for_ullage(source, mass, t, diameter, _dip_tube(needs), ullage)


def _undipped(needs: Needs) -> str:
    return "" if needs.file.tank.dip_tube is not None else "tank.dip_tube is not given"


def _dip_tube(needs: Needs) -> sizing.DipTube:
    """As stated; one without section where there is none."""
    tube = needs.file.tank.dip_tube
    if tube is None:
        return sizing.DipTube(0.0, 0.0)
    if needs.file.tank.inner_diameter is not None and tube.outer_diameter.value >= needs.file.tank.inner_diameter.value:
        raise InputError(f"{needs.file.where('tank', 'dip_tube')}: it is wider than the tank")
    return sizing.DipTube(tube.outer_diameter.value, tube.inner_diameter.value)
