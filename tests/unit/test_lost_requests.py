"""Requests to end that hit Python where it loses exceptions, and libraries that make others of them."""

import signal
import time
import weakref
from pathlib import Path

import numpy as np
import pytest
import typer
from matplotlib.transforms import Bbox

from rockshed.commands.analysis import kept_if_ended
from rockshed.commands.screen import INTERRUPTED, Screen, opened
from rockshed.core.ending import asked_to_end, interrupt, lost_requests_repeated, true_cause


class Mortal:
    """An object whose end calls something."""


def asked_in_a_callback(number):
    """Let an object end, and ask to end in the callback of its weak reference."""
    mortal = Mortal()
    reference = weakref.ref(mortal, lambda _: signal.raise_signal(number))
    del mortal
    assert reference() is None
    time.sleep(5.0)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_request_that_is_lost_in_a_callback_is_made_again(number, capfd):
    with (
        asked_to_end(interrupt),
        lost_requests_repeated(),
        pytest.raises(KeyboardInterrupt, match=signal.Signals(number).name),
    ):
        asked_in_a_callback(number)
    assert "Traceback" not in capfd.readouterr().err


def test_other_exceptions_that_are_lost_are_told_as_before(monkeypatch):
    told = []
    monkeypatch.setattr("sys.unraisablehook", told.append)
    with lost_requests_repeated():
        mortal = Mortal()
        reference = weakref.ref(mortal, lambda _: 1 / 0)
        del mortal
    assert reference() is None
    assert [lost.exc_type for lost in told] == [ZeroDivisionError]


class Asking:
    """A box that asks to end while code in C++ reads it."""

    def __array__(self, dtype=None, copy=None):
        signal.raise_signal(signal.SIGHUP)
        return np.zeros((2, 2))


def asked_in_a_library():
    """As matplotlib does where a request hits its code in C++."""
    from matplotlib import _path

    _path.count_bboxes_overlapping_bbox(Asking(), np.array(Bbox.unit())[None])


def test_a_library_makes_another_exception_of_a_request():
    with asked_to_end(interrupt), pytest.raises(ValueError, match="Invalid bounding box"):
        asked_in_a_library()


def test_a_request_of_which_a_library_makes_another_exception_stays_one():
    with (
        asked_to_end(interrupt),
        pytest.raises(KeyboardInterrupt, match="SIGHUP"),
        true_cause(OSError),
    ):
        asked_in_a_library()


def test_what_fails_without_a_request_or_before_it_is_told_as_it_is():
    with asked_to_end(interrupt), pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)
    with pytest.raises(ZeroDivisionError), true_cause():
        1 / 0  # noqa: B018


def fail_while_tidying():
    """As a run does that keeps what it has when it is asked to end, on a full disk."""
    try:
        signal.raise_signal(signal.SIGINT)
    finally:
        raise OSError("the disk is full")


def test_a_full_disk_after_a_request_is_told():
    with asked_to_end(interrupt), pytest.raises(OSError, match="full"), true_cause(OSError):
        fail_while_tidying()


@pytest.mark.parametrize("frame", [opened, lambda: kept_if_ended(Screen(True), Path("results"))])
def test_a_command_whose_library_fails_from_a_request_is_interrupted(frame, capsys):
    with asked_to_end(interrupt), pytest.raises(typer.Exit) as ended, frame():
        asked_in_a_library()
    assert ended.value.exit_code == INTERRUPTED
    assert "interrupted" in capsys.readouterr().err
