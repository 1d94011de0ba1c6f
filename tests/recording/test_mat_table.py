"""MATLAB files of both kinds give the table that went into them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from recording.one_table import HEADINGS, TABLE, TIME, foreign, is_the_table

from exo_sim.errors import RecordingError
from exo_sim.recording import read

MAP = {"log.t": "time [s]", "log.P1": "piston.pressure_1 [bar]", "angles(:,1)": "knee.position [deg]"}


def test_a_mat_file_of_version_5(tmp_path: Path) -> None:
    from scipy.io import savemat

    path = tmp_path / "run.mat"
    savemat(path, {"log": {"t": TIME, "P1": TABLE[:, 1]}, "angles": TABLE[:, 2:].repeat(2, 1), "note": "a text"})
    is_the_table(read(path, foreign(MAP)).recording)
    with pytest.raises(RecordingError, match=r'no column "time \[s\]".*there is: "log.t"'):
        read(path)
    savemat(path, {"data": TABLE, "headings": np.array(HEADINGS, dtype=object)})
    is_the_table(read(path).recording)
    savemat(path, {"log": {"t": TIME, "P1": TABLE[:-1, 1]}, "angles": TABLE[:, 2:].repeat(2, 1)})
    with pytest.raises(RecordingError, match="199 samples, the time 200"):
        read(path, foreign(MAP))


def test_a_mat_file_of_version_7_3(tmp_path: Path) -> None:
    """As MATLAB writes it: HDF5 behind a block of 512 bytes, matrices with columns first, characters as numbers, cells as references."""
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "run.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        file["log/t"], file["log/P1"] = TIME[None], TABLE[:, 1][None]
        file["angles"] = TABLE[:, 2:].repeat(2, 1).T
        note = file.create_dataset("note", data=np.array([[ord(c)] for c in "text"], dtype=np.uint16))
        note.attrs["MATLAB_class"] = np.bytes_("char")
    is_the_table(read(path, foreign(MAP)).recording)
    with h5py.File(path, "w") as file:
        file["data"] = TABLE.T
        cells = [file.create_dataset(f"#refs#/{i}", data=np.array([[ord(c)] for c in h], dtype=np.uint16)) for i, h in enumerate(HEADINGS)]
        file.create_dataset("headings", data=np.array([[cell.ref for cell in cells]], dtype=h5py.ref_dtype))
    is_the_table(read(path).recording)


@pytest.mark.parametrize(
    ("headings", "says"),
    [
        ([*HEADINGS[:2], HEADINGS[1]], "is there 2 times"), (HEADINGS[:2], r"names 2 columns and .data. has 3"),
        ([*HEADINGS, "more"], "names 4 columns"),
    ],
)  # fmt: skip
def test_headings_that_do_not_fit_are_refused(tmp_path: Path, headings: list[str], says: str) -> None:
    from scipy.io import savemat

    savemat(tmp_path / "run.mat", {"data": TABLE, "headings": np.array(headings, dtype=object)})
    with pytest.raises(RecordingError, match=says):
        read(tmp_path / "run.mat")


def test_what_is_cut_off_is_said_to_be_no_whole_file(tmp_path: Path) -> None:
    from scipy.io import savemat

    path = tmp_path / "run.mat"
    savemat(path, {"data": TABLE})
    path.write_bytes(path.read_bytes()[:500])
    with pytest.raises(RecordingError, match=r"not a whole \.mat file"):
        read(path)


def test_links_are_not_followed_in_circles_nor_to_other_files(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "run.mat"
    TABLE[:, :1].tofile(tmp_path / "raw")
    with h5py.File(path, "w") as file:
        group = file.create_group("log")
        group["t"], group["P1"] = TIME[None], TABLE[:, 1][None]
        file["angles"] = TABLE[:, 2:].repeat(2, 1).T
        for i in range(40):  # 40 ** 8 ways round
            group[f"hard{i}"], group[f"soft{i}"] = group, h5py.SoftLink("/log")
        group["other"] = h5py.ExternalLink("/dev/zero", "/data")
        group.create_dataset("raw", shape=(len(TIME),), dtype="f8", external=[("raw", 0, 8 * len(TIME))])
    is_the_table(read(path, foreign(MAP)).recording)
    with pytest.raises(RecordingError, match=r'there is: "angles.*,.*log.P1", "log.t"$'):
        read(path)
