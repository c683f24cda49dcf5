"""Sites: what is read, from TOML, CSV and DXF, and what is refused where."""

import re
import tomllib
from pathlib import Path
from types import SimpleNamespace

import pytest

import rockshed
from rockshed.campaigns.campaign import campaign_of
from rockshed.core.errors import InputRefused
from rockshed.input_files.places import places
from rockshed.sites.rockfall import profile
from rockshed.sites.rockfall.materials import COEFFICIENTS, COMMON, DRSP, shipped, source_of
from rockshed.sites.rockfall.preparation import prepare

HEAD = """\
[rock]
radius = 0.5
density = 2600
[start]
x = 1
y = 102
[limit_speed]
mean = 12
deviation = 2
"""
POINTS = 'points = [[0, 100, "rock"], [50, 60, "soil"], [90, 50]]'
PROFILE = f'[profile]\n{POINTS}\n[[ground]]\nmaterial = "soil"\nfrom = 50\n'


@pytest.fixture
def site(tmp_path):
    """Write a site and prepare it."""

    def prepared(text=PROFILE, head=HEAD, **options):
        file = tmp_path / "site.toml"
        file.write_text(head + text)
        slope = prepare(file, **options)
        return SimpleNamespace(**vars(slope), name=slope.name, campaign=campaign_of(slope))

    return prepared


@pytest.fixture
def refused(site):
    """The problems of a site as (place without the folder, what)."""

    def problems(text=PROFILE, head=HEAD, **options):
        with pytest.raises(InputRefused) as refusal:
            site(text, head, **options)
        return [(found.where.rpartition("/")[2], found.what) for found in refusal.value.problems]

    return problems


def test_a_site_becomes_parameters_of_the_component(site):
    made = site()
    assert (made.name, made.campaign.trials, made.campaign.seed) == ("site", 10_000, 1)
    assert made.instance["mass"] == pytest.approx(1361.36, abs=0.01)
    assert list(made.instance["strength"]) == [3e6, 0.8e6]
    assert list(made.instance["end.x"]) == [50, 90]
    assert (made.campaign.left, made.campaign.right) == (0, 90)


def test_trials_and_seed_of_the_command_replace_those_of_the_file(site):
    made = site(head="trials = 5\nseed = 3\n" + HEAD, trials=7, seed=4)
    assert (made.campaign.trials, made.campaign.seed, made.instance["seed"]) == (7, 4, 4)


def test_a_ground_divides_the_cells_that_it_ends_in(site):
    made = site(
        '[profile]\npoints = [[0, 100], [100, 50]]\n[[ground]]\nmaterial = "rock"\n[[ground]]\nmaterial = "soil"\n'
        "from = 20\nto = 60\n"
    )
    assert [(n.x, n.y, n.material) for n in made.nodes[:-1]] == [
        (0, 100, "rock"),
        (20, 90, "soil"),
        (60, 70, "rock"),
    ]


def test_a_material_may_build_on_another(site):
    made = site(
        PROFILE.replace('"rock"', '"cliff"') + '[material.cliff]\nlike = "rock"\nhardening = 0.8\n'
    )
    assert list(made.instance["hardening"]) == [0.8, 0.4]
    assert made.instance["stiffness"][0] == 30e6
    cliff = made.materials["cliff"]
    assert source_of(cliff, "hardening") == "given with the site"
    assert source_of(cliff, "stiffness") == source_of(shipped()["rock"], "stiffness")


def test_every_shipped_material_is_complete_and_says_where_it_comes_from():
    for material in shipped().values():
        law = COEFFICIENTS if material.normal_restitution is not None else DRSP
        needed = (*law, *COMMON)
        assert all(getattr(material, quantity) is not None for quantity in needed)
        assert all(source_of(material, quantity) for quantity in needed)


def test_the_site_in_the_documentation_can_be_prepared(site, tmp_path):
    text = (Path(rockshed.__file__).parent / "README.md").read_text()
    (tmp_path / "slope.csv").write_text("x,y\n20,76\n62,31\n140,4\n")
    example = next(
        block
        for block in re.findall(r"```toml\n(.*?)```", text, re.DOTALL)
        if "[[barrier]]" in block
    )
    made = site(example.replace("x = 1.0", "x = 25").replace("to = 62", "to = 140"), head="")
    assert made.instance["moment_of_inertia"] == 150.0
    assert made.campaign.names == ("road", "fence")


