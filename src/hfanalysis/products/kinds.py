"""Every JSON product of a test, by the name of its file."""

from __future__ import annotations

from hfanalysis.products.calibration import Calibration
from hfanalysis.products.diagnosis import Diagnosis
from hfanalysis.products.flight import Flight
from hfanalysis.products.health import Health
from hfanalysis.products.ingest import Ingest
from hfanalysis.products.model import Product
from hfanalysis.products.segments import Segments
from hfanalysis.products.validation import Validation

_KINDS: tuple[type[Product], ...] = (Ingest, Health, Segments, Calibration, Validation, Diagnosis, Flight)

KINDS = {kind.file: kind for kind in _KINDS}
