"""``rvbench view`` opens the page of any folder of ours, and says where it lies where it cannot."""

import webbrowser

import pytest

from bench import cli
from bench.viewing.verb import PAGES


@pytest.mark.parametrize("name", PAGES)
def test_the_page_of_a_folder_is_opened(tmp_path, monkeypatch, capsys, name):
    opened = []
    monkeypatch.setattr(webbrowser, "open", lambda url: opened.append(url) or True)
    folder = tmp_path / "a folder # with signs"
    folder.mkdir()
    (folder / name).write_text("<!doctype html>")
    assert cli.main(["view", str(folder)]) == 0
    assert cli.main(["view", str(folder / name)]) == 0
    assert opened == [(folder / name).as_uri()] * 2
    assert str(folder / name) in capsys.readouterr().out


def test_without_a_browser_the_place_is_told(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(webbrowser, "open", lambda url: False)
    (tmp_path / "report.html").write_text("<!doctype html>")
    assert cli.main(["view", str(tmp_path)]) == 2
    assert f"open {tmp_path / 'report.html'} by hand" in capsys.readouterr().err


@pytest.mark.parametrize(("file", "mend"), [("score.json", "rvbench report"), ("x", "of a run")])
def test_a_folder_without_a_page_says_what_to_do(tmp_path, capsys, file, mend):
    (tmp_path / file).write_text("{}")
    assert cli.main(["view", str(tmp_path)]) == 2
    assert mend in capsys.readouterr().err
