"""What is not ours is never touched: only new, empty and marked folders are written into."""

import os
from pathlib import Path

import pytest

from models.atomic_file import MACHINE
from models.errors import DatasetError, StorageError
from models.output_folder import check_empty, check_place, foreign_names


def test_new_and_empty_folders_are_free(tmp_path):
    for folder in (tmp_path, tmp_path / "new" / "deep"):
        check_place(folder)
        check_empty(folder, "a thing")
    assert not (tmp_path / "new").exists()


def test_a_link_to_an_empty_folder_is_one(tmp_path):
    (tmp_path / "there").mkdir()
    (tmp_path / "link").symlink_to("there")
    check_place(tmp_path / "link")
    check_empty(tmp_path / "link", "a thing")


def test_what_is_found_is_named_and_the_rest_counted(tmp_path):
    for number in range(9):
        (tmp_path / f"{number}.txt").touch()
    (tmp_path / "a_folder").mkdir()
    (tmp_path / "a_folder" / "file").touch()
    with pytest.raises(DatasetError, match=r"0\.txt, .*, 5\.txt and 4 more; nothing was changed"):
        check_empty(tmp_path, "a thing")
    assert "a_folder/" in foreign_names(tmp_path)


@pytest.mark.parametrize("own", [["units"], []])
def test_names_known_as_ours_do_not_count(tmp_path, own):
    (tmp_path / "units").mkdir()
    (tmp_path / "units" / "file").touch()
    if own:
        check_empty(tmp_path, "a thing", own)
        return
    with pytest.raises(DatasetError, match="units/; nothing was changed"):
        check_empty(tmp_path, "a thing", own)


def test_what_a_killed_process_left_half_written_does_not_count(tmp_path):
    """It may be killed before the first file, which marks the folder, has its name."""
    (tmp_path / "truth").mkdir()
    for name in (".dataset.json", "truth/.scenario.toml"):
        (tmp_path / f"{name}.{MACHINE}-99999999.part").touch()
    check_empty(tmp_path, "a thing")
    (tmp_path / "truth" / "link").symlink_to("nowhere")
    with pytest.raises(DatasetError, match="truth/"):
        check_empty(tmp_path, "a thing")


def test_no_folder_can_stand_where_a_file_does(tmp_path):
    (tmp_path / "file").touch()
    for folder in (tmp_path / "file", tmp_path / "file" / "below"):
        with pytest.raises(DatasetError, match=r"/file, found a file; choose another --out"):
            check_place(folder)


def test_a_link_that_leads_nowhere_is_told(tmp_path):
    (tmp_path / "link").symlink_to("absent")
    with pytest.raises(DatasetError, match="found a link to absent, which is not there"):
        check_place(tmp_path / "link")


def test_who_may_not_write_is_told_so_before_anything_is_done(tmp_path, monkeypatch):
    """Root may write anywhere, so the system's answer is put in its mouth."""
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(StorageError, match=r"write into .*, got: Permission denied; choose anoth"):
        check_place(tmp_path / "new")


def test_a_relative_place_is_looked_at_from_here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    check_place(Path("new/deep"))
    check_place(Path())
    (tmp_path / "new").touch()
    with pytest.raises(DatasetError, match="expected a folder at new, found a file"):
        check_place(Path("new/deep"))
