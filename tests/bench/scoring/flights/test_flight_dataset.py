"""A flight as a dataset, estimated, scored and reported by the engine that knows nothing of it."""

import json
from dataclasses import replace

import pytest

from bench.cli import main
from bench.suites.vinag2018.cases import LEO
from bench.suites.vinag2018.flight_dataset import write_flight


@pytest.fixture(scope="module")
def scored(tmp_path_factory):
    folder = tmp_path_factory.mktemp("flight") / "leo"
    write_flight(folder, replace(LEO, degree=4), 30.0)
    for verb in ("estimate", "score", "report"):
        assert main([verb, str(folder)]) in (0, None)
    return folder


def test_it_is_scored_by_its_axes(scored):
    score = json.loads((scored / "score.json").read_text())
    for label in ("paper", "best"):
        own = score["pipelines"][label]
        assert own["core"]["frames"] == own["core"]["estimated"] == 30
        assert own["core"]["wrong"]["count"] == 0
        found = own["parts"]["navigation"]
        assert max(found["along_rms_m"]) < 100.0
        assert found["attitude_rms_deg"] < 0.01
        assert 0.1 < found["orbit_nees"] < 5.0
        assert own["parts"]["integrity"]["told"] == 30
        assert own["parts"]["integrity"]["missed"] == 0


def test_the_report_opens_offline(scored):
    text = (scored / "report.html").read_text()
    assert "https://" not in text
    assert "http://" not in text.replace("http://www.w3.org", "")
    assert "Errors by axis" in text
    assert "with a state" in text


def test_a_damaged_truth_is_told(scored, capsys):
    truth = scored / "truth" / "flight.csv"
    lines = truth.read_text().splitlines()
    truth.write_text("\n".join(lines[:-1]) + "\n")
    assert main(["score", str(scored)]) == 2
    assert "expected frame 29, found none" in " ".join(capsys.readouterr().err.split())
