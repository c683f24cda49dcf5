"""Long names of a PDF may be broken, numbers never, and no text is changed for it."""

import re

from hypothesis import given
from hypothesis import strategies as st

from rockshed.reports.pdf import pieces


@given(st.text())
def test_the_pieces_of_a_text_are_the_text(text):
    assert "".join(pieces(text)) == text


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_number_is_never_broken(number):
    for text in (repr(number), f"{number:,.30f}", f"[{number!r}, {number!r}]"):
        assert pieces(text) == [text]


def test_a_long_path_is_broken_before_its_names_and_keeps_its_numbers():
    path = "/home/somebody/projects/girders-1.25/results/density=1937.46080465806.toml"
    parts = pieces(path)
    assert len(parts) > 3
    assert any("1937.46080465806" in part for part in parts)
    assert any("girders-1.25" in part for part in parts)


def test_a_digest_is_broken_into_equal_parts():
    assert [len(part) for part in pieces("0123456789abcdef" * 4)] == [24, 24, 16]


def test_words_of_a_sentence_are_left_whole():
    assert pieces("the rock is 1538.03 kN heavy") == ["the rock is 1538.03 kN heavy"]


def test_the_template_adds_no_invisible_letter():
    import rockshed.reports.pdf as pdf

    template = pdf.TEMPLATE.read_text(encoding="utf-8")
    assert not re.search("zws|[\u200b\u00ad]", template)
