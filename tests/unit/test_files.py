"""Files that appear as a whole or not at all."""

import json

import pytest

from rockshed.core.errors import InputRefused, refusing_unwritable
from rockshed.files import whole_file, write_file, write_json


def test_a_file_takes_its_place_when_it_is_complete(tmp_path):
    file = tmp_path / "results.png"
    file.write_text("old")
    with whole_file(file) as temporary:
        temporary.write_text("new")
        assert temporary.suffix == ".png"
        assert file.read_text() == "old"
    assert file.read_text() == "new"
    assert list(tmp_path.iterdir()) == [file]


def test_what_goes_wrong_leaves_the_old_file_and_nothing_else(tmp_path):
    file = tmp_path / "results.csv"
    write_file(file, "old")
    with pytest.raises(TypeError), whole_file(file) as temporary:
        temporary.write_text(1)
    with pytest.raises(OSError, match="results"), whole_file(file):
        pass  # nothing was written
    assert file.read_text() == "old"
    assert list(tmp_path.iterdir()) == [file]


def test_what_json_has_no_form_for_is_written_as_text(tmp_path):
    write_json(tmp_path / "facts.json", {"folder": tmp_path, "sign": "σ"})
    text = (tmp_path / "facts.json").read_text(encoding="utf-8")
    assert json.loads(text) == {"folder": str(tmp_path), "sign": "σ"}
    assert "σ" in text


def test_a_folder_that_cannot_be_written_is_a_refusal(tmp_path):
    (tmp_path / "file").write_text("")
    place = tmp_path / "file" / "folder"
    with (
        pytest.raises(InputRefused, match=r"cannot be written: .*; name another folder"),
        refusing_unwritable(place),
    ):
        place.mkdir()