# --- files ---


def test_a_profile_from_csv(site, tmp_path):
    (tmp_path / "p.csv").write_text("# survey\nx,y,material\n0,100,rock\n50, 60,soil\n90,50,\n")
    made = site('[profile]\nfile = "p.csv"\n')
    assert [(node.x, node.y, node.material) for node in made.nodes] == [
        (0, 100, "rock"),
        (50, 60, "soil"),
        (90, 50, None),
    ]


def test_faults_of_a_csv_file_have_line_and_column(refused, tmp_path):
    (tmp_path / "p.csv").write_text("x,y\n0,100\n10, ninety\n20,nan\n30\n40,5\n")
    assert refused('[profile]\nfile = "p.csv"\n[[ground]]\nmaterial = "soil"\n') == [
        ("p.csv, line 3, column 5", "'ninety' is no finite number"),
        ("p.csv, line 4, column 4", "'nan' is no finite number"),
        ("p.csv, line 5, column 1", "has 1 field"),
    ]


def drawing(file, *pieces, units=0):
    ezdxf = pytest.importorskip("ezdxf")
    made = ezdxf.new()
    made.units = units
    for layer, points in pieces:
        made.modelspace().add_lwpolyline(points, dxfattribs={"layer": layer})
    made.saveas(file)


def test_a_profile_from_a_drawing_in_millimetres_drawn_from_right_to_left_in_two_pieces(
    site, tmp_path
):
    drawing(
        tmp_path / "p.dxf",
        ("soil", [(90e3, 50e3), (50e3, 60e3)]),
        ("rock", [(50e3, 60e3), (20e3, 80e3), (0, 100e3)]),
        ("frame", [(0, 0), (1, 1)]),
        units=4,
    )
    made = site('[profile]\nfile = "p.dxf"\nlayers = ["rock", "soil"]\n')
    found = [(round(node.x, 9), round(node.y, 9), node.material) for node in made.nodes[:-1]]
    assert found == [(0, 100, "rock"), (20, 80, "rock"), (50, 60, "soil")]
    assert made.nodes[-1].x == pytest.approx(90)


def test_pieces_of_a_drawing_that_do_not_meet_are_refused(refused, tmp_path):
    drawing(tmp_path / "p.dxf", ("a", [(0, 100), (50, 60)]), ("b", [(51, 60), (90, 50)]))
    ((where, what),) = refused('[profile]\nfile = "p.dxf"\n[[ground]]\nmaterial = "soil"\n')
    assert where.startswith("p.dxf, entity ")
    assert "1 m from where the piece on its left ends" in what


def test_a_drawing_without_ezdxf_says_what_to_install(refused, tmp_path, monkeypatch):
    (tmp_path / "p.dxf").write_text("")
    monkeypatch.setitem(__import__("sys").modules, "ezdxf", None)
    assert ("p.dxf", "reading a DXF drawing needs the package ezdxf") in refused(
        '[profile]\nfile = "p.dxf"\n'
    )


# --- refusals ---


@pytest.mark.parametrize(
    ("text", "place", "what"),
    [
        (
            PROFILE.replace("[50, 60", "[-50, 60"),
            "line 11, column 29",
            "its right node must lie to the right",
        ),
        ("[profile]\npoints = [[0, 100]]\n", "line 11, column 1", "has 1 node"),
        ("[profile]\npoints = []\n", "line 11, column 1", "has 0 nodes"),
        (
            '[profile]\npoints = [[0, 100, "rock"], [50, 60], [90, 50]]\n',
            "line 11, column 29",
            "cell 2, which begins at x",
        ),
        (
            PROFILE + '[material.rock]\nlike = "rock"\nfriction = 6\n',
            "line 11, column 11",
            "mu tan(phi) with the largest roughness",
        ),
        (
            PROFILE + '[material.rock]\nlike = "rock"\nhardening = 1.5\n',
            "line 17, column 1",
            "hardening = 1.5: allowed is 0 to 1",
        ),
        (PROFILE.replace("100", "nan"), "line 11, column 11", "is no point"),
        (PROFILE.replace('"rock"', '"rok"'), "line 11, column 11", "there is no material 'rok'"),
        (
            PROFILE + '[[barrier]]\nname = "a"\nx = 95\nheight = 3\ncapacity = 1\n',
            "line 17, column 1",
            "x = 95 m is beside",
        ),
        (
            PROFILE + '[[barrier]]\nname = "a"\nx = 5\nheight = 0.5\ncapacity = 1\n',
            "line 15, column 1",
            "would hold no rock",
        ),
        (
            PROFILE + '[[line]]\nname = "a"\n',
            "line 15, column 1",
            "a search line has two points, or an x",
        ),
        (PROFILE + "[model]\ngravitation = 1\n", "line 16, column 1", "there is no such key"),
        ("profile = 5\n", "line 10, column 1", "limit_speed.profile: there is no such key"),
        (
            PROFILE + "[[line]]\nname = 5\n",
            "line 16, column 1",
            "line[1].name: must be text",
        ),
        (
            PROFILE + "[material]\nrock = 3\n",
            "line 16, column 1",
            "material.rock: must be a table",
        ),
        (
            PROFILE + 'colour = "red"\n',
            "line 15, column 1",
            "ground[1].colour: there is no such key",
        ),
    ],
)
def test_a_fault_is_told_with_line_and_column(refused, text, place, what):
    found = refused(text)
    assert any(where == f"site.toml, {place}" and what in said for where, said in found), found


