"""A slope of eight nodes with a shed at its foot, for tests."""

import tomli_w

SITE = {
    "name": "gully",
    "trials": 300,
    "seed": 3,
    "rock": {"radius": 0.4, "density": 2600.0},
    "start": {"x": 101.0, "y": 42.0, "velocity": [1.0, 0.0]},
    "limit_speed": {"mean": 12.0, "deviation": 2.0},
    "profile": {
        "points": [
            [100.0, 40.0, "rock"],
            [108.0, 33.0, "rock"],
            [114.0, 24.0, "rock"],
            [121.0, 19.0, "soil"],
            [126.0, 12.5, "rock"],
            [128.0, 12.0, "soil"],
            [139.0, 4.0, "soil"],
            [160.0, 2.0],
        ]
    },
}
"""The ground as it is without the shed, far from the origin."""
PROJECT = {
    "name": "gallery",
    "slope": {"file": "gully.toml", "x": 128.0, "y": 11.2},
    "cushion": {"thickness": "0.9 m"},
    "roof": {"section": "H-400x400x13x21", "span": "8 m", "spacing": "1.5 m"},
}
"""A shed whose cushion lies level with the berm at x = 128 m."""


def written(folder, site=None, project=None):
    """Write slope and shed, with some tables of them replaced, and return the project's file."""
    (folder / "gully.toml").write_text(tomli_w.dumps({**SITE, **(site or {})}))
    content = {**PROJECT, **(project or {})}
    file = folder / "shed.toml"
    file.write_text(tomli_w.dumps({name: table for name, table in content.items() if table}))
    return file


def with_slope(**keys):
    """Return the table of the slope with other keys."""
    return {"slope": {**PROJECT["slope"], **keys}}
