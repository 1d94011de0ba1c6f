"""The journal of a search: finished designs on disk, so that a search that was killed goes on where it was."""

from __future__ import annotations

import warnings
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from exo_sim.errors import OutputError
from exo_sim.sizing.evaluation import Score

if TYPE_CHECKING:
    import optuna

#: Of the objectives of a score: margin, gas, mass, tracking.
DIRECTIONS: tuple[Literal["maximize", "minimize"], ...] = ("maximize", "minimize", "minimize", "minimize")
#: Seconds that a lock of whoever was killed is waited for.
_GRACE = 2
_NO_JOURNAL = "is no journal of a search; remove it or name another folder with --out"


class SearchJournal:
    """Finished designs in Optuna's journal storage; one study of one search.

    Args:
        path: The file; None keeps nothing.
        name: What the search is; a journal of another name is refused.

    Raises:
        OutputError: the file is no journal, one of another search, or cannot be written.
    """

    def __init__(self, path: Path | None, name: str):
        self._study: optuna.Study | None = None
        self._scores: dict[int, tuple[dict[str, Any], Score]] = {}
        if path is None:
            return
        import optuna
        from optuna.storages import JournalStorage
        from optuna.storages.journal import JournalFileBackend, JournalFileOpenLock

        if path.parent.exists() and not path.parent.is_dir():
            raise OutputError(f'cannot write into "{path.parent}": it is a file; name a folder with --out')
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            _mend(path)
            # whoever was killed holding the lock is not waited for long
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", UserWarning)
                lock = JournalFileOpenLock(str(path.resolve()), grace_period=_GRACE)
            storage = JournalStorage(JournalFileBackend(str(path), lock_obj=lock))
            names = optuna.get_all_study_names(storage)
            if names and names != [name]:
                raise OutputError(
                    f'{path} holds another search (other rig, loads, bounds or seed); name another folder with --out, '
                    "or remove that file"
                )
            self._study = optuna.create_study(
                storage=storage, study_name=name, directions=list(DIRECTIONS), load_if_exists=True
            )
            for trial in self._study.get_trials(deepcopy=False):
                self._take(trial)
        except OSError as error:
            raise OutputError(f'cannot write "{path}": {error.strerror or error}; write elsewhere') from None
        except (OutputError, MemoryError):
            raise
        except Exception:  # of many kinds, on files that something else wrote
            raise OutputError(f"{path} {_NO_JOURNAL}") from None

    def _take(self, trial: optuna.trial.FrozenTrial) -> None:
        score = trial.user_attrs["score"]
        thinnest = score["thinnest"]
        score = {
            **score,
            "violations": tuple(score["violations"]),
            "thinnest": tuple(thinnest) if thinnest else None,
            "springs": {name: tuple(spring) for name, spring in score.get("springs", {}).items()},
        }
        self._scores[trial.user_attrs["number"]] = (trial.params, Score(**score))

    def score(self, number: int, params: dict[str, Any]) -> Score | None:
        """Return the score of a finished design, None where it was not finished or is another one."""
        held = self._scores.get(number)
        return held[1] if held is not None and held[0] == params else None

    def keep(self, number: int, params: dict[str, Any], score: Score, distributions: dict[str, Any]) -> None:
        """Write a finished design down."""
        if self._study is None:
            return
        import optuna

        self._study.add_trial(
            optuna.create_trial(
                params=params, distributions=distributions, values=list(score.objectives),
                user_attrs={"number": number, "score": asdict(score)},
            )
        )  # fmt: skip


def _mend(path: Path) -> None:
    """Take away the line that a killed search was writing.

    Raises:
        OutputError: the file is no journal; it is left alone.
    """
    if not path.exists():
        return
    if not path.is_file():  # a pipe would be waited for
        raise OutputError(f"{path} {_NO_JOURNAL}")
    with path.open("r+b") as file:
        text = file.read()
        if text and not text.startswith(b'{"op_code"'):
            raise OutputError(f"{path} {_NO_JOURNAL}")
        if not text.endswith(b"\n"):
            file.truncate(text.rfind(b"\n") + 1)
