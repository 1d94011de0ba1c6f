"""Scores from this process, from processes of this machine, or from a Dask cluster: the same scores in the same order."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import Any

from exo_sim.errors import ScenarioError
from exo_sim.sizing.evaluation import Score, Task, first_of_all, score_all

#: Designs in one parcel: few enough to share a batch evenly, enough that sending them costs little.
PARCEL = 2
_CONNECT = 5.0
#: Seconds after which a process without work ends; it is started again where more comes.
_IDLE = 20


class Workers:
    """Whoever scores; a context manager.

    Args:
        jobs: Processes of this machine, one thread each; -1 for one a core.
        scheduler: Address of a Dask scheduler, "tcp://HOST:PORT"; then `jobs` does not count.

    Raises:
        ScenarioError: nobody answers at that address, or no worker is there.
    """

    def __init__(self, jobs: int = 1, scheduler: str | None = None):
        self._stack = ExitStack()
        self.jobs, self._client, self._parallel = jobs, None, None
        if scheduler is not None:
            self._client = self._stack.enter_context(_client(scheduler))

    def __enter__(self) -> Workers:
        if self._client is not None:
            from joblib import Parallel, parallel_config

            self._stack.enter_context(parallel_config(backend="dask", client=self._client, wait_for_workers_timeout=_CONNECT))
            self._parallel = Parallel(n_jobs=-1)
        elif self.jobs != 1:
            from joblib import Parallel, parallel_config

            # after Ctrl-C joblib would speak of what it throws away
            warnings.filterwarnings("ignore", message=".*tasks have been successfully executed", category=UserWarning)
            # where this process is killed, its workers have no work any more, and are gone within a minute
            loky = parallel_config(backend="loky", n_jobs=self.jobs, inner_max_num_threads=1, idle_worker_timeout=_IDLE)
            self._stack.enter_context(loky)
            self._parallel = self._stack.enter_context(Parallel(return_as="generator"))
        return self

    def __exit__(self, *exception: object) -> None:
        self._stack.close()

    def scores(self, task: Task, designs: list[dict[str, float]]) -> Iterator[Score]:
        """Yield the score of each design, given as variables, in their order, as they come in."""
        return self._each(score_all, task, designs)

    def first_designs(self, task: Task, count: int, seed: int) -> list[dict[str, float]]:
        """Return the variables of the first designs, in their order."""
        return list(self._each(first_of_all, task, list(range(count)), seed))

    def _each(self, work: Callable[..., list[Any]], task: Task, items: list[Any], *more: Any) -> Iterator[Any]:
        if self._parallel is None:
            for item in items:
                yield from work(task, [item], *more)
            return
        from joblib import delayed

        parcels = [items[i : i + PARCEL] for i in range(0, len(items), PARCEL)]
        for found in self._parallel(delayed(work)(task, parcel, *more) for parcel in parcels):
            yield from found


def _client(address: str) -> Any:
    try:
        from distributed import Client
    except ImportError:
        raise ScenarioError("--scheduler needs Dask: install exo-sim-pneumatic[cluster]") from None
    if not re.fullmatch(r"(tcp|tls|ucx|ws|wss)://[^\s/]+:\d+", address):
        raise ScenarioError(f'"{address}" is no address of a Dask scheduler; write it as tcp://HOST:PORT')
    try:
        client = Client(address, timeout=_CONNECT, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        raise ScenarioError(f'no Dask scheduler answers at "{address}": {" ".join(str(error).split())}') from None
    if not client.scheduler_info()["workers"]:
        client.close()
        raise ScenarioError(f'the Dask scheduler at "{address}" has no workers; start one with: dask worker {address}')
    return client
