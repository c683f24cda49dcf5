"""What a page refuses before anything is compiled, and what it has ready."""

import pytest

import rockshed
from rockshed.core.errors import InputRefused
from rockshed.pages.impact import computed, start_of
from rockshed.pages.offers import offers_of
from rockshed.runs.request import Request


def refusal(*arguments, **options):
    with pytest.raises(InputRefused) as refused:
        rockshed.page(*arguments, **options)
    return str(refused.value)


@pytest.mark.parametrize(
    ("case", "words"),
    [
        ("slope-to-cushion", "SlopeRockfall is a component that a page does not compute"),
        ("spt", "has no FallingRock"),
        ("static-test", "is driven"),
        ("lab-impakt", "lab-impact"),
    ],
)
def test_a_system_that_is_no_impact_is_refused(case, words, tmp_path):
    assert words in refusal(case, tmp_path / "page.html")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("key", "changes"),
    [
        ("master", {"coupling": "implicit"}),
        ("adaptive", {"adaptive": {"tolerance": 1e-3, "largest_step": 2e-5}}),
        ("extrapolation", {"extrapolation": 1}),
    ],
)
def test_exchanges_that_a_page_does_not_make_are_refused(key, changes, tmp_path):
    system = rockshed.case("lab-impact", in_process=True, **changes)
    assert f"{key}: exchanges are made in turn" in refusal(system, tmp_path / "page.html")


def test_a_system_that_was_built_by_hand_from_an_fmu_file_is_refused(tmp_path):
    (tmp_path / "any.fmu").write_bytes(b"")
    system = rockshed.System.new("own", exchange_step=1e-3, stop_time=1.0)
    system = system.add("thing", tmp_path / "any.fmu")
    assert "any.fmu" in refusal(system, tmp_path / "page.html")


def test_a_file_of_somebody_else_is_not_overwritten(tmp_path):
    (tmp_path / "page.html").write_text("<html>mine</html>")
    assert "would be overwritten" in refusal("lab-impact", tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text() == "<html>mine</html>"


def test_a_file_that_is_no_page_or_lies_in_no_folder_is_refused(tmp_path):
    assert "let its name end in .html" in refusal("lab-impact", tmp_path / "page.pdf")
    assert "is no folder" in refusal("lab-impact", tmp_path / "none" / "page.html")


def test_the_first_variant_is_what_was_asked_for_and_has_its_values():
    asked = Request("lab-impact", {"sand.modulus": 4e6}, in_process=True)
    first, *others = offers_of(asked)
    assert (first.model, first.thickness) == ("calibrated", 0.1)
    start = start_of(first.system)
    assert start["moved"]["modulus"]["value"] == 4e6
    assert start["moved"]["speed"]["value"] == -8.0
    assert {variant.model for variant in others} == {"calibrated", "literal", "one-law"}
    assert len({(v.model, v.thickness) for v in (first, *others)}) == len(others) + 1


def test_a_mass_is_moved_wherever_the_system_has_it():
    (first, *_) = offers_of(Request("lab-impact", in_process=True))
    places = start_of(first.system)["moved"]["mass"]["places"]
    assert sorted(name for name, _ in places) == ["rock", "sand"]


def test_the_sand_is_initialised_after_those_that_it_lies_on():
    (first, *_) = offers_of(Request("lab-impact", in_process=True))
    assert computed(first.system)["turns"][-1] == "sand"


def test_a_project_is_offered_with_other_thicknesses(tmp_path):
    from importlib.resources import files

    example = files("rockshed") / "examples" / "trial-shed.toml"
    (tmp_path / "shed.toml").write_text(example.read_text())
    found = offers_of(Request(str(tmp_path / "shed.toml"), in_process=True))
    assert [round(variant.thickness, 6) for variant in found] == [1.2, 0.6, 0.9, 1.5, 1.8, 2.4]


def test_without_the_linker_a_page_is_refused_with_the_package_to_install(tmp_path, monkeypatch):
    from rockshed.fmus import kept_code
    from rockshed.fmus.wasm import module

    monkeypatch.setattr(module, "find_spec", lambda name: None)
    monkeypatch.setattr(kept_code, "kept", lambda file: None)
    assert "pip install rockshed[page]" in refusal("lab-impact", tmp_path / "page.html")
    assert not list(tmp_path.iterdir())


def test_a_system_file_is_refused_as_what_it_is(tmp_path):
    file = tmp_path / "system.toml"
    file.write_text(
        'name = "s"\nexchange_step = 1e-3\nstop_time = 0.1\ncomponents.a.fmu = "a.fmu"\n'
    )
    said = refusal(file, tmp_path / "page.html")
    assert "is a system of FMU files" in said
    assert "in_process" not in said
