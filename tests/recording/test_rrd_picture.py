"""A picture without a display, where a Vulkan driver is installed."""

from pathlib import Path

import numpy as np
import pytest

from exo_sim.errors import OutputError, RecordingError
from exo_sim.recording import Recording, write_rrd
from exo_sim.recording.rrd_picture import take_picture


@pytest.mark.slow
def test_a_picture_shows_something(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    from matplotlib.image import imread

    time = np.arange(1000) / 1000.0
    columns = {"p.pressure_1": 1e5 * (2 + np.sin(9 * time))}
    write_rrd(tmp_path / "a.rrd", Recording("a", time, columns, {"p.pressure_1": "Pa"}))
    try:
        take_picture(tmp_path / "a.rrd", tmp_path / "a.png", at=0.5)
    except OutputError as error:
        assert "mesa-vulkan-drivers" in str(error)
        assert "backtrace" not in capfd.readouterr().err  # where in the viewer it failed
        pytest.skip(str(error))
    picture = imread(tmp_path / "a.png")
    blue = (picture[..., 2] > 0.8) & (picture[..., 0] < 0.5)  # the line of the plot
    assert blue.sum() > 500


def test_a_picture_of_nothing(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="no such recording"):
        take_picture(tmp_path / "no.rrd", tmp_path / "a.png")


def test_a_viewer_that_does_not_answer_is_not_said_to_lack_a_driver_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from rerun.experimental import ViewerClient

    def late(**_: object) -> None:
        raise ConnectionError("transport error")

    monkeypatch.setattr(ViewerClient, "spawn", late)
    (tmp_path / "a.rrd").write_bytes(b"")
    with pytest.raises(OutputError, match=r"did not answer \(transport error\); .* less busy, install a Vulkan driver .* scripts/picture"):
        take_picture(tmp_path / "a.rrd", tmp_path / "a.png")