@pytest.mark.parametrize(
    ("old", "new", "place", "what"),
    [
        ("y = 102", "y = 99", "line 4, column 1", "the rock starts below the surface"),
        ("x = 1\n", "x = nan\n", "line 5, column 1", "finite number"),
        (
            "[rock]",
            "trials = 0\n[rock]",
            "line 1, column 1",
            "trials: must be greater than or equal to 1",
        ),
        (
            "radius = 0.5",
            "radius = -1",
            "line 2, column 1",
            "rock.radius: must be greater than 0",
        ),
        ("density = 2600", "", "line 1, column 1", "a rock has a mass, or the density of a sphere"),
    ],
)
def test_a_fault_of_rock_or_start_is_told_with_line_and_column(refused, old, new, place, what):
    found = refused(head=HEAD.replace(old, new))
    assert any(where == f"site.toml, {place}" and what in said for where, said in found), found


def test_all_problems_are_told_at_once(refused):
    found = refused(
        PROFILE.replace('"rock"', '"rok"')
        + '[[line]]\nname = "a"\nx = -3\n[model]\ntilt_meaning = "both"\n'
    )
    assert [where for where, _ in found] == [
        f"site.toml, {place}"
        for place in ("line 11, column 11", "line 17, column 1", "line 19, column 1")
    ]


def test_what_is_no_toml_is_refused_with_its_line(refused):
    ((where, what),) = refused("[profile\n")
    assert where == "site.toml"
    assert "line 10" in what


def test_more_records_than_memory_are_refused(refused):
    ((_, what),) = refused(trials=10_000_000)
    assert "GiB" in what


# --- places ---

TEXT = '''# comment = [
a = 1
"b c".d = """x = [
"""
[t.u]
list = [ # first
  1, 'two',   [3, {k = "}", m = 2}],
]
[[v]]
n = 1
[[v]]
n.p = 2
[[v.w]]
q = 1979-05-27 07:32:00
'''


def test_every_value_is_found_where_it_stands():
    def walk(value, path):
        yield path
        items = (
            value.items()
            if isinstance(value, dict)
            else enumerate(value)
            if isinstance(value, list)
            else ()
        )
        for key, inner in items:
            yield from walk(inner, (*path, key))

    found = places("f", TEXT)
    paths = [path for path in walk(tomllib.loads(TEXT), ()) if path]
    leaves = {
        ("a",): (2, 1),
        ("b c", "d"): (3, 1),
        ("t", "u", "list", 1): (7, 6),
        ("t", "u", "list", 2, 1, "m"): (7, 29),
        ("v", 1, "n", "p"): (12, 1),
        ("v", 1, "w", 0, "q"): (14, 1),
    }
    assert leaves.keys() <= set(paths)
    for path, (line, column) in leaves.items():
        assert found.of(path) == f"f, line {line}, column {column}"
    assert found.of(("v", 0, "missing")) == "f, line 9, column 1"


def test_the_surface_goes_on_beyond_its_ends():
    nodes = [
        profile.Node(0, 10, None, ""),
        profile.Node(10, 0, None, ""),
        profile.Node(20, 0, None, ""),
    ]
    assert [profile.surface(nodes, x) for x in (-1, 0, 5, 10, 25)] == [11, 10, 5, 0, 0]
