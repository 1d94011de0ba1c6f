"""`exo.diagnose`: what physics a rig leaves out, found in recordings of the machine."""

from __future__ import annotations

import filecmp
import math
import os
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from exo_sim.api.arguments import Columns, Quantity, RecordingLike, RigLike, columns_of, quantity, reading_of, rig_of
from exo_sim.api.notebook import html_table
from exo_sim.api.rig import Rig
from exo_sim.diagnosis import findings as records
from exo_sim.diagnosis.result import Diagnosis as Answer
from exo_sim.errors import OutputError, RecordingError
from exo_sim.inputs import text_of
from exo_sim.plain_text import json_text
from exo_sim.recording.table import Recording
from exo_sim.rig.included_machines import rig_file

if TYPE_CHECKING:
    from exo_sim.api.figure import Picture

#: What is written, and what it holds.
FILES = {
    "report": ("report.html", "the page to read and to print"),
    "improved": ("improved.toml", "the rig with what was found"),
    "comparison": ("comparison.rrd", "recorded, before and after"),
    "diagnosis": ("diagnosis.json", "everything, for machines"),
}


@dataclass(frozen=True, repr=False)
class Diagnosis:
    """The answer of a diagnosis.

    Attributes:
        result: All of it, as plain records (`exo_sim.diagnosis.result.Diagnosis`).
        time_s: How long it took [s].
    """

    result: Answer
    time_s: float
    _nominal: Path | Rig
    _folder: Path

    @cached_property
    def nominal(self) -> Rig:
        """Return the nominal rig: as it was handed in."""
        return rig_of(self._nominal)

    @property
    def believed(self) -> Rig:
        """Return `nominal`, by its earlier name."""
        return self.nominal

    @property
    def verdict(self) -> str:
        """Return "consistent", "calibration", "mismatch" or "undetermined"."""
        return str(self.result.verdict)

    @property
    def findings(self) -> tuple[records.Finding, ...]:
        """Return what was found: `name`, `where`, `kind`, `says`, `parameters` (with `value`, `low`, `high`, `unit`), `confidence`."""
        return self.result.effects

    @property
    def rig(self) -> Rig:
        """Return the improved rig: as given, with what was found put in."""
        return Rig.parse(self.result.improved, self._folder)

    @property
    def fit(self) -> Mapping[str, records.SignalFit]:
        """Return, by signal, the error on held-out time: `before`, `after`, and the sensor's `noise`, in SI."""
        return self.result.signals

    @property
    def summary(self) -> dict[str, Any]:
        """Return what `exo-sim diagnose --json` prints, without file names."""
        return self.result.as_dict() | {"time_s": round(self.time_s, 3)}

    @property
    def exit_status(self) -> int:
        """Return what the command ends with: 0 agreement, 3 something is missing, 4 the recordings cannot tell."""
        return self.result.exit_status

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Write `report.html`, `improved.toml`, `comparison.rrd` and `diagnosis.json` into a folder, as the command does.

        Returns:
            The folder.

        Raises:
            OutputError: the folder or a file cannot be written, or `improved.toml` would replace the rig that was handed in.
        """
        from exo_sim.diagnosis.pipeline.freed_memory import return_freed
        from exo_sim.outputs import replacing
        from exo_sim.report.comparison import write_comparison
        from exo_sim.report.diagnosis_page import page

        place = Path(folder)
        nominal = self._nominal
        path = nominal if isinstance(nominal, Path) else nominal.path
        refuse_own_rig(place, path)
        there = place.resolve() == self._folder.resolve()  # the text that was proved, as it stands
        texts = {
            "improved": self.result.improved if there else self.rig.text_in(place),
            "report": page(self.result, text_of(path) if isinstance(nominal, Path) else nominal.text, path.name),
            "diagnosis": json_text(self.result.as_dict()) + "\n",
        }
        machine = Rig.load(nominal) if isinstance(nominal, Path) else nominal
        return_freed()  # what the pictures of the page took
        write_comparison(place / FILES["comparison"][0], self.result, self.result.tables, machine)
        for key, text in texts.items():
            with replacing(place / FILES[key][0]) as beside:
                beside.write_text(text, encoding="utf-8")
        return place

    def plot(self, signals: Sequence[str] | None = None) -> Picture:
        """Draw recorded signals, and what the rig predicts before and after, of the first recording that has them."""
        from exo_sim.api.plots import panels

        if not self.result.series:
            return panels([("recorded", table) for table in self.result.tables[:1]], signals)
        name = self.result.series[0].recording
        own = [series for series in self.result.series if series.recording == name]
        units = {series.signal: series.unit for series in own}
        clock = own[0].time
        alike = [series for series in own if len(series.time) == len(clock)]
        lines = []
        for label in ("recorded", "before", "after"):
            columns = {series.signal: getattr(series, label) for series in alike}
            lines.append((label, Recording(name, clock, columns, units)))
        return panels(lines, [series.signal for series in alike] if signals is None else signals)

    def __str__(self) -> str:
        from exo_sim.report import diagnosis_text

        return diagnosis_text.text(self.result)

    def __repr__(self) -> str:
        return f"<exo.Diagnosis of {self.result.rig}: {self.verdict}, {len(self.findings)} findings>"

    def _repr_html_(self) -> str:
        from exo_sim.report import diagnosis_words as words

        rows = []
        for finding in self.findings:
            numbers = "; ".join(f"{name} = {value} ({span})" for name, value, span in words.numbers(finding))
            rows.append([words.title(finding), words.KINDS[finding.kind], numbers, words.evidence(finding)])
        title = f"{words.VERDICTS[self.result.verdict]}. {words.verdict(self.result)} {words.proof(self.result)}"
        return html_table(rows, ("finding", "kind", "numbers, 95 %", "evidence") if rows else (), title)


def diagnose(
    recordings: RecordingLike | Sequence[RecordingLike], rig: RigLike, *, budget: Quantity | None = None, columns: Columns = None,
    jobs: int | None = None, seed: int = 0, progress: Callable[[str], None] | None = None, out: str | os.PathLike[str] | None = None,
) -> Diagnosis:  # fmt: skip
    """Hold recordings of one machine against its rig: locate, name, model and prove what the rig leaves out.

    Args:
        recordings: One or several paths or `exo.Recording`; several are one case with shared parameters.
        rig: A path or `exo.Rig`: the nominal machine, as its owner describes it.
        budget: Time after which the best answer so far comes: seconds, or text like "60 s".
        columns: Foreign names: a column map (TOML) or a dictionary.
        jobs: Threads; all cores when None. No answer depends on it.
        seed: Kept for the contract: nothing here is drawn by chance.
        progress: Called with a few words on what is going on.
        out: Folder in which the files are written, as by `save`; none when None.

    Raises:
        RecordingError, RigError, ModelError: unusable input; one line each.
    """
    from exo_sim.diagnosis.pipeline.diagnose import diagnose as search

    begun = time.monotonic()
    allowed = math.inf if budget is None else quantity(budget, "s", "budget", low=1.0)
    single = isinstance(recordings, str | os.PathLike | Recording)
    handed_in: list[Any] = [recordings] if single else list(recordings)  # type: ignore[list-item, arg-type]
    if not handed_in:
        raise RecordingError("no recording was given")
    handed_in, copies = _each_once(handed_in)
    cases = [Path(one) if isinstance(one, str | os.PathLike) else reading_of(one) for one in handed_in]
    nominal = rig_file(rig) if isinstance(rig, str | os.PathLike) else rig_of(rig)
    beside = (nominal if isinstance(nominal, Path) else nominal.path).parent
    folder = beside if out is None else Path(out)
    column_map = columns_of(columns)
    result = search(
        cases, nominal, column_map=column_map, seed=seed, jobs=jobs, progress=progress, folder=folder, budget=allowed
    )
    if not result.tables:
        tables = [reading_of(given, column_map).recording for given in handed_in]
        result = replace(result, tables=tuple(replace(table, name=name) for table, name in zip(tables, result.recordings, strict=True)))
    result = replace(result, sensor_remarks=(*result.sensor_remarks, *copies))
    found = Diagnosis(result, time.monotonic() - begun, nominal, folder)
    if out is not None:
        if progress is not None:
            progress("writing")
        found.save(out)
    return found


def refuse_own_rig(folder: Path, rig: Path) -> None:
    """Keep `improved.toml` from being written over the rig that it improves.

    Raises:
        OutputError: it would be.
    """
    improved = folder / FILES["improved"][0]
    if improved.exists() and rig.exists() and improved.samefile(rig):
        raise OutputError(f'cannot write "{improved}": it is the rig that was handed in; name another folder with --out')


def _each_once(handed_in: list[Any]) -> tuple[list[Any], list[str]]:
    """Return recordings without files that are copies of others, and what is said of those: they would tighten every interval."""
    kept: list[Any] = []
    said: list[str] = []
    for one in handed_in:
        files = [Path(other) for other in kept if isinstance(other, str | os.PathLike)] if isinstance(one, str | os.PathLike) else []
        same = next((path for path in files if _are_copies(Path(one), path)), None)
        if same is None:
            kept.append(one)
        else:
            said.append(f'"{one}" is the same recording as "{same}" and counts once.')
    return kept, said


def _are_copies(one: Path, other: Path) -> bool:
    return one.is_file() and other.is_file() and filecmp.cmp(one, other, shallow=False)
