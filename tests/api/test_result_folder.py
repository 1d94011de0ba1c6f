"""Where results are kept: the caller's folder, or one that goes with its result."""

from pathlib import Path

from exo_sim.api.result_folder import result_folder


def test_the_callers_folder_is_made_and_stays(tmp_path: Path) -> None:
    with result_folder(tmp_path / "found", "size") as (folder, temporary):
        (folder / "a").write_text("b")
    assert folder == tmp_path / "found" and temporary is None and (folder / "a").read_text() == "b"


def test_without_one_it_lasts_as_long_as_what_keeps_it() -> None:
    with result_folder(None, "size") as (folder, temporary):
        (folder / "a").write_text("b")
    assert temporary is not None and (folder / "a").exists()
    temporary.cleanup()
    assert not folder.exists()
