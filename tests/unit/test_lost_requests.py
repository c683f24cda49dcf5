"""Requests to end that hit Python where it loses exceptions."""

import signal
import time
import weakref

import pytest

from rockshed.core.ending import asked_to_end, interrupt, lost_requests_repeated


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
